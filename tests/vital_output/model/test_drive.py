"""The outputs' state machines in the model's channel keep the contract (DRV-8 … DRV-12, DRV-18).

Messages as in test_link: message m of the peer begins in tick 100 + 1336 m, its fields are the
peer's from tick 763 + 1336 m on. A pulse train has a period of 200 ticks; a rise or fall of
feedback is seen 5 ticks late, of the contact 8.
"""

import pytest

from railgate.vital_output.spec import Code, State, TestPhase
from vital_output.model.bench import Bench, changes, states
from vital_output.small import SMALL

PERIOD = 1_336
IDLE, PRE_DRIVE, DRIVE, WAIT, TEST, HANDSHAKE_ALARM, FEEDBACK_ALARM = State


def begin(number: int) -> int:
    return 100 + PERIOD * number


def heard(number: int) -> int:
    """From this tick on the message is the peer's."""
    return 763 + PERIOD * number


def quiet(end: int = 60_000) -> Bench:
    """FPGA 2, whose test begins when it hears in tick 2099 that the peer's is done: TEST from 2100
    on, WAIT from 6054 on, IDLE from 6307 on, done from 6308 on."""
    bench = Bench(board=1)
    bench.peer(100, end, (0, {"test": TestPhase.DONE}))
    bench.train(3, 2_101, 6_054)
    return bench


def test_the_test_drives_each_output_alone_and_then_waits_for_its_feedback_to_end() -> None:
    run = quiet().run(8_000)
    assert changes(run, "test_phase") == [(2_100, TestPhase.RUNNING), (6_308, TestPhase.DONE)]
    for output in (0, 1):
        assert states(run, output) == [(2_100, TEST), (6_054, WAIT), (6_307, IDLE)]
    # The last rise at the pin is in 5901, seen in 5906: 400 ticks later there is none.
    pulses = changes(run, "pulses")
    assert pulses[:3] == [(2_101, 3), (2_201, 0), (2_301, 3)]
    assert pulses[-2:] == [(5_901, 3), (6_001, 0)]


@pytest.mark.parametrize("board", [0, 1])
def test_the_test_begins_with_a_peer_that_is_ready_for_it(board: int) -> None:
    for phase in TestPhase:
        bench = Bench(board=board)
        bench.peer(100, 4_000, (0, {"test": phase}))
        begins = phase == TestPhase.WANTED if board == 0 else phase >= TestPhase.DONE
        assert bool(changes(bench.run(2_200), "test_phase")) == begins, phase


def test_a_test_without_pulses_at_the_right_frequency_fails() -> None:
    for missing, state in ((2_000, WAIT), (5_701, FEEDBACK_ALARM)):
        bench = quiet()
        bench.drawn["pulse_feedback"].pop(missing, None)
        bench.drawn["pulse_feedback"].pop(missing + 100, None)
        run = bench.run(6_100)
        assert states(run)[-1] == (6_054, state), missing


def test_a_contact_that_moves_in_the_test_fails_it() -> None:
    bench = quiet()
    bench.set("contact", 3_000, 2)
    run = bench.run(7_000)
    assert states(run, 1)[:2] == [(2_100, TEST), (3_009, FEEDBACK_ALARM)]
    assert states(run, 0)[:2] == [(2_100, TEST), (6_054, WAIT)]
    assert changes(run, "feedback_alarm_count") == [(3_009, 1)]
    assert changes(run, "first_output") == [(3_009, 1)]


def test_what_moves_while_the_peer_tests_is_an_alarm() -> None:
    for name, late in (("pulse_feedback", 5), ("contact", 8)):
        for phase, state in ((TestPhase.WANTED, WAIT), (TestPhase.RUNNING, FEEDBACK_ALARM)):
            bench = Bench(board=1)
            bench.peer(100, 5_000, (0, {"test": phase}))
            bench.set(name, 3_000, 1)
            found = states(bench.run(3_100))
            # A contact's level counts in its first tick, a rise in the one after.
            assert found == [(3_000 + late + 1 + (name == "pulse_feedback"), state)]


