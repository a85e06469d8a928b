"""The model keeps the contract, in whatever pieces it is run."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from odometer.reference import Odometer, assert_same, reference
from odometer.stimuli import SMALL, Pins, configs, pieces, pulses, stimuli, trace
from railgate.odometer.model import Model
from railgate.odometer.spec import STATE, Config, Direction, Flag
from railgate.waves import Trace, Waveform

random = settings(max_examples=100, deadline=None, suppress_health_check=[HealthCheck.too_slow])
CUTS = st.lists(st.integers(0, 2500), max_size=12)


@pytest.mark.shows("SYS-2")
@random
@given(stimuli())
def test_equals_the_contract_taken_tick_by_tick(case: tuple[Config, Trace]) -> None:
    config, stimulus = case
    outputs = Model(config).advance(stimulus.end, stimulus)
    assert_same(outputs, reference(config, stimulus), config)
    for wave in outputs.signals.values():  # made without a check: so check them here
        made = Waveform(wave.ticks, wave.values, wave.width, wave.signed)
        assert made.values.dtype == wave.values.dtype


@random
@given(stimuli(), CUTS)
def test_pieces_equal_the_whole(case: tuple[Config, Trace], cuts: list[int]) -> None:
    config, stimulus = case
    whole = Model(config).advance(stimulus.end, stimulus)
    assert_same(pieces(Model(config), stimulus, cuts), whole, config)


@random
@given(stimuli(), CUTS, st.integers(0, 2500))
def test_a_restored_checkpoint_goes_on_as_before(
    case: tuple[Config, Trace], cuts: list[int], at: int
) -> None:
    config, stimulus = case
    model, at = Model(config), min(at, stimulus.end)
    pieces(model, stimulus.slice(0, at), cuts)
    saved = model.checkpoint()
    once = model.advance(stimulus.end, stimulus)
    for engine in (model, Model(config)):
        engine.restore(saved)
        assert engine.now == at
        assert_same(pieces(engine, stimulus, cuts), once, config)


@random
@given(stimuli(), st.integers(0, 2500), st.sampled_from(STATE), st.integers(0, 127))
def test_a_poked_register_goes_on_from_there(
    case: tuple[Config, Trace], at: int, register: str, value: int
) -> None:
    config, stimulus = case
    at = min(at, stimulus.end)
    value = -1 - value if register == "position" else value + 128

    def poke(k: int, odometer: Odometer) -> None:
        if k == at:
            odometer.sensors[-1].r[register] = value

    model = Model(config)
    before = model.advance(at, stimulus)
    model.poke(f"sensor_{config.sensors - 1}.{register}", value)
    outputs = before.concatenate(model.advance(stimulus.end, stimulus))
    assert_same(outputs, reference(config, stimulus, poke), config)


def last(outputs: Trace, name: str, sensor: int = 0) -> int:
    return int(outputs[f"sensor.{sensor}.{name}"].values[-1])


def test_a_run_at_constant_speed_gives_its_numbers() -> None:
    config = Config(sensors=1)
    pins, gap, periods = Pins(), 735, 100
    for _ in range(4 * periods):
        pins.step(gap, True)
    signals = {"sensor.0.a": pins.wave(0), "sensor.0.b": pins.wave(1)}
    signals["strobe"] = pulses([(pins.tick + 50, 1)])
    stimulus = trace(config, signals, pins.tick + 100)
    outputs = Model(config).advance(stimulus.end, stimulus)
    T, n = 4 * gap, periods - 1
    want = {
        "pulses": periods,
        "position": 4 * periods,
        "direction": Direction.FORWARD,
        "phase_direction": Direction.FORWARD,
        "period": T,
        "phase": gap,
        "period_valid": 1,
        "since_edge": 50 - config.input_delay_ticks,
        "since_rise": 3 * gap + 50 - config.input_delay_ticks,
        "window_n": n,
        "window_ticks": n * T,
        "sum_a": T * n * (n + 1) // 2,
        "sum_b": T * n * (n + 1) * (n + 2) // 6,
        "flags": 0,
    }
    assert {name: last(outputs, name) for name in want} == want
    assert outputs["sensor.0.pulses"].ticks.tolist() == [0, pins.tick + 66]
    assert outputs["time"].values.tolist() == [0, pins.tick + 50]
    assert outputs["busy"].ticks.tolist() == [0, pins.tick + 51, pins.tick + 66]


def quadrature(rises: list[int], ends: int) -> dict[str, Waveform]:
    """Forward, four even steps from each rise of a to the next."""
    changes = np.array(
        [r + (t - r) * i // 4 for r, t in pairwise([*rises, ends]) for i in range(4)]
    )
    levels = np.arange(changes.size // 2 + 1) % 2
    return {
        "sensor.0.a": Waveform.of(np.append(0, changes[0::2]), levels),
        "sensor.0.b": Waveform.of(np.append(0, changes[1::2]), levels),
        "strobe": pulses([(ends + 20, 1)]),
    }


def test_sums_keep_all_of_their_64_bits() -> None:
    config = Config(sensors=1, period_bits=40, window_pulses=5700)
    rises = [10, *range((1 << 40) - 571_000, (1 << 40) - 1_000, 100)]
    stimulus = trace(config, quadrature(rises, rises[-1] + 100), rises[-1] + 200)
    outputs = Model(config).advance(stimulus.end, stimulus)
    sum_a = [0]
    for rise in rises[1:]:
        sum_a.append(sum_a[-1] + rise - rises[0])
    assert last(outputs, "window_n") == len(rises) - 1 == 5700
    assert last(outputs, "sum_a") == sum_a[-1]
    assert last(outputs, "sum_b") == sum(sum_a) > 1 << 63


def test_the_longest_phase_is_judged_without_overflow() -> None:
    config = Config(sensors=1, period_bits=40, window_pulses=1)
    T = (1 << 40) - 2
    stimulus = trace(config, quadrature([10, 10 + T], 1000 + T), T + 1200)
    outputs = Model(config).advance(stimulus.end, stimulus)
    assert (last(outputs, "period"), last(outputs, "phase")) == (T, T // 4)
    assert last(outputs, "period_valid") == 1
    assert last(outputs, "phase_direction") == Direction.FORWARD


def test_standstill_costs_nothing() -> None:
    config = Config(stamp_depth=16)
    idle = trace(config, {"rst": Waveform.of([0], [0])}, 10**15)
    outputs = Model(config).advance(10**15, idle)
    assert all(len(wave) == 1 for wave in outputs.signals.values())


def test_inputs_left_out_keep_their_level() -> None:
    config, pins = Config(**SMALL), Pins()
    for _ in range(32):
        pins.step(7, True)
    signals = {"sensor.0.a": pins.wave(0), "sensor.0.b": pins.wave(1)}
    signals["strobe"] = pulses([(200, 100)])
    full = trace(config, signals, 300)
    held = Trace(
        {
            name: Waveform.of(*zip(*((t, wave.at(t)) for t in range(300)), strict=True))
            for name, wave in full.slice(0, 120).extend(300).signals.items()
        },
        full.period,
        0,
        300,
    )
    model = Model(config)
    parts = [model.advance(120, full)]
    parts += [model.advance(end, full.slice(120, 300).select([])) for end in (121, 300)]
    whole = parts[0].concatenate(parts[1]).concatenate(parts[2])
    assert_same(whole, Model(config).advance(300, held))


def test_what_does_not_fit_is_refused() -> None:
    config = Config(**SMALL)
    model, good = Model(config), trace(config, {}, 100)
    model.advance(10, good)
    other = Trace(good.signals, good.period / 2, 0, 100)
    wide = Trace({"rst": Waveform.of([0], [0], 2)}, good.period, 0, 100)
    for until, stimulus, message in (
        (9, good, "is at tick 10 already, it cannot run to tick 9"),
        (101, good, r"must cover ticks 10..101, not 0..100"),
        (20, good.slice(11, 90), r"must cover ticks 10..20, not 11..90"),
        (
            20,
            good.rename({"rst": "reset"}),
            'no input "reset" in odometer; there are: .*strobe, rst',
        ),
        (20, other, "must last 1/20000 s, not 1/40000 s"),
        (20, wide, '"rst" must be 1 bit, not 2 bits'),
    ):
        with pytest.raises(ValueError, match=message):
            model.advance(until, stimulus)
    with pytest.raises(ValueError, match=r'no register "sensor_0.period".*: .*illegal_transitions'):
        model.poke("sensor_0.period", 1)
    with pytest.raises(ValueError, match=r'"sensor_1.position" in odometer; there are: sensor_0'):
        model.poke("sensor_1.position", 1)
    assert model.registers == tuple(f"sensor_0.{name}" for name in STATE)
    with pytest.raises(ValueError, match="between -128 and 127, not 128"):
        model.poke("sensor_0.position", 128)
    with pytest.raises(ValueError, match="a checkpoint must be of"):
        Model(Config()).restore(model.checkpoint())
    assert model.now == 10


@settings(max_examples=1, deadline=None)
@given(configs())
def test_no_time_is_no_event(config: Config) -> None:
    model = Model(config)
    high = Waveform.of([0], [1])
    stimulus = trace(config, {"sensor.0.a": high, "strobe": high}, 50)
    nothing = model.advance(0, stimulus)
    assert (nothing.start, nothing.end) == (0, 0)
    assert_same(model.advance(50, stimulus), Model(config).advance(50, stimulus))


def test_every_flag_is_reached_by_the_random_stimuli() -> None:
    """So that equality above is not of things that never happen."""
    seen = Flag(0)

    @settings(max_examples=1000, deadline=None, derandomize=True, database=None)
    @given(stimuli())
    def gather(case: tuple[Config, Trace]) -> None:
        nonlocal seen
        config, stimulus = case
        outputs = Model(config).advance(stimulus.end, stimulus)
        for i in range(config.sensors):
            for flags in outputs[f"sensor.{i}.flags"].values:
                seen |= Flag(int(flags))

    gather()
    assert seen == ~Flag(0), ~seen
