"""The figures of each target on each part, over several seeds (SYS-3).

They are kept in `<folder>/fpga.json`, rewritten as they come: an array of one object a target and
part, with `target`, `part`, `digest` (of the sources that were placed; null where there were none),
`fmax_worst_mhz`, `fmax_median_mhz` (null where nothing was placed), `lut`, `ff`, `ram`, `dsp` (of
the target alone; null where it was not synthesised), `goal_mhz` (for the worst seed),
`goal_median_mhz`, `lut_ratio` (its LUTs for each of its peer's; null where it has none),
`goal_lut_ratio`, `met` (null where there is no goal, or while SEEDS have not been placed and none
falls short), `seeds` (how many were placed), `failed` (why not all were, else empty). What the
tools made stays in `<folder>/fpga`, see Flow.
"""

from __future__ import annotations

import json
import statistics
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from itertools import product
from pathlib import Path

from railgate.fpga.flow import Flow
from railgate.fpga.parts import REFERENCE, Area, part
from railgate.fpga.targets import TARGETS, Goal, Target
from railgate.fpga.tools import UnplacedError
from railgate.waves import replacing

__all__ = ["SEEDS", "Row", "report"]

SEEDS = 5
"""Seeds 1 … SEEDS must be placed before a goal is met."""


@dataclass(frozen=True)
class Row:
    """What one target came to.

    digest: of its sources. area: of the target alone; peer: of its peer alone. fmax_mhz: of
    seeds 1, 2, …. failed: why a seed is missing.
    """

    target: str
    part: str
    goal: Goal | None = None
    digest: str | None = None
    area: Area | None = None
    peer: Area | None = None
    fmax_mhz: tuple[float, ...] = ()
    failed: str = ""

    @property
    def worst_mhz(self) -> float | None:
        return min(self.fmax_mhz, default=None)

    @property
    def median_mhz(self) -> float | None:
        return statistics.median(self.fmax_mhz) if self.fmax_mhz else None

    @property
    def lut_ratio(self) -> float | None:
        return self.area.lut / self.peer.lut if self.area and self.peer else None

    @property
    def met(self) -> bool | None:
        """Whether the goal is; None without one, or while that is open."""
        if self.goal is None:
            return None
        if self.failed or (self.fmax_mhz and min(self.fmax_mhz) < self.goal.worst_mhz):
            return False
        if self.goal.lut_ratio and self.lut_ratio and self.lut_ratio > self.goal.lut_ratio:
            return False
        if len(self.fmax_mhz) < SEEDS:
            return None
        return statistics.median(self.fmax_mhz) >= (self.goal.median_mhz or 0)

    def as_json(self) -> dict[str, object]:
        """See the module."""
        area = dict.fromkeys(asdict(Area())) if self.area is None else asdict(self.area)
        return {
            "target": self.target,
            "part": self.part,
            "digest": self.digest,
            "fmax_worst_mhz": _rounded(self.worst_mhz),
            "fmax_median_mhz": _rounded(self.median_mhz),
            **area,
            "goal_mhz": self.goal and self.goal.worst_mhz,
            "goal_median_mhz": self.goal and self.goal.median_mhz,
            "lut_ratio": self.lut_ratio and round(self.lut_ratio, 2),
            "goal_lut_ratio": self.goal and self.goal.lut_ratio,
            "met": self.met,
            "seeds": len(self.fmax_mhz),
            "failed": self.failed,
        }


def report(
    targets: Mapping[str, Target],
    parts: Sequence[str] = (REFERENCE,),
    *,
    seeds: int = SEEDS,
    limit_s: float = 1800.0,
    folder: Path = Path("build"),
    placed: Callable[[], None] = lambda: None,
) -> list[Row]:
    """Place each target on each part with seeds 1 … seeds; what `folder` keeps is not placed again.

    parts: by name. limit_s: the longest time for one call of a tool. placed: called after each
    seed. A target that cannot be placed has its row all the same. Raises ValueError.
    """
    for name in parts:
        part(name, free_pins=True)
    rows: list[Row] = []
    for on, (name, target) in product(parts, targets.items()):
        rows.append(Row(name, on, target.goal if on == REFERENCE else None))
        for row in _placements(target, rows[-1], seeds, limit_s, folder / "fpga"):
            rows[-1] = row
            _keep(rows, folder / "fpga.json")
            placed()
    return rows


def _placements(target: Target, row: Row, seeds: int, limit_s: float, kept: Path) -> Iterator[Row]:
    """The row after each seed; where one fails, no further seed is tried."""
    try:
        sources = target.sources()
    except ValueError as error:
        yield replace(row, failed=str(error))
        return
    try:
        flow = Flow(row.target, sources, row.part, kept, limit_s)
        row = replace(row, digest=sources.digest, area=flow.synthesise().inside)
        if target.peer:
            other = Flow(target.peer, TARGETS[target.peer].sources(), row.part, kept, limit_s)
            row = replace(row, peer=other.synthesise().inside)
        for seed in range(1, seeds + 1):
            row = replace(row, fmax_mhz=(*row.fmax_mhz, flow.place(seed)))
            yield row
    except UnplacedError as error:
        yield replace(row, failed=str(error))


def _keep(rows: Sequence[Row], path: Path) -> None:
    with replacing(path) as new:
        told = [row.as_json() for row in rows]
        new.write_text(json.dumps(told, ensure_ascii=False, indent=1) + "\n", encoding="utf-8")


def _rounded(mhz: float | None) -> float | None:
    return None if mhz is None else round(mhz, 1)
