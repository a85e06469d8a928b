"""A CPU, the network's time, the peer, the relay and the feedback, for one channel."""

from __future__ import annotations

from fractions import Fraction
from math import ceil

from railgate.engines import open_engine
from railgate.vital_output.loop import loop
from railgate.vital_output.plant import Command, RelayTimes, Scenario
from railgate.vital_output.situations import ready_s
from railgate.vital_output.spec import Config
from railgate.waves import Trace

__all__ = ["channel"]

OWN = ("command.payload", "command.valid", "time.index", "time.phase", "time.valid", "boot", "test")


def channel(config: Config, board: int) -> Trace:
    """The inputs that the channel of this board has in a run of both, of their models: the start-up
    test of the shut-off paths, then output 0 is commanded on, its relay picks up, and off."""
    on = ready_s(config)
    off = on + (1 + ceil(Fraction(config.pick_up_ticks, config.cycle_ticks))) * config.cycle_s
    scenario = Scenario(
        commands=(Command(start_s=on, image=1), Command(start_s=off, image=0)),
        seconds=off + config.cycle_s,
        relay=RelayTimes(
            pick_up_s=config.pick_up_s * Fraction(3, 4),
            release_s=(config.release_min_s + config.release_s) / 2,
        ),
    )
    controls = scenario.controls(config)
    pair = open_engine(loop(config, scenario.relay, scenario.clocks(config)), "leap")
    own, peer = (f"fpga_{1 + number}." for number in (board, 1 - board))
    answers = {f"{peer}link_tx": "link_rx", f"{own}pulses": "pulse_feedback", "contact": "contact"}
    told = pair.advance(controls.end, controls, list(answers))
    inputs = controls.select(own + name for name in OWN)
    inputs = inputs.rename({own + name: name for name in OWN})
    return inputs.merge(told.rename(answers)).resample(Fraction(1, config.clock_hz))
