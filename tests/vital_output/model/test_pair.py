"""The closed loop in the model keeps the contract of both channels and the plant.

All clocks have 1 MHz and no phase: a tick is 10⁹ fs in all domains, and what changes in one of them
in a tick is sampled in the others in the same.
"""

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest

from railgate.engines import Clock
from railgate.vital_output.model import PairModel
from railgate.vital_output.spec import Config, State, TestPhase
from railgate.waves import Trace, Waveform
from vital_output.model.bench import Bench, changes, states
from vital_output.model.random_pair import FS, Times
from vital_output.small import SMALL

TICK = 10**9
IDLE, PRE_DRIVE, DRIVE, WAIT, TEST, HANDSHAKE_ALARM, FEEDBACK_ALARM = State
CLOCKS = tuple(
    Clock(frequency_hz=Fraction(1_000_000), domain=domain)
    for domain in ("fpga_1", "fpga_2", "relay")
)


def heard(tick: int) -> int:
    """From which tick on the peer knows what a register holds from this one on.

    It is in the message that begins in 8 + 1336 m, two ticks later or more, and is read 3 + 164 · 4
    + 2 + 1 ticks after its beginning.
    """
    number = -(-(tick + 2 - 8) // 1_336)
    return 8 + 1_336 * number + 662 + 1


def stored(verdict: int) -> int:
    """From which tick on the image is that of frames that both have their verdicts in this one:
    the peer forwards it, it is checked, passes, and that is told."""
    passed = heard(verdict + 1) + 134 + 1
    return heard(passed) + 1


def commanded(config: Config, *images: int, delay: int = 0, **faults: Waveform) -> Trace:
    """Time is right; each cycle both CPUs send a frame in phase 4000, FPGA 2's `delay` later."""
    signals = dict(faults)
    end = (len(images) + 3) * config.cycle_ticks  # before the last image has lost its life
    for c in range(2):
        bench = Bench(config, c)
        bench.trust(0, 10)
        for cycle, image in enumerate(images):
            tick = cycle * config.cycle_ticks + 4_000 + delay * c
            bench.frame(tick, cycle, sequence=cycle, image=image)
        for name, wave in bench.stimulus(end).signals.items():
            if name != "link_rx":
                wide = Waveform(wave.ticks * TICK, wave.values, wave.width)
                signals[f"fpga_{c + 1}.{name}"] = wide
    return Trace(signals, FS, 0, end * TICK)


def between(first: int, last: int, value: int = 1, width: int = 1) -> Waveform:
    """A fault in first ≤ tick < last."""
    return Waveform.of([0, first * TICK, last * TICK], [0, value, 0], width)


def run(stimulus: Trace, config: Config = SMALL, delay_ticks: int = 0) -> Trace:
    """All outputs, in ticks."""
    model = PairModel(config, Times(), CLOCKS, delay_ticks)
    found = model.advance(stimulus.end, stimulus)
    waves = {
        name: Waveform(wave.ticks // TICK, wave.values, wave.width)
        for name, wave in found.signals.items()
    }
    return Trace(waves, Fraction(1, 1_000_000), 0, stimulus.end // TICK)


def of(trace: Trace, fpga: int) -> Trace:
    """The signals of one FPGA."""
    prefix = f"fpga_{fpga}."
    names = {name: name.removeprefix(prefix) for name in trace.signals if name.startswith(prefix)}
    return trace.select(names).rename(names)


VERDICT = 4_009 + 134
IMAGES = (0, 0, 0, 1, 1, 1, 0, 0)
"""The command is 1 from cycle 3 on, when the start's 0 is stored, and 0 again from cycle 6 on."""


def test_a_pair_tests_itself_drives_and_switches_off() -> None:
    found = run(commanded(SMALL, *IMAGES))
    one, two = of(found, 1), of(found, 2)
    # FPGA 1 tests itself when it is linked, FPGA 2 when it hears that FPGA 1 is done.
    assert changes(one, "linked")[0] == changes(two, "linked")[0] == (2_007, 1)
    for trace, first in ((one, 2_008), (two, heard(6_216) + 1)):
        assert states(trace)[:3] == [(first, TEST), (first + 3_954, WAIT), (first + 4_207, IDLE)]
        assert changes(trace, "test_phase") == [
            (first, TestPhase.RUNNING),
            (first + 4_208, TestPhase.DONE),
        ]
    on, off = (stored(cycle * 12_000 + VERDICT) for cycle in (3, 6))
    drives = heard(on + 1) + 1
    for trace in (one, two):
        assert changes(trace, "image") == [(on, 1), (off, 0)]
        assert states(trace)[3:6] == [(on + 1, PRE_DRIVE), (drives, DRIVE), (off + 1, WAIT)]
        assert changes(trace, "first_cause") == []
    # The second rise of both trains makes the stages alive, 200 + 1 + 2 + 1 ticks after the entry.
    closed = drives + 204 + 700
    rises = -(-(off + 1 - (drives + 1) + 1) // 200)
    last = drives + 1 + 200 * (rises - 1) + 2
    opened = last + 221 + 7_000
    assert changes(found, "contact") == [(closed, 1), (opened, 0)]
    # The contact is seen to be open 8 ticks later.
    assert states(one)[6:] == states(two)[6:] == [(opened + 9, IDLE)]
    first = [(drives + 1 + 100 * half, 1 - half % 2) for half in range(8)]
    for trace in (one, two):
        assert [turn for turn in changes(trace, "pulses") if turn[0] > on][:8] == first


def test_output_0_alone_is_driven() -> None:
    found = run(commanded(SMALL, *IMAGES))
    assert [state for _, state in states(of(found, 1), 1)] == [TEST, WAIT, IDLE]


def test_what_the_cpus_do_not_agree_in_does_not_drive() -> None:
    stimulus = commanded(SMALL, 0, 0, 0, 1, 1)
    other = commanded(SMALL, 0, 0, 0, 2, 1)
    mixed = {
        name: (other if name.startswith("fpga_2") else stimulus)[name] for name in stimulus.signals
    }
    found = run(Trace(mixed, FS, 0, stimulus.end))
    for fpga in (1, 2):
        assert len(changes(of(found, fpga), "mismatch_count")) == 1
        assert changes(of(found, fpga), "image") == [(stored(4 * 12_000 + VERDICT), 1)]


def drives(config: Config = SMALL) -> int:
    """The tick in which both begin to drive."""
    return heard(stored(3 * config.cycle_ticks + VERDICT) + 1) + 1


def quiet_line(after: int) -> tuple[int, int]:
    """A tick in which both lines are quiet, and that in which the last message was taken."""
    number = -(-after // 1_336)
    return 8 + 1_336 * number + 700, 670 + 1_336 * number


@pytest.mark.parametrize("level", ["low", "high"])
def test_a_line_that_is_stuck_stops_both(level: str) -> None:
    at, last = quiet_line(drives() + 5_000)
    found = run(commanded(SMALL, 0, 0, 0, *[1] * 6, **{f"line_1.{level}": between(at, 90_000)}))
    one, two = of(found, 1), of(found, 2)
    assert changes(two, "linked")[:2] == [(2_007, 1), (last + 3_341, 0)]
    assert changes(one, "linked") == [(2_007, 1)]
    stop = last + 3_342
    assert states(two)[5:7] == [(stop, WAIT), (stop + 2_156, HANDSHAKE_ALARM)]
    stop = heard(stop) + 1
    assert states(one)[5:7] == [(stop, WAIT), (stop + 2_156, HANDSHAKE_ALARM)]
    if level == "low":  # it is the start of a message of zeros
        assert changes(two, "link_check_count")[0] == (at + 3 + 660, 1)


def test_a_flipped_bit_is_a_wrong_message_and_no_more() -> None:
    at = drives() + 5_000
    begin = 8 + 1_336 * ((at - 8) // 1_336 + 1)
    for place in range(1, 165, 7):
        bit = begin + 4 * place
        found = run(commanded(SMALL, *[0] * 3, *[1] * 3, **{"line_2.flip": between(bit, bit + 4)}))
        one = of(found, 1)
        assert changes(one, "link_check_count") == [(begin + 663, 1)], place
        assert changes(one, "linked") == [(2_007, 1)]


def test_a_stopped_clock_is_found_and_opens_the_contact() -> None:
    at, last = quiet_line(drives() + 5_000)
    images = 0, 0, 0, *[1] * 8
    found = run(commanded(SMALL, *images, **{"fpga_2.stopped": between(at, at + 30_000)}))
    one, two = of(found, 1), of(found, 2)
    assert changes(one, "linked")[1] == (last + 3_341, 0)
    assert states(one)[5] == (last + 3_342, WAIT)
    # The train of FPGA 2 stays as it is: its stage is dead 221 ticks after the last rise in it.
    rise = drives() + 1 + 200 * ((at - drives() - 1) // 200) + 2
    assert changes(found, "contact")[1] == (rise + 221 + 7_000, 0)
    for name in ("index", "life", "pulses", "link_tx"):
        assert not [tick for tick, _ in changes(two, name) if at < tick <= at + 30_000], name


def test_a_stop_counts_no_ticks() -> None:
    """Time goes on from where it was: the cycle that is under way lasts 500 ticks more."""
    found = run(commanded(SMALL, 0, **{"fpga_1.stopped": between(6_000, 6_500)}))
    assert changes(of(found, 1), "index")[:2] == [(12_500, 1), (24_500, 2)]
    assert changes(of(found, 2), "index")[:2] == [(12_000, 1), (24_000, 2)]


def test_a_reset_acts_on_a_stopped_clock_too() -> None:
    """What is as at start stays so until the clock runs again: its first tick is the new 0."""
    faults = {"fpga_1.stopped": between(6_000, 6_500), "fpga_1_rst": between(6_100, 6_103)}
    one = of(run(commanded(SMALL, 0, **faults)), 1)
    assert [tick for tick, _ in changes(one, "linked")][:2] == [2_007, 6_101]
    assert changes(one, "link_tx")[-1][0] > 6_101
    assert [tick for tick, _ in changes(one, "link_tx") if 6_101 < tick < 6_510] == [6_508]
    assert changes(one, "index")[0] == (18_500, 1)


def test_a_rogue_train_holds_its_stage_but_not_the_contact() -> None:
    """FPGA 1's stage lives on, FPGA 2's is dead as it would be anyway."""
    plain = run(commanded(SMALL, *IMAGES))
    fault = {"relay.rogue_1": between(drives() + 5_000, 120_000, 1, 2)}
    found = run(commanded(SMALL, *IMAGES, **fault))
    assert changes(found, "contact") == changes(plain, "contact")
    both = {f"relay.rogue_{c}": between(drives() + 5_000, 120_000, 1, 2) for c in (1, 2)}
    found = run(commanded(SMALL, *IMAGES, **both))
    assert changes(found, "contact")[1][0] > 120_000


def test_a_welded_contact_is_an_alarm_in_both() -> None:
    off = stored(6 * 12_000 + VERDICT)
    fault = {"relay.welded": between(drives(), 130_000, 1, 2)}
    found = run(commanded(SMALL, *IMAGES, 0, 0, **fault))
    assert changes(found, "contact")[1] == (130_001, 0)
    for fpga in (1, 2):
        assert states(of(found, fpga))[-1] == (off + 1 + 13_910, FEEDBACK_ALARM)


def test_a_reset_starts_a_domain_anew() -> None:
    at, _ = quiet_line(drives() + 5_000)
    images = 0, 0, 0, *[1] * 6
    for fpga in (1, 2):
        found = run(commanded(SMALL, *images, **{f"fpga_{fpga}_rst": between(at, at + 2)}))
        trace, peer = of(found, fpga), of(found, 3 - fpga)
        assert (at + 1, 0) in changes(trace, "image")
        assert (at + 1, IDLE) in states(trace)
        # Tick at + 2 is the new 0: the next messages begin in 8 + 1336 m of its own, the first of
        # them is out of sequence for the peer.
        assert changes(peer, "link_sequence_count")[0] == (at + 2 + 670 + 1, 1)
        assert changes(found, "contact")[-1][1] == 0
    found = run(commanded(SMALL, *images, relay_rst=between(at, at + 1)))
    assert changes(found, "contact")[:2] == [(drives() + 904, 1), (at + 1, 0)]


@pytest.mark.parametrize("delay_ticks", [0, 1, 4, 3_000])
def test_the_lines_delay_is_seen_by_the_receiver(delay_ticks: int) -> None:
    found = run(commanded(SMALL, 0), delay_ticks=delay_ticks)
    assert changes(of(found, 1), "linked")[0] == (2_007 + delay_ticks, 1)


def test_64_outputs_at_once() -> None:
    config = replace(
        SMALL,
        outputs=64,
        cycle_s=Fraction(60, 1000),
        tau0_s=Fraction(30, 1000),
        tau1_s=Fraction(30, 1000),
        release_min_s=Fraction(30, 1000),
        release_s=Fraction(31, 1000),
        margin_s=Fraction(2, 1000),
    )
    every = (1 << 64) - 1
    stimulus = commanded(config, 0, 0, 0, every, every, every ^ 1 << 63)
    model = PairModel(config, Times(), CLOCKS)
    found = model.advance(stimulus.end, stimulus, ["fpga_1.image", "contact", "fpga_2.states.2"])
    assert found["fpga_1.image"].values.tolist()[:3] == [0, every, every ^ 1 << 63]
    assert found["contact"].values.tolist()[:3] == [0, every, every ^ 1 << 63]
    drive = sum(int(DRIVE) << 3 * output for output in range(64)) >> 128
    assert drive in found["fpga_2.states.2"].values.tolist()
    assert found["fpga_2.states.2"].width == 64


def test_a_pair_costs_no_memory_for_what_is_not_asked_for() -> None:
    stimulus = commanded(SMALL, *[0] * 3, *[1] * 40)
    model = PairModel(SMALL, Times(), CLOCKS)
    found = model.advance(stimulus.end, stimulus, ["contact"])
    assert np.array_equal(found["contact"].values[:2], [0, 1])
    assert list(found.signals) == ["contact"]
