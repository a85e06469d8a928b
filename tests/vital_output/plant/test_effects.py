"""Each kind of fault does to the inputs what FAULTS says of it."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest

from railgate.vital_output.plant.edges import femtoseconds
from railgate.vital_output.plant.faults import FAULTS
from railgate.vital_output.plant.relay import DEFECTS, FEEDBACK
from railgate.waves import Trace, Waveform
from vital_output.plant.received import (
    CYCLES,
    PHASE,
    SECONDS,
    Received,
    edges,
    frames,
    scenario,
)
from vital_output.small import SMALL

CYCLE = SMALL.cycle_ticks
MS = 10**12
"""Femtoseconds."""

END = femtoseconds(SECONDS)
CLEAN = {fpga: frames(scenario(), fpga) for fpga in (1, 2)}
ANSWERS = {
    "cpu-1-dead", "cpu-2-dead", "disagree", "skew", "switch-over",
    *(f"{kind}-{cpu}" for cpu in (1, 2) for kind in (
        "repetition", "deletion", "insertion", "resequence", "corruption", "delay", "masquerade"
    )),
}  # fmt: skip
"""The kinds that change a CPU's frames."""

TIMES = {f"time-{kind}-{fpga}" for kind in ("lost", "step", "drift") for fpga in (1, 2)}


def inputs(*texts: str) -> Trace:
    return scenario(*texts).controls(SMALL)


def differing(*texts: str) -> dict[str, Waveform]:
    """The inputs that are not as without faults."""
    clean, found = inputs(), inputs(*texts)
    return {name: wave for name, wave in found.signals.items() if wave != clean[name]}


def told(found: list[Received]) -> list[tuple[int, int]]:
    """Cycle and sequence number of each frame."""
    return [(frame.tick // CYCLE, frame.sequence) for frame in found]


USUAL = [(cycle, cycle - 2) for cycle in range(2, CYCLES)]


@pytest.mark.parametrize("kind", sorted(FAULTS))
def test_each_kind_changes_only_what_it_is_of(kind: str) -> None:
    found = differing(f"{kind}@61ms")
    assert found
    of = [f"fpga_{c}" for c in (1, 2) if kind.endswith(f"-{c}") or kind == f"cpu-{c}-dead"]
    of = of or (["fpga_2"] if kind in ("disagree", "skew") else ["fpga_1", "fpga_2"])
    if kind in ANSWERS:
        names = {f"{c}.command.{name}" for c in of for name in ("payload", "valid")}
    elif kind in TIMES:
        names = {f"{of[0]}.time.{name}" for name in ("index", "phase", "valid")}
    else:
        names = {
            name for name in inputs().signals if ".command." not in name and ".time" not in name
        }
    assert found.keys() <= names
    for name, wave in found.items():
        start = 61 * MS if kind not in ANSWERS | TIMES else 5 * CYCLE * 10**9
        assert wave.slice(0, start) == inputs()[name].slice(0, start)


@pytest.mark.parametrize("cpu", [1, 2])
@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("cpu-{}-dead@61ms", USUAL[:3]),
        ("cpu-{}-dead@61ms..62ms", USUAL[:3] + USUAL[4:]),
        ("deletion-{}@61ms", USUAL[:3] + USUAL[4:]),
        ("deletion-{}@61ms..84.1ms", USUAL[:3] + USUAL[6:]),
        ("repetition-{}@61ms", sorted([*USUAL, (5, 3)])),
        ("insertion-{}@61ms", sorted([*USUAL, (5, 3 + SMALL.life_cycles + 1)])),
        ("insertion-{}:77@61ms", sorted([*USUAL, (5, 80)])),
        ("resequence-{}@61ms", [*USUAL[:3], (5, 4), (6, 3), *USUAL[5:]]),
        ("resequence-{}@60ms..96ms", [*USUAL[:3], (5, 4), (6, 3), (7, 6), (8, 5), *USUAL[7:]]),
        ("delay-{}@61ms", [*USUAL[:3], (6, 3), *USUAL[4:]]),
        ("delay-{}:3@61ms", [*USUAL[:3], (6, 4), (7, 5), (8, 3), *USUAL[6:]]),
        ("delay-{}:1000000@61ms", USUAL[:3] + USUAL[4:]),
        ("masquerade-{}@61ms", USUAL),
    ],
)
def test_what_comes_of_a_cpus_frames(cpu: int, text: str, expected: list[tuple[int, int]]) -> None:
    run = scenario(text.format(cpu))
    assert told(frames(run, cpu)) == expected
    assert frames(run, 3 - cpu) == CLEAN[3 - cpu]