def test_a_feedback_level_is_no_feedback_after_two_periods() -> None:
    bench = quiet()
    bench.set("pulse_feedback", 7_000, 1)
    run = bench.run(9_000)
    # The rise is seen in 7005: fb from 7006 to 7404.
    assert states(run)[3:] == [(7_007, WAIT), (7_406, IDLE)]


def driving(*steps: tuple[int, dict[str, int]], end: int = 60_000) -> Bench:
    """After the test: image 0 is stored in tick 11450, image 1 in 26146; each from the next on."""
    bench = quiet(end)
    bench.trust(5, 1_000)
    frames = [(8_000, 5, 2, 0), (14_000, 6, 3, 1)]
    bench.frame(7_000, 5, sequence=1)
    told: list[tuple[int, dict[str, int]]] = [(0, {"test": TestPhase.DONE})]
    for tick, index, sequence, image in frames:
        values = {"sequence": sequence, "image": image, "acknowledge": 0}
        bench.frame(tick, index, **values)
        crc = SMALL.layout.crc(SMALL.boards[0], index, values)
        told.append((tick, {"carries": 1, "passed": 0, **values, "frame_crc": crc}))
        told.append((tick + PERIOD, {"passed": 1}))
    bench.peer(100, end, *told, *steps)
    return bench


STORED = heard(12)
"""The tick in which image 1 is stored: message 11 brings the frame, 12 that it has passed."""


def test_a_command_is_obeyed_once_it_has_been_0() -> None:
    run = driving().run(18_000)
    assert changes(run, "stored_count") == [(heard(7) + 1, 1), (STORED + 1, 2)]
    assert changes(run, "blocked") == [(heard(7) + 2, 0)]
    assert changes(run, "image") == [(STORED + 1, 1)]
    assert states(run)[3:] == [(STORED + 2, PRE_DRIVE)]


def test_without_the_peer_the_command_is_given_up_after_tau1() -> None:
    run = driving().run(30_000)
    entry = STORED + 2
    assert states(run)[3:] == [(entry, PRE_DRIVE), (entry + 6_500, HANDSHAKE_ALARM)]
    assert changes(run, "handshake_alarm_count") == [(entry + 6_500, 1)]


def codes(*of: Code) -> dict[str, int]:
    return {"codes": sum(code << 2 * output for output, code in enumerate(of))}


def fed_back(bench: Bench, entry: int, until: int) -> Bench:
    bench.train(1, entry + 1, until)
    return bench


def test_with_the_peer_it_drives_and_stops_at_once_when_the_peer_is_off() -> None:
    bench = driving((begin(14), codes(Code.PRE_DRIVE)), (begin(15), codes(Code.OFF)))
    entry, stop = heard(14) + 1, heard(15) + 1
    run = fed_back(bench, entry, stop).run(26_000)
    # With cmd still 1 it is an alarm after the skew of decisions, 2155 ticks.
    assert states(run)[4:] == [(entry, DRIVE), (stop, WAIT), (stop + 2_156, HANDSHAKE_ALARM)]
    turns = [entry + 1 + 100 * half for half in range(14)]
    assert changes(run, "pulses")[-14:] == [(tick, 1 - i % 2) for i, tick in enumerate(turns)]


def test_a_pulse_ends_with_its_state() -> None:
    bench = driving((begin(14), codes(Code.DRIVE)))
    run = bench.run(26_000)
    assert states(run)[5] == (heard(14) + 1 + 606, FEEDBACK_ALARM)
    # The pulse that began 600 ticks after the entry ends one tick after the state.
    assert changes(run, "pulses")[-2:] == [(heard(14) + 602, 1), (heard(14) + 608, 0)]


def test_a_peer_that_does_not_drive_is_tolerated_for_so_long() -> None:
    entry = heard(14) + 1
    bench = fed_back(driving((begin(14), codes(Code.PRE_DRIVE))), entry, 60_000)
    bench.set("contact", entry + 1_000, 1)
    run = bench.run(30_000)
    assert states(run)[4:] == [(entry, DRIVE), (entry + 4_294, HANDSHAKE_ALARM)]


