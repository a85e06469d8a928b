"""The position link's contract, tick by tick in plain Python: slow, nothing but its page."""

from __future__ import annotations

from bisect import bisect_right
from fractions import Fraction

from railgate.position_link.spec import Cause, Config, Edge, Health, Status
from railgate.waves import Trace, Waveform

GREATEST_PART = 64


class Pin:
    """A synchroniser and filter; `tick` takes one tick's level."""

    def __init__(self, filter_ticks: int) -> None:
        self.filter_ticks = filter_ticks
        self.x: list[int] = []
        self.f = [0, 0, 0]
        self.differed = 0

    def tick(self, level: int) -> tuple[int, bool, bool]:
        """What is behind the filter in this tick: the level, whether an edge, whether a glitch."""
        k = len(self.x)
        self.x.append(level)
        if k < 3:
            return 0, False, False
        s, f = self.x[k - 2], self.f
        if k == 3:
            f.append(self.x[0])
        edge = k >= 4 and f[k] != f[k - 1]
        glitch = k >= 4 and s == f[k] == f[k - 1] and self.x[k - 3] != f[k - 1]
        self.differed = self.differed + 1 if s != f[k] else 0
        passes = self.differed == self.filter_ticks + 1
        f.append(s if passes else f[k])
        self.differed = 0 if passes else self.differed
        return f[k], edge, glitch


class Link:
    """One position link since reset; `tick` takes one tick, in the order of the contract."""

    def __init__(self, config: Config) -> None:
        self.config = config
        self.k = 0
        self.fields = config.fields
        self.widths = {field.name: field.width for field in self.fields}
        self.cycle_ticks, self.delay = config.cycle_ticks, config.input_delay_ticks
        self.decision, self.delivery = config.decision_ticks, config.delivery_ticks
        self.first = config.radio_first
        self.uef, self.data = Pin(config.filter_ticks), Pin(config.filter_ticks)
        edge = config.rise if config.sampling_edge is Edge.RISING else config.fall
        self.samples = {edge(n) for n in range(config.cycle_bits)}
        self.rises = [config.rise(n) for n in range(config.cycle_bits + 1)]
        falls = [config.fall(n) for n in range(config.cycle_bits)]
        self.clock = [0] * self.cycle_ticks
        for rise, fall in zip(self.rises, falls, strict=False):
            self.clock[rise:fall] = [1] * (fall - rise)
        self.window = self.rises[config.earliest_clk - 1], self.rises[config.window_bits]
        self.seen = self.answered = False
        self.answer: list[int] | None = None
        self.rose = 0
        self.complete: list[int] | None = None
        self.sampled: list[int] = []
        self.moved: list[int] = []
        self.causes = Cause(0)
        self.up = False
        self.goods = self.faults = 0
        self.last_good: tuple[int, int] | None = None
        self.values = {field.name: field.start for field in self.fields}
        self.shown = dict(self.values)
        self.frame: str = ""

    def wrap(self, name: str, more: int) -> None:
        self.values[name] = (self.values[name] + more) % (1 << self.widths[name])

    def line(self, o: int, u: int, d: int, u_edge: bool, d_edge: bool) -> None:
        """The line's events in offset `o` of a cycle as it is seen behind the filters."""
        config, k = self.config, self.k
        opens, closes = self.window
        rise, fall = u_edge and u, u_edge and not u
        if o == 0:
            self.seen = self.answered = False
            if u and not rise:
                self.causes |= Cause.STUCK
        if o == closes and not self.seen:
            self.causes |= Cause.TIMEOUT
        if u and o < closes:
            self.seen = True
        if rise:
            if o < opens:
                self.causes |= Cause.EARLY
            elif o < closes and not self.answered:
                self.answered, self.answer, self.rose = True, [], k
            else:
                self.causes |= Cause.UNREQUESTED
        if fall and self.answer is not None:
            if len(self.answer) == config.word_bits:
                self.complete = self.answer
            else:
                self.causes |= Cause.SHORT
            self.answer = None
        if o in self.samples and self.answer is not None:
            if len(self.answer) == config.word_bits:
                self.causes |= Cause.LONG
                self.answer = None
            else:
                self.answer.append(d)
                self.sampled.append(k)
        if d_edge:
            self.moved.append(k)
        guard = config.guard_ticks
        recent = [s for s in self.sampled if k - s <= guard]
        moved = [m for m in self.moved if k - m <= guard]
        if any(s - guard < m <= s + guard for s in recent for m in moved):
            self.causes |= Cause.UNSTABLE
        self.sampled, self.moved = recent, moved

    def decide(self) -> None:
        config, values = self.config, self.values
        word = -1
        if self.complete is not None:
            word = int("".join(map(str, self.complete)), 2)
            check = config.check
            if check:
                field = word % (1 << check.width)
                if field != check.of(word >> check.width, config.word_bits - check.width):
                    self.causes |= Cause.CHECK
            if word == config.invalid_word:
                self.causes |= Cause.FAULT_WORD
            if config.zero_is_fault and word == 0:
                self.causes |= Cause.ZERO_WORD
        good = self.complete is not None and not self.causes
        self.goods, self.faults = (self.goods + 1, 0) if good else (0, self.faults + 1)
        if good:
            self.last_good = word, self.rose - config.input_delay_ticks
        if self.goods >= config.recovery_cycles:
            self.up = True
        if self.faults >= config.tolerated_cycles:
            self.up = False
        if self.up:
            assert self.last_good is not None
            values["word"] = self.last_good[0]
            values["status"] = Status.FRESH if good else Status.HELD
            values["health"] = Health.OK if good else Health.WARNING
        else:
            values["word"], values["status"] = config.invalid_word, Status.FAULT
            values["health"] = Health.RECOVERING if good else Health.ALARM
            if self.last_good is None and self.faults < config.tolerated_cycles:
                values["health"] = Health.START
        values["age"] = 0 if good else min(values["age"] + 1, (1 << config.age_bits) - 1)
        values["causes"] = self.causes
        self.wrap("number", 1)
        self.wrap("faulty_cycles", not good)
        for cause in Cause:
            assert cause.name
            self.wrap(f"{cause.name.lower()}_cycles", cause in self.causes)
        if self.last_good is not None:
            age = self.k + config.delivery_latency_ticks - self.last_good[1]
            values["age_ticks"] = min(age, (1 << config.age_ticks_bits) - 1)
        self.causes, self.complete = Cause(0), None
        self.decided = dict(values)

    def deliver(self) -> None:
        self.shown = self.decided
        config, values = self.config, dict(self.shown)
        if config.bare:
            fresh = values["status"] == Status.FRESH
            values["word"] = values["word"] if fresh else config.invalid_word
        values["number"] %= 256
        self.frame = ""
        for field in config.frame_fields:
            value = values.get(field.name, 0)
            if field.name == "check":
                value = config.radio_check.of(int(self.frame, 2), len(self.frame))
            self.frame += f"{int(value):0{field.width}b}"

    def radio(self, r: int) -> tuple[int, int]:
        """radio_valid and radio_data, r ticks after the beginning of a cycle."""
        launched = bisect_right(self.rises, r) - 1 - self.first
        if 0 <= launched < len(self.frame):
            return 1, int(self.frame[launched])
        return 0, 0

    def tick(self, pins: dict[str, int]) -> dict[str, int]:
        """The outputs in this tick, in which the inputs are `pins`."""
        k = self.k
        u, u_edge, u_glitch = self.uef.tick(pins["uef"])
        d, d_edge, d_glitch = self.data.tick(pins["data"])
        self.wrap("rejected_glitches", u_glitch + d_glitch)
        began = 1 + self.delay
        if k >= began:
            self.line((k - began) % self.cycle_ticks, u, d, u_edge, d_edge)
        outputs = {"clk": 0, "anf": 0, "delivery": 0, "radio_valid": 0, "radio_data": 0}
        if k >= 1:
            r = (k - 1) % self.cycle_ticks
            outputs["clk"] = self.clock[r]
            outputs["anf"] = int(r < self.rises[self.config.request_bits])
            if r == self.decision:
                self.decide()
            if r == self.delivery:
                self.deliver()
                outputs["delivery"] = 1
            outputs["radio_valid"], outputs["radio_data"] = self.radio(r)
        self.k += 1
        return outputs | self.shown