def test_an_inserted_frame_is_right_but_for_its_number_and_commands_all() -> None:
    found = frames(scenario("insertion-1@61ms"), 1)
    assert found[4].image == 3
    assert found[4].made_for == found[3].made_for == (0, 5)


def test_frames_out_of_sequence_are_right_for_their_cycle() -> None:
    found = frames(scenario("resequence-2@61ms"), 2)
    assert [frame.made_for for frame in found] == [(1, cycle) for cycle in range(2, CYCLES)]


def test_the_last_frame_stays_where_no_other_follows() -> None:
    assert told(frames(scenario("resequence-1@143ms"), 1)) == USUAL


def test_a_delayed_frame_is_still_for_the_cycle_that_it_was_made_in() -> None:
    found = frames(scenario("delay-1@61ms"), 1)
    assert found[3].made_for == (0, 5)
    assert found[3].tick // CYCLE == 6


def test_a_masquerade_is_a_right_frame_for_the_other_fpga() -> None:
    for cpu in (1, 2):
        found = frames(scenario(f"masquerade-{cpu}@61ms"), cpu)
        assert [frame.made_for for frame in found] == [
            (2 - cpu if cycle == 5 else cpu - 1, cycle) for cycle in range(2, CYCLES)
        ]


def test_a_corruption_inverts_just_that_bit() -> None:
    first = frames(scenario("corruption-1@61ms"), 1)[3]
    assert first.sequence == 3 | 1 << 31
    assert first.made_for is None
    image = frames(scenario("corruption-1:39@61ms"), 1)[3]  # after 32 and 6 spare ones
    assert (image.sequence, image.image, image.made_for) == (3, 3, None)
    crc = frames(scenario("corruption-1:80@61ms"), 1)[3]
    assert (crc.sequence, crc.image, crc.made_for) == (3, 1, None)
    twice = frames(scenario("corruption-1:80@61ms", "corruption-1:80@61ms"), 1)
    assert twice == CLEAN[1]


def test_disagree_inverts_cpu_2s_command_of_one_output() -> None:
    found = frames(scenario("disagree@61ms..80ms"), 2)
    assert [frame.image for frame in found] == [1, 1, 1, 0, 0, 1, 1, 1, 1, 1]
    assert frames(scenario("disagree:1@61ms"), 2)[-1].image == 3
    assert all(frame.made_for for frame in found)


def test_skew_makes_cpu_2s_frames_later() -> None:
    def later(text: str) -> list[int]:
        found = frames(scenario(text), 2)
        return [a.tick - b.tick for a, b in zip(found, CLEAN[2], strict=True)]

    assert later("skew:700@61ms..70ms") == [0, 0, 0, 700, 0, 0, 0, 0, 0, 0]
    clearly = SMALL.tau0_ticks + 2 * SMALL.latency_ticks
    assert later("skew@61ms") == [0, 0, 0] + [clearly] * 7


