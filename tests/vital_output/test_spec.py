"""The configuration: what follows from it, and what it refuses."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from railgate.check import Check
from railgate.vital_output.spec import CAUSES, Config, State, mask, pack, unpack
from railgate.vital_output.spec.frame import bits
from vital_output.small import SMALL, TICK

DEFAULT = Config()
MILLI = Fraction(1, 1000)
words = st.integers(0, (1 << 32) - 1)


@pytest.mark.shows("DRV-2")
@pytest.mark.parametrize("outputs", [1, 8, 9, 16, 64])
@pytest.mark.parametrize("board", [0, 1])
def test_each_mask_changes_just_its_bit_of_the_crc(outputs: int, board: int) -> None:
    config = Config(outputs=outputs, release_min_s=5 * MILLI)
    values = {"sequence": 77, "image": 1, "acknowledge": 0}
    right = config.layout.crc(config.boards[board], 5, values)
    changed = [config.layout.crc(m, 5, values) ^ right for m in config.masks[board]]
    assert changed == [1 << number for number in range(32)]


@pytest.mark.shows("DRV-2")
@given(words, words, words, words, st.integers(0, 31))
def test_a_mask_does_so_whatever_the_frame(
    board: int, time: int, sequence: int, image: int, number: int
) -> None:
    layout = DEFAULT.layout
    values = {"sequence": sequence, "image": image & 0xFFFF, "acknowledge": 0}
    masked = layout.crc(mask(layout, board, number), time, values)
    assert masked ^ layout.crc(board, time, values) == 1 << number


@given(words, st.integers(0, 0xFFFF), st.integers(0, 0xFFFF), words)
def test_unpack_reads_what_pack_wrote(sequence: int, image: int, ack: int, crc: int) -> None:
    values = {"sequence": sequence, "image": image, "acknowledge": ack, "crc": crc}
    fields = DEFAULT.layout.frame
    packed = pack(fields, values)
    assert unpack(fields, packed) == values
    assert packed >> 64 == sequence
    assert packed & 0xFFFF_FFFF == crc


def test_a_value_that_does_not_fit_into_its_field_is_refused() -> None:
    with pytest.raises(ValueError, match="image must be between 0 and 65535, not 65536"):
        pack(DEFAULT.layout.frame, {"sequence": 0, "image": 1 << 16, "acknowledge": 0, "crc": 0})


@pytest.mark.shows("DRV-1")
def test_the_frame_is_laid_out_as_requirement_drv_1_has_it() -> None:
    layout = DEFAULT.layout
    assert layout.frame_bytes == 12
    assert [field.width for field in layout.implicit] == [32, 32]
    assert (layout.check.polynomial, layout.check.width) == (0xF4ACFB13, 32)
    assert bits(layout.message) + 1 == layout.message_bits == 221


@pytest.mark.shows("DRV-2", "DRV-5")
def test_no_frame_for_one_board_is_one_for_the_other_in_the_acceptance_window() -> None:
    values = {"sequence": 1, "image": 3, "acknowledge": 0}
    for index in (0, 1, 6, 7, 8, 0x7FFF_FFFF, 0xFFFF_FFFE, 0xFFFF_FFFF):
        first, second = (
            {DEFAULT.layout.crc(board, index + step, values) for step in range(-3, 2)}
            for board in DEFAULT.boards
        )
        assert len(first) == len(second) == 5
        assert not first & second


@pytest.mark.shows("DRV-2")
def test_boards_that_a_time_near_by_can_stand_for_are_refused() -> None:
    linear = Check(width=32, polynomial=DEFAULT.polynomial)
    columns = [linear.of(1 << bit, 32) for bit in range(32)]
    apart = solve(columns, 7 ^ 8)  # the boards' difference that a step from time 7 to 8 makes good
    with pytest.raises(ValueError, match="told apart by a time near by"):
        replace(DEFAULT, boards=(DEFAULT.boards[0], DEFAULT.boards[0] ^ apart))


def solve(columns: list[int], wanted: int) -> int:
    """x with Σ x_i · columns[i] = wanted over GF(2)."""
    rows: list[tuple[int, int]] = []
    for index, column in enumerate(columns):
        made = 1 << index
        for pivot, how in rows:
            if column ^ pivot < column:
                column, made = column ^ pivot, made ^ how
        rows.append((column, made))
        rows.sort(reverse=True)
    found = 0
    for pivot, how in rows:
        if wanted ^ pivot < wanted:
            wanted, found = wanted ^ pivot, found ^ how
    assert wanted == 0
    return found


@pytest.mark.shows("DRV-2")
def test_a_board_that_is_a_mask_of_the_other_is_refused() -> None:
    board = DEFAULT.masks[0][9]
    with pytest.raises(ValueError, match="must not be a mask"):
        replace(DEFAULT, boards=(DEFAULT.boards[0], board))


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"outputs": 65}, "outputs must be between 1 and 64, not 65"),
        ({"outputs": 0}, "outputs must be between 1 and 64, not 0"),
        ({"boards": (5, 5)}, "boards must differ, not both be 0x5"),
        ({"boards": (5, 1 << 32)}, "boards must be between 0 and 4294967295, not 4294967296"),
        ({"polynomial": 0x1000_0000}, "polynomial must be odd, not 0x10000000"),
        ({"link_polynomial": 2}, "link_polynomial must be odd, not 0x2"),
        ({"polynomial": 0x1EDC_6F41}, "link_polynomial must differ from polynomial"),
        ({"cycle_s": Fraction(1, 3)}, "cycle_s must be a whole number of ticks"),
        ({"slew_ticks": 159}, "slew_ticks must be at least the clocks' drift in a cycle, 160"),
        ({"holdover_cycles": 101}, "holdover_cycles must keep the drift below half the margin"),
        ({"tau0_s": 48 * MILLI}, "the decision instant, margin . tau0 . latency, must lie in"),
        ({"tau0_s": 1 * MILLI}, "tau0_s must be above twice the link's latency"),
        ({"tau1_s": 1 * MILLI}, "tau1_s must cover leaving and deciding, at least 18248 ticks"),
        ({"drift_limit_ppm": 200}, "drift_limit_ppm must lie above both clocks' tolerance"),
        (
            {
                "outputs": 64,
                "bit_ticks": 4,
                "tolerance_ppm": 1000,
                "slew_ticks": 4000,
                "holdover_cycles": 10,
                "drift_limit_ppm": 3000,
            },
            "a message of 413 bits must be read within half of the 1 ticks",
        ),
        ({"release_min_s": Fraction(1, 10_000)}, "release_min_s must be between"),
        ({"release_min_s": 60 * MILLI}, "release_min_s must be between"),
        ({"pick_up_s": Fraction(0)}, "pick_up_s must be above 0 and at most 10 s, not 0"),
        ({"error_interval_s": Fraction(1, 100)}, "error_interval_s must be between one cycle"),
        ({"life_cycles": 0}, "life_cycles must be between 1 and 15, not 0"),
    ],
)
def test_what_does_not_hold_is_refused_in_one_line(change: dict[str, object], said: str) -> None:
    with pytest.raises(ValueError, match=said) as error:
        replace(DEFAULT, **change)  # type: ignore[arg-type]
    assert "\n" not in str(error.value)


def test_every_number_of_outputs_can_be_built() -> None:
    for outputs in range(1, 65):
        Config(outputs=outputs, release_min_s=5 * MILLI)


@pytest.mark.shows("SYS-5")
def test_the_digest_tells_every_difference() -> None:
    changes: list[dict[str, object]] = [
        {},
        {"outputs": 15},
        {"boards": (1, 2)},
        {"tau0_s": 5 * MILLI + Fraction(1, 10**6)},
        {"zero_at_once": True},
        {"error_interval_s": Fraction(60)},
    ]
    digests = [replace(DEFAULT, **change).digest for change in changes]  # type: ignore[arg-type]
    assert len(set(digests)) == len(changes)
    assert Config().digest == digests[0]


@pytest.mark.shows("DRV-16")
def test_the_reaction_time_is_made_of_its_parts() -> None:
    ticks = 16_000 + 400 + 4 * (800_000 + 400) + (16_000 + 80_000 + DEFAULT.latency_ticks) + 1
    assert DEFAULT.life_bound_ticks == ticks
    slow = Fraction(16_000_000) * Fraction(999_900, 1_000_000)
    hold = Fraction(11, 10_000)
    assert DEFAULT.reaction_s == (ticks + 2) / slow + hold + Fraction(1, 20)
    assert 0.25 < DEFAULT.reaction_s < 0.26


def test_windows_of_the_scaled_configuration_keep_their_order() -> None:
    for config in (DEFAULT, SMALL):
        assert config.check_ticks < config.message_ticks < config.link_period_ticks
        assert config.latency_ticks < config.skew_ticks
        assert config.skew_ticks < config.release_ticks
        assert config.tau1_least_ticks < config.tau1_ticks
        assert config.decision_ticks + config.slew_ticks < config.cycle_ticks
    assert SMALL.cycle_ticks == 12_000 * TICK * SMALL.clock_hz


def test_status_fields_have_names_of_their_own() -> None:
    names = [field.name for field in DEFAULT.fields]
    assert len(set(names)) == len(names)
    assert {f"{cause.name.lower()}_count" for cause in CAUSES} < set(names)
    widths = {field.name: field.width for field in DEFAULT.fields}
    assert widths["states"] == 3 * DEFAULT.outputs
    assert max(State) < 1 << 3
    assert max(CAUSES) < 1 << widths["first_cause"]