def test_the_frequency_must_be_right_after_its_grace_and_ever_after() -> None:
    entry = heard(14) + 1
    for last, stop in ((0, 605), (10 * 200, 10 * 200 + 1 + 5 + 220 + 1)):
        bench = fed_back(driving((begin(14), codes(Code.DRIVE))), entry, entry + last + 2)
        bench.set("contact", entry + 300, 1)
        run = bench.run(30_000)
        assert states(run)[4:] == [(entry, DRIVE), (entry + stop + 1, FEEDBACK_ALARM)], last


def test_the_contact_must_be_closed_after_pick_up_and_ever_after() -> None:
    entry = heard(14) + 1
    for until, stop in ((entry + 10, 3_754), (entry + 4_000, 4_008)):
        bench = fed_back(driving((begin(14), codes(Code.DRIVE))), entry, 60_000)
        bench.set("contact", entry + 5, 1)
        bench.set("contact", until, 0)
        run = bench.run(30_000)
        assert states(run)[4:] == [(entry, DRIVE), (entry + stop + 1, FEEDBACK_ALARM)], until


def test_an_alarm_of_the_peer_is_an_alarm() -> None:
    entry = heard(14) + 1
    bench = fed_back(
        driving((begin(14), codes(Code.DRIVE)), (begin(16), codes(Code.ALARM))), entry, 60_000
    )
    bench.set("contact", entry + 5, 1)
    assert states(bench.run(30_000))[4:] == [(entry, DRIVE), (heard(16) + 1, HANDSHAKE_ALARM)]


def test_a_lost_link_stops_driving() -> None:
    entry = heard(14) + 1
    bench = fed_back(driving((begin(14), codes(Code.DRIVE)), end=begin(15)), entry, 60_000)
    bench.set("contact", entry + 5, 1)
    run = bench.run(30_000)
    # Message 14 is the last, taken in the tick before it is heard: lost 3340 ticks after that.
    assert changes(run, "linked")[1:] == [(heard(14) + 3_340, 0)]
    assert states(run)[4:] == [
        (entry, DRIVE),
        (heard(14) + 3_341, WAIT),
        (heard(14) + 3_341 + 2_156, HANDSHAKE_ALARM),
    ]


@pytest.mark.parametrize("stuck", [False, True])
def test_the_contact_must_open_in_the_release_time(stuck: bool) -> None:
    """The command ends with the life of image 1, three cycles after its own."""
    entry, ends = heard(14) + 1, 67_457
    bench = fed_back(driving((begin(14), codes(Code.DRIVE)), end=90_000), entry, ends + 2)
    bench.set("contact", entry + 5, 1)
    if not stuck:
        bench.set("contact", ends + 13_000, 0)
    run = bench.run(90_000)
    assert changes(run, "image")[1:] == [(ends, 0)]
    last = (ends + 1 + 13_910, FEEDBACK_ALARM) if stuck else (ends + 13_009, IDLE)
    assert states(run)[4:] == [(entry, DRIVE), (ends + 1, WAIT), last]


def test_an_output_is_tested_again_when_asked_and_quiet() -> None:
    """FPGA 1 asks itself; a request of FPGA 2 reaches it by its messages."""
    for board in (0, 1):
        bench = Bench(board=board)
        done = {"test": TestPhase.DONE if board else TestPhase.WANTED}
        bench.peer(100, 20_000, (0, done), (5_000, {"test": TestPhase.DONE}))
        bench.train(3, 2_101, 6_054)
        bench.set("test", 8_000, 1)
        bench.set("test", 8_001, 0)
        run = bench.run(8_100)
        phases = [(2_100, TestPhase.RUNNING), (6_308, TestPhase.DONE)]
        phases.append((8_001, TestPhase.REQUESTED))
        phases += [(8_002, TestPhase.WANTED)] if board == 0 else []
        assert changes(run, "test_phase") == phases