@pytest.mark.parametrize(
    ("text", "resumed"),
    [
        ("switch-over@61ms", 5 + SMALL.life_cycles + 2),
        ("switch-over:2@61ms", 7),
        ("switch-over:2@61ms..100ms", 9),
        ("switch-over:0@61ms", 6),
    ],
)
def test_after_a_switch_over_both_go_on_with_other_numbers(text: str, resumed: int) -> None:
    for fpga in (1, 2):
        found = told(frames(scenario(text), fpga))
        before = [each for each in USUAL if each[0] < 5]
        assert found == before + [(c, c - 2 + (1 << 31)) for c in range(resumed, CYCLES)]


WIRES = {
    "link-cut-1": "line_1.high", "link-cut-2": "line_2.high",
    "welded": "relay.welded", "broken-coil": "relay.broken",
    "contact-open": "relay.contact_open", "contact-stuck": "relay.contact_stuck",
    "pulse-open-1": "relay.open_1", "pulse-open-2": "relay.open_2",
    "pulse-stuck-1": "relay.stuck_1", "pulse-stuck-2": "relay.stuck_2",
    "rogue-1": "relay.rogue_1", "rogue-2": "relay.rogue_2",
}  # fmt: skip


@pytest.mark.parametrize("kind", WIRES)
def test_a_wire_is_held_for_just_the_span_or_until_the_end(kind: str) -> None:
    wire = WIRES[kind]
    (found,) = differing(f"{kind}@1.5ms..2ms").items()
    assert found == (wire, Waveform.of([0, 3 * MS // 2, 2 * MS], [0, 1, 0], found[1].width))
    lasting = differing(f"{kind}@1.5ms")[wire]
    assert lasting == Waveform.of([0, 3 * MS // 2], [0, 1], found[1].width)


@pytest.mark.parametrize("kind", [kind for kind, wire in WIRES.items() if "relay" in wire])
def test_the_value_is_the_output(kind: str) -> None:
    both = differing(f"{kind}:1@1ms", f"{kind}:0@2ms..3ms")[WIRES[kind]]
    assert both.values.tolist() == [0, 2, 3, 2]
    with pytest.raises(ValueError, match=f"the value of {kind} must be between 0 and 1, not 2"):
        inputs(f"{kind}:2@1ms")


def test_every_defect_has_its_kind() -> None:
    assert {wire for wire in WIRES.values() if wire.startswith("relay")} == {
        f"relay.{name}" for name in (*DEFECTS, *FEEDBACK)
    }


def test_spans_that_overlap_are_held_until_the_last_ends() -> None:
    found = differing("welded@1ms..3ms", "welded@2ms..5ms", "welded@5ms..6ms")["relay.welded"]
    assert found == Waveform.of([0, MS, 6 * MS], [0, 1, 0], SMALL.outputs)


def test_a_line_that_is_cut_can_hold_0() -> None:
    assert differing("link-cut-2:0@1ms").keys() == {"line_2.low"}


def test_noise_inverts_both_lines_at_random_by_the_seed() -> None:
    def noise(text: str, seed: int) -> list[Waveform]:
        run = scenario(text, seed=seed).controls(SMALL)
        return [run[f"line_{c}.flip"] for c in (1, 2)]

    one, two = noise("link-noise@24ms..48ms", 0)
    again, other = noise("link-noise@24ms..48ms", 0), noise("link-noise@24ms..48ms", 1)
    assert [one, two] == again
    assert len({tuple(wave.ticks) for wave in (one, two, *other)}) == 4
    for wave in (one, two):
        assert 24 * MS <= wave.ticks[1] < wave.ticks[-1] <= 48 * MS
        assert wave.values[-1] == 0
        mean = 24 * MS / (len(wave) - 1)
        assert 0.6 < mean / (SMALL.message_ticks * 10**9) < 1.6
    dense = noise("link-noise:10@24ms..48ms", 0)[0]
    assert 0.9 < 24 * MS / (len(dense) - 1) / 10**10 < 1.1
    with pytest.raises(ValueError, match="noise must be at most 10000000 changes, not"):
        scenario("link-noise:1@0s", seconds=Fraction(20)).controls(SMALL)


@pytest.mark.parametrize("fpga", [1, 2])
def test_a_restart_is_one_tick_of_reset_with_another_boot_number(fpga: int) -> None:
    run = scenario(f"restart-{fpga}@61ms", f"restart-{fpga}@70ms..80ms", ppm_1=100)
    clock, found = edges(run, fpga), run.controls(SMALL)
    rst, boot = found[f"fpga_{fpga}_rst"], found[f"fpga_{fpga}.boot"]
    first, behind, second, end = clock.during(rst.ticks[1:]).tolist()
    assert behind == first + 1
    assert (clock.begin([first, behind, second, end]) == rst.ticks[1:]).all()
    assert clock.begin(first) >= 61 * MS > clock.begin(first - 1)
    assert clock.begin(second) >= 70 * MS > clock.begin(second - 1)
    assert clock.begin(end) >= 80 * MS > clock.begin(end - 1)
    assert boot.ticks.tolist() == [0, rst.ticks[1], rst.ticks[3]]
    assert boot.values.tolist() == [1, 2, 3]
    assert found[f"fpga_{3 - fpga}_rst"].values.tolist() == [0]
    assert found[f"fpga_{3 - fpga}.boot"].values.tolist() == [1]


@pytest.mark.parametrize("fpga", [1, 2])
def test_a_stopped_clock_stops_for_whole_ticks(fpga: int) -> None:
    run = scenario(f"stopped-{fpga}@61.0001ms..70.0001ms", ppm_2=-100)
    clock, found = edges(run, fpga), run.controls(SMALL)
    stops = found[f"fpga_{fpga}.stopped"]
    first, last = clock.during(stops.ticks[1:]).tolist()
    assert (clock.begin([first, last]) == stops.ticks[1:]).all()
    assert abs(last - first - 9000) <= 1
    assert differing(f"stopped-{fpga}@61ms").keys() == {f"fpga_{fpga}.stopped"}


def test_a_failing_test_is_demanded_of_both_with_a_rogue_train() -> None:
    found = differing("test-fails:1@61ms")
    assert found.pop("relay.rogue_2") == Waveform.of([0, 61 * MS], [0, 2], SMALL.outputs)
    assert found.keys() == {"fpga_1.test", "fpga_2.test"}
    for wave in found.values():
        assert wave.values.tolist() == [0, 1, 0]
        assert np.diff(wave.ticks)[1] == 10**9


def test_faults_count_in_their_order() -> None:
    twice = frames(scenario("repetition-1@61ms", "corruption-1@61ms"), 1)
    assert [frame.made_for for frame in twice[3:5]] == [None, None]
    once = frames(scenario("corruption-1@61ms", "masquerade-1@61ms", "deletion-1@61ms"), 1)
    assert told(once) == USUAL[:3] + USUAL[4:]


@pytest.mark.parametrize(
    ("text", "error"),
    [
        ("welded@1s", "welded must begin before the run's end at 0.144 s, not at 1 s"),
        ("disagree:2@0s", "the value of disagree must be between 0 and 1, not 2"),
        ("corruption-1:81@0s..1s", "the value of corruption-1 must be between 1 and 80, not 81"),
        ("link-cut-1:2@0s", "the value of link-cut-1 must be between 0 and 1, not 2"),
        ("skew:-1@0s", "the value of skew must be between 0 and 1000000000, not -1"),
        ("time-drift-1:100001@0s", "must be between -100000 and 100000, not 100001"),
    ],
)
def test_what_does_not_fit_the_run_is_refused(text: str, error: str) -> None:
    with pytest.raises(ValueError, match=error):
        inputs(text)


def test_the_frames_of_the_clean_run_are_where_they_should_be() -> None:
    assert told(CLEAN[1]) == told(CLEAN[2]) == USUAL
    assert {frame.tick % CYCLE - SMALL.layout.frame_bytes + 1 for frame in CLEAN[1]} == {PHASE}