def signals(config: Config) -> dict[str, tuple[str, int, int]]:
    """Name of each output -> the value that it is of, its first bit in it, and its width."""
    found = {name: (name, 0, 1) for name in ("clk", "anf", "delivery")}
    for field in config.fields:
        if field.width <= GREATEST_PART:
            found[field.name] = field.name, 0, field.width
        else:
            for part, low in enumerate(range(0, field.width, GREATEST_PART)):
                width = min(GREATEST_PART, field.width - low)
                found[f"{field.name}.{part}"] = field.name, low, width
    return found | {name: (name, 0, 1) for name in ("radio_valid", "radio_data")}


def reference(config: Config, stimulus: Trace) -> Trace:
    """The outputs over the whole stimulus, from tick 0 on."""
    pins = {
        name: wave.at(range(stimulus.start, stimulus.end)).tolist()
        for name, wave in stimulus.signals.items()
    }
    names, link, last = signals(config), Link(config), {}
    seen: dict[str, list[tuple[int, int]]] = {name: [] for name in names}
    for k in range(stimulus.end):
        levels = {name: values[k] for name, values in pins.items()}
        outputs = link.tick(levels)
        for name, (value, low, width) in names.items() if outputs != last else ():
            bits = int(outputs[value]) >> low & (1 << width) - 1
            if not seen[name] or seen[name][-1][1] != bits:
                seen[name].append((k, bits))
        last = outputs
        if levels["rst"]:
            link = Link(config)
    waves = {
        name: Waveform([k for k, _ in seen[name]], [v for _, v in seen[name]], names[name][2])
        for name in names
    }
    return Trace(waves, Fraction(1, config.clock_hz), 0, stimulus.end)
