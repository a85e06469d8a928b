"""What the frame's CRC detects, and how likely an error passes: for two polynomials, side by side.

Exact are all counts, ranks and distances, and the probability of errors in the bits sent: see
`few` and `spectrum`. Bounded is only what passes both checks where errors lie anywhere in an
Ethernet frame. For error bits each for itself, at a rate of 1/2 at most, no sum of syndromes is
likelier than 0, since the Fourier transform of their distribution, (1 - 2p)^weight, is nowhere
below 0. So whatever an error in the command frame leaves of the frame check sequence, the bits
around it make up for it at most as likely as they pass by themselves.

An error in the padding of image or acknowledge counts like any other, though a channel rejects it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from railgate.vital_output.residual.carriage import Carriage, carriages
from railgate.vital_output.residual.few import Few, distances, few
from railgate.vital_output.residual.linear import burst, syndromes
from railgate.vital_output.residual.spectrum import (
    MOST_GENERATORS,
    Spectrum,
    probability,
    spectrum,
)
from railgate.vital_output.spec import Config
from railgate.vital_output.spec.frame import CRC_BITS, bits

__all__ = [
    "FEW",
    "RATES",
    "REQUIRED_BITS",
    "REQUIRED_RATE",
    "Carried",
    "Comparison",
    "Evidence",
    "compare",
]

FEW = 7
"""Errors of so many bits are counted at every length."""
REQUIRED_BITS = 274
"""Data bits up to which DRV-4 wants a Hamming distance of 8."""
REQUIRED_RATE = 1e-2
"""The error rate of a bit at which IEC 61784-3 wants the residual error rate told."""
RATES: tuple[float, ...] = tuple(np.geomspace(1e-6, 0.5, 400).tolist())
"""Error rates of a bit that curves and greatest values are made of."""

Told = Callable[[float], None]


@dataclass(frozen=True, eq=False)
class Carried:
    """A frame on a line with a check of its own. spectrum: of errors in the frame that pass both;
    None where there are too many to be made."""

    carriage: Carriage
    rank: int
    bursts: tuple[int, int]
    generators: tuple[int, int]
    spectrum: Spectrum | None

    @property
    def distance(self) -> int | None:
        return None if self.spectrum is None else _distance(self.spectrum)

    def probability(self, error_rate: float) -> float | None:
        """That errors in the command frame pass both."""
        return None if self.spectrum is None else probability(self.spectrum, error_rate)

    @cached_property
    def greatest(self) -> float | None:
        """The greatest of these probabilities."""
        if self.spectrum is None:
            return None
        return max(probability(self.spectrum, rate) for rate in RATES)

    def as_json(self) -> dict[str, Any]:
        return {
            "line": self.carriage.name,
            "rank": self.rank,
            "burst": self.bursts[0],
            "burst_both": self.bursts[1],
            "generators": self.generators[0],
            "places": self.generators[1],
            "distance": self.distance,
            "probability": [self.probability(rate) for rate in RATES],
        }


@dataclass(frozen=True, eq=False)
class Evidence:
    """Of one polynomial. few: see `few`. sent: of errors in the bits that are sent. burst: all
    bursts up to so many bits are detected. carried: see `carriages`."""

    config: Config
    few: Few
    sent: Spectrum
    burst: int
    carried: tuple[Carried, ...]

    @property
    def sent_bits(self) -> int:
        return bits(self.config.layout.frame)

    @property
    def word_bits(self) -> int:
        """With board and time, which are not sent."""
        return bits(self.config.layout.implicit) + self.sent_bits

    @property
    def distance(self) -> int:
        """The Hamming distance of the bits sent."""
        return _distance(self.sent)

    def distance_at(self, data_bits: int) -> str:
        """That of another length, as far as it is counted."""
        found = int(distances(self.few)[data_bits + CRC_BITS])
        longer = data_bits + CRC_BITS >= self.sent_bits  # what passes in the frame, passes there
        return f"{'≥ ' if found > FEW and not (longer and found == self.distance) else ''}{found}"

    @property
    def reach(self) -> str:
        """Up to so many data bits no error of FEW bits or less passes."""
        far = int(np.flatnonzero(distances(self.few) > FEW)[-1])
        return f"{'≥ ' if far == self.few.shape[1] - 1 else ''}{max(far - CRC_BITS, 0)}"

    def probability(self, error_rate: float) -> float:
        """That errors in the bits sent pass."""
        return probability(self.sent, error_rate)

    @cached_property
    def greatest(self) -> tuple[float, float]:
        """The greatest of these probabilities, and its error rate."""
        return max((self.probability(rate), rate) for rate in RATES)

    def per_hour(self, error_rate: float) -> float:
        """Errors that pass in an hour of one frame a cycle."""
        return self.probability(error_rate) * 3600 / float(self.config.cycle_s)

    def as_json(self) -> dict[str, Any]:
        return {
            "polynomial": f"{self.config.polynomial:#010x}",
            "distance": self.distance,
            "distance_word": self.distance_at(self.word_bits - CRC_BITS),
            "distance_required": self.distance_at(REQUIRED_BITS),
            "reach": self.reach,
            "burst": self.burst,
            "passing": list(self.sent),
            "passing_word": self.few[:, self.word_bits].tolist(),
            "greatest": self.greatest[0],
            "greatest_rate": self.greatest[1],
            "per_hour": self.per_hour(REQUIRED_RATE),
            "probability": [self.probability(rate) for rate in RATES],
            "lines": [each.as_json() for each in self.carried],
        }


@dataclass(frozen=True, eq=False)
class Comparison:
    """codes: one of each polynomial. around: of errors in an Ethernet frame around the command
    frame that pass the frame check sequence."""

    codes: tuple[Evidence, ...]
    around: Spectrum

    def bound(self, code: Evidence, error_rate: float) -> float:
        """On Ethernet, errors anywhere in its frame: that the command is wrong and all pass, at
        most."""
        clean = (1 - error_rate) ** (len(self.around) - 1)
        return code.probability(error_rate) * (clean + probability(self.around, error_rate))

    def as_json(self) -> dict[str, Any]:
        code = self.codes[0]
        return {
            "outputs": code.config.outputs,
            "sent_bits": code.sent_bits,
            "word_bits": code.word_bits,
            "error_rate": list(RATES),
            "codes": [
                code.as_json() | {"bound": [self.bound(code, rate) for rate in RATES]}
                for code in self.codes
            ],
        }


def compare(configs: Sequence[Config], told: Told | None = None) -> Comparison:
    """The evidence of each configuration; they differ in the polynomial only.

    told: hears the part done. Raises ValueError.
    """
    stages = _stages(1 + 5 * len(configs), told)
    around = spectrum(carriages(configs[0].layout)[0].around, next(stages))
    return Comparison(tuple(_evidence(config, stages) for config in configs), around)


def _evidence(config: Config, stages: Iterator[Told]) -> Evidence:
    layout = config.layout
    n, word = bits(layout.frame), bits((*layout.implicit, *layout.frame))
    longest = max(word, REQUIRED_BITS + CRC_BITS + 1)
    counts = few(layout.check, FEW, longest, next(stages))
    sent = spectrum(syndromes(layout.check, n), next(stages))
    carried = [_carried(carriage, sent, next(stages)) for carriage in carriages(layout)]
    return Evidence(config, counts, sent, burst(syndromes(layout.check, word)), tuple(carried))


def _carried(carriage: Carriage, sent: Spectrum, told: Told) -> Carried:
    n, rank = len(carriage.both), carriage.rank
    if rank == CRC_BITS:  # the line's check adds nothing
        passing: Spectrum | None = sent
    elif min(rank, n - rank) > MOST_GENERATORS:
        passing = None
    else:
        passing = spectrum(carriage.both, told)
    return Carried(carriage, rank, carriage.bursts, carriage.generators, passing)


def _stages(total: int, told: Told | None) -> Iterator[Told]:
    """For each of so many parts of the work, what hears the part of it that is done."""
    for done in range(total):

        def stage(part: float, done: int = done) -> None:
            if told:
                told((done + part) / total)

        yield stage


def _distance(passing: Spectrum) -> int:
    return next(weight for weight, errors in enumerate(passing) if weight and errors)
