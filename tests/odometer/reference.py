"""The odometer's contract, tick by tick in plain Python: slow, and nothing but spec.py's page."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from typing import Any

from railgate.odometer.spec import Config, Direction, Flag
from railgate.waves import Trace, Waveform

STAMP_BITS = 35
Levels = dict[str, int]


class Sensor:
    """One sensor; `tick` takes one tick, in the order of the contract."""

    def __init__(self, config: Config) -> None:
        self.config = config
        self.x: dict[str, list[int]] = {"a": [], "b": []}
        self.f = {"a": [0, 0, 0], "b": [0, 0, 0]}
        self.differed = {"a": 0, "b": 0}
        self.r: dict[str, int] = dict.fromkeys((f.name for f in config.sensor_fields), 0)
        self.flags = Flag(0)
        self.k_rise = self.k_edge = self.k_either = 0
        self.has_risen = False
        self.first_b: int | None = None
        self.unclean = False
        self.armed = False
        self.faults = 0
        self.runs = {"a": 0, "b": 0}
        self.window: list[int] | None = None
        self.entries: list[tuple[int, int]] = []
        self.taken: list[int] = []
        self.lost = 0

    def wrap(self, name: str, more: int) -> None:
        field = next(f for f in self.config.sensor_fields if f.name == name)
        value = (self.r[name] + more) % (1 << field.width)
        if field.signed and value >= 1 << field.width - 1:
            value -= 1 << field.width
        self.r[name] = value

    def filtered(self, k: int, channel: str) -> tuple[bool, bool]:
        """Append f[k]; returns whether tick k has an edge, and a glitch."""
        x, f = self.x[channel], self.f[channel]
        if k < 3:
            return False, False
        s = x[k - 2]
        if k == 3:
            f.append(x[0])
        edge = k >= 4 and f[k] != f[k - 1]
        glitch = k >= 4 and s == f[k] == f[k - 1] and x[k - 3] != f[k - 1]
        self.differed[channel] = self.differed[channel] + 1 if s != f[k] else 0
        if self.differed[channel] == self.config.filter_ticks + 1:
            self.differed[channel] = 0
            f.append(s)
        else:
            f.append(f[k])
        return edge, glitch

    def void(self) -> None:
        if self.window is not None:
            self.flags |= Flag.WINDOW_VOID
        self.window = None

    def saturation(self, k: int) -> None:
        if k - self.k_rise == self.config.period_max:
            self.flags |= Flag.SATURATED
        if self.window is not None and k - self.window[0] == self.config.period_max:
            self.flags |= Flag.SATURATED
            self.void()

    def step(self, k: int, edges: dict[str, bool]) -> None:
        cycle = [(0, 0), (1, 0), (1, 1), (0, 1)]
        was, now = ((self.f["a"][j], self.f["b"][j]) for j in (k - 1, k))
        if edges["a"] and edges["b"]:
            self.flags |= Flag.ILLEGAL
            self.wrap("illegal_transitions", 1)
            self.r["direction"] = Direction.NONE
        else:
            forward = (cycle.index(was) + 1) % 4 == cycle.index(now)
            self.wrap("position", 1 if forward else -1)
            before = self.r["direction"]
            self.r["direction"] = Direction.FORWARD if forward else Direction.REVERSE
            if before in (Direction.NONE, self.r["direction"]):
                return
            self.flags |= Flag.REVERSAL
            self.wrap("direction_changes", 1)
        self.void()
        self.unclean = True

    def gap(self, k: int) -> None:
        if k - self.k_either > self.config.watch_ticks:
            self.runs = {"a": 0, "b": 0}
            self.armed = False
        self.k_either = k

    def period(self, k: int) -> None:
        T = min(k - self.k_rise, self.config.period_max)
        phase = min(self.first_b or 0, self.config.period_max)
        clean = self.config.period_max > T and not self.unclean
        heading = Direction.NONE
        if clean and T <= 8 * phase <= 3 * T:
            heading = Direction.FORWARD
        if clean and 5 * T <= 8 * phase <= 7 * T:
            heading = Direction.REVERSE
        self.r |= {"period": T, "phase": phase, "period_valid": clean, "phase_direction": heading}
        if clean and self.config.watch_ticks >= T and heading == Direction.NONE:
            self.faults += 1
            if self.faults >= self.config.phase_fault_periods:
                self.flags |= Flag.PHASE_FAULT
        else:
            self.faults = 0
        if clean:
            self.armed = self.config.watch_ticks >= T
        if clean and self.config.period_min_ticks > T:
            self.flags |= Flag.OVERSPEED

    def rise_of_a(self, k: int) -> None:
        if self.r["pulses"] == (1 << self.config.count_bits) - 1:
            self.flags |= Flag.SATURATED
        else:
            self.r["pulses"] += 1
        self.wrap("a_rising", 1)
        if self.has_risen:
            self.period(k)
        self.has_risen, self.k_rise, self.first_b, self.unclean = True, k, None, False
        if self.window is not None and len(self.window) == self.config.window_pulses + 1:
            self.flags |= Flag.WINDOW_OVERFLOW
            self.void()
        self.window = [*(self.window or []), k]

    def rise_of_b(self, k: int) -> None:
        self.wrap("b_rising", 1)
        if self.has_risen and self.first_b is None and k > self.k_rise:
            self.first_b = k - self.k_rise

    def both_channels(self, rises: list[str]) -> None:
        for channel, other, flag in (("a", "b", Flag.B_MISSING), ("b", "a", Flag.A_MISSING)):
            if rises == [channel]:
                self.runs[channel] = min(self.runs[channel] + 1, self.config.missing_pulses)
                self.runs[other] = 0
                if self.runs[channel] >= 2 and self.armed:
                    self.flags |= Flag.MISMATCH
                if self.runs[channel] >= self.config.missing_pulses:
                    self.flags |= flag
        if len(rises) == 2:
            self.runs = {"a": 0, "b": 0}

    def stamp(self, k: int) -> None:
        held = len(self.entries) - sum(1 for tick in self.taken if tick < k)
        if held == self.config.stamp_depth:
            self.flags |= Flag.STAMP_OVERFLOW
            self.lost = 1
            return
        word = k % (1 << 32) | self.f["a"][k] << 32 | self.f["b"][k] << 33 | self.lost << 34
        self.entries.append((k, word))
        self.lost = 0

    def offer(self, k: int, ready: int) -> tuple[int, int]:
        """valid and payload of tick k, taken where ready."""
        waiting = self.entries[len(self.taken) :]
        if not waiting or k < waiting[0][0] + self.config.stamp_latency_ticks:
            return 0, 0
        if ready:
            self.taken.append(k)
        return 1, waiting[0][1]

    def strobe(self, k: int) -> dict[str, int]:
        sums, window = [0], self.window or []
        for edge in window[1:]:
            sums.append(sums[-1] + edge - window[0])
        latched = self.r | {
            "level_a": self.f["a"][k],
            "level_b": self.f["b"][k],
            "since_rise": min(k - self.k_rise, self.config.period_max),
            "since_edge": min(k - self.k_edge, self.config.period_max),
            "window_seated": int(self.window is not None),
            "window_n": max(len(window) - 1, 0),
            "window_ticks": window[-1] - window[0] if window else 0,
            "sum_a": sums[-1],
            "sum_b": sum(sums),
            "flags": int(self.flags),
        }
        self.r["pulses"], self.flags = 0, Flag(0)
        if self.window is not None:
            self.window = self.window[-1:]
        return {name: int(value) for name, value in latched.items()}

    def tick(self, k: int, pins: Levels) -> None:
        edges = {}
        for channel in ("a", "b"):
            self.x[channel].append(pins[channel])
            edges[channel], glitch = self.filtered(k, channel)
            if glitch:
                self.flags |= Flag.GLITCH
                self.wrap("rejected_glitches", 1)
        self.saturation(k)
        if not any(edges.values()):
            return
        self.step(k, edges)
        rises = [channel for channel in ("a", "b") if edges[channel] and self.f[channel][k]]
        if rises:
            self.gap(k)
        if "a" in rises:
            self.rise_of_a(k)
        if "b" in rises:
            self.rise_of_b(k)
        self.both_channels(rises)
        self.k_edge = k
        if self.config.stamp_depth:
            self.stamp(k)


class Odometer:
    """All sensors and the gate, as after reset."""

    def __init__(self, config: Config) -> None:
        self.config, self.k, self.number = config, 0, 0
        self.sensors = [Sensor(config) for _ in range(config.sensors)]
        self.gate: int | None = None
        self.latched: Levels = {}
        self.shown = dict.fromkeys((f.name for f in config.common_fields), 0)
        for i in range(config.sensors):
            self.shown |= dict.fromkeys((f"sensor.{i}.{f.name}" for f in config.sensor_fields), 0)

    def tick(self, pins: Levels) -> Levels:
        """The outputs in this tick, in which the inputs are `pins`."""
        k, config = self.k, self.config
        if self.gate is not None and k == self.gate + config.snapshot_latency_ticks:
            self.shown, self.gate = self.latched, None
        outputs = {**self.shown, "busy": int(self.gate is not None)}
        for i, sensor in enumerate(self.sensors):
            sensor.tick(k, {channel: pins[f"sensor.{i}.{channel}"] for channel in ("a", "b")})
            if config.stamp_depth:
                valid, payload = sensor.offer(k, pins[f"sensor.{i}.stamps.ready"])
                outputs[f"sensor.{i}.stamps.valid"] = valid
                outputs[f"sensor.{i}.stamps.payload"] = payload
        if pins["strobe"] and self.gate is None:
            self.gate, self.number = k, self.number + 1
            self.latched = {
                "number": self.number % (1 << config.count_bits),
                "time": k % (1 << config.time_bits),
            }
            for i, sensor in enumerate(self.sensors):
                latched = sensor.strobe(k)
                self.latched |= {f"sensor.{i}.{name}": value for name, value in latched.items()}
        self.k += 1
        return outputs


def widths(config: Config) -> dict[str, tuple[int, bool]]:
    """Name of each output -> its width and sign."""
    named = {"busy": (1, False)} | {f.name: (f.width, f.signed) for f in config.common_fields}
    for i in range(config.sensors):
        named |= {f"sensor.{i}.{f.name}": (f.width, f.signed) for f in config.sensor_fields}
        if config.stamp_depth:
            named[f"sensor.{i}.stamps.valid"] = (1, False)
            named[f"sensor.{i}.stamps.payload"] = (STAMP_BITS, False)
    return named


def reference(
    config: Config, stimulus: Trace, poke: Callable[[int, Odometer], Any] = lambda _k, _o: None
) -> Trace:
    """The outputs over the whole stimulus, from tick 0 on; `poke` is called before each tick."""
    pins = {
        name: wave.at(range(stimulus.start, stimulus.end)).tolist()
        for name, wave in stimulus.signals.items()
    }
    names, odometer = widths(config), Odometer(config)
    seen: dict[str, list[tuple[int, int]]] = {name: [] for name in names}
    for k in range(stimulus.end):
        poke(k, odometer)
        levels = {name: values[k] for name, values in pins.items()}
        for name, value in odometer.tick(levels).items():
            if not seen[name] or seen[name][-1][1] != value:
                seen[name].append((k, value))
        if levels["rst"]:
            odometer = Odometer(config)
    waves = {
        name: Waveform([k for k, _ in seen[name]], [v for _, v in seen[name]], *names[name])
        for name in names
    }
    return Trace(waves, Fraction(1, config.clock_hz), 0, stimulus.end)


def assert_same(left: Trace, right: Trace, *case: object) -> None:
    difference = left.first_difference(right)
    assert difference is None, (str(difference), *case)
