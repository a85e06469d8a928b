"""The feasible set of all stamps: every trajectory that fits them bounds the speed (ODO-14).

A wheel of constant acceleration is at x(t) = x_0 + v·t + a·t²/2, |a| ≤ a_max. Rising edge k of a is
met within ±tooth pitches of its place k, at an instant in (s_k - l, s_k], s_k its stamp and l the
ticks a stamp can be late, 1 unless the pins were sampled coarser before. Because x rises, that
means x(s_k - l) ≤ k + tooth and x(s_k) ≥ k - tooth: half-spaces in (x_0, v, a). The
least and the greatest speed at the window's middle over all that fits are two linear programs in
three unknowns.

The falling edges of a and the edges of b are left out: each kind has an offset of its own (duty,
phase) that nothing vouches for, so that each would add an unknown.

**Residuals.** With D = s_n - s_0 and r_k = k·D - n·(s_k - s_0), an exact integer, what is left of x
beside the line through the first and the last stamp, in ticks, is y(z) = α + β·z + γ·z², where z
runs from -1 at s_0 - l to 1 at s_n. The half-spaces are

    y(z of s_k)     ≥ r_k/n - w_k          w_k = tooth and jerk in ticks
    y(z of s_k - l) ≤ r_k/n + l + w_k      |γ| ≤ Γ, from a_max

and the speed in the middle is n/D · (1 + β / h), h = (D + l)/2 ticks. All numbers are small, so
that nothing is lost to rounding.

**Jerk.** An acceleration that changes by up to j within the window moves the wheel at most
j·|τ|³/6 beside the trajectory through its middle, τ the time from there: that widens w_k.

**Why every step is a guarantee.** With three half-spaces g_i · (α, β, γ) ≤ b_i and λ_i ≥ 0 such
that Σ λ_i g_i = (0, 1, 0), every point of the set has β ≤ Σ λ_i b_i. The dual simplex keeps such a
triple and exchanges one of it for the half-space most violated where the three meet, which only
lowers that sum; it starts from the first and the last edge, which say what Π says. Stopping early
therefore costs width, never truth; so does rounding, once what Σ λ_i g_i misses (0, 1, 0) by, times
how great α, β, γ can be, is added. No exchange possible: the set is empty.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numba import njit
from numpy.typing import NDArray

from railgate.odometer.host.estimators import MIDDLE, Estimate, Scale, mean_speed
from railgate.waves.waveform import Ticks

__all__ = ["feasible", "speed_bounds"]

EXCHANGES = 100
"""More than any window has needed; see the module on stopping early."""
ROUNDINGS = 32 * 2.0**-53
"""Relative error of a half-space's figures and of the sums over three of them, with room."""

Floats = NDArray[np.float64]


@njit(cache=True)
def _half_spaces(stamps: Ticks, tooth: float, acceleration: float, jerk: float, late: float) -> Any:
    """z and b of the half-spaces: first n + 1 from below, then n + 1 from above, and Γ."""
    n = stamps.size - 1
    D = stamps[n] - stamps[0]
    h = (D + late) / 2
    per_pitch = D / n
    z, b = np.empty(2 * n + 2), np.empty(2 * n + 2)
    for k in range(n + 1):
        s = stamps[k] - stamps[0]
        residual = (k * D - n * s) / n
        for above in range(2):
            at = k + above * (n + 1)
            doubled = 2 * (s - above * late) - (D - late)
            z[at] = doubled / (D + late)
            tau = abs(doubled) / 2
            width = (tooth + jerk * tau**3 / 6) * per_pitch
            b[at] = residual + late + width if above else width - residual
    return z, b, acceleration / 2 * h * h * per_pitch


@njit(cache=True, inline="always")
def _row(at: int, z: Floats, edges: int) -> Any:
    """The vector g of half-space `at`; the two last bound γ."""
    if at >= 2 * edges:
        return 0.0, 0.0, 1.0 if at == 2 * edges else -1.0
    sign = 1.0 if at >= edges else -1.0
    return sign, sign * z[at], sign * z[at] * z[at]


@njit(cache=True)
def _most_violated(a: float, b: float, c: float, z: Floats, limit: Floats) -> Any:
    """The half-space that (a, b, c) violates most, and by how much."""
    edges = limit.size // 2 - 1
    worst, most = 0, -np.inf
    for k in range(edges):
        below = -limit[k] - (a + z[k] * (b + z[k] * c))
        if below > most:
            worst, most = k, below
    for k in range(edges, 2 * edges):
        above = a + z[k] * (b + z[k] * c) - limit[k]
        if above > most:
            worst, most = k, above
    for k, beyond in ((2 * edges, c), (2 * edges + 1, -c)):
        if beyond - limit[k] > most:
            worst, most = k, beyond - limit[k]
    return worst, most


@njit(cache=True)
def _greatest(z: Floats, limit: Floats, first: int, last: int, beta_most: float) -> Any:
    """An upper bound of β over the half-spaces and whether they leave anything.

    first, last: those to start from. beta_most: |β| cannot be greater. Returns (bound, empty).
    """
    edges = limit.size // 2 - 1
    gamma_most = limit[2 * edges]
    b_most = np.abs(limit[: 2 * edges]).max()
    alpha_most = b_most + beta_most + gamma_most
    size = alpha_most + beta_most + gamma_most + b_most
    basis = np.array([first, last, 2 * edges])
    G, inverse = np.empty((3, 3)), np.empty((3, 3))
    for i in range(3):
        G[i, 0], G[i, 1], G[i, 2] = _row(basis[i], z, edges)
    best = beta_most
    for _ in range(EXCHANGES):
        for i in range(3):
            p, q = G[(i + 1) % 3], G[(i + 2) % 3]
            for j in range(3):
                s, t = (j + 1) % 3, (j + 2) % 3
                inverse[j, i] = p[s] * q[t] - p[t] * q[s]
        det = G[0, 0] * inverse[0, 0] + G[0, 1] * inverse[1, 0] + G[0, 2] * inverse[2, 0]
        if abs(det) < 1e-14:
            break
        inverse /= det
        l0, l1, l2 = max(inverse[1, 0], 0.0), max(inverse[1, 1], 0.0), max(inverse[1, 2], 0.0)
        b0, b1, b2 = limit[basis[0]], limit[basis[1]], limit[basis[2]]
        missed = abs(l0 * G[0, 0] + l1 * G[1, 0] + l2 * G[2, 0]) * alpha_most
        missed += abs(l0 * G[0, 1] + l1 * G[1, 1] + l2 * G[2, 1] - 1) * beta_most
        missed += abs(l0 * G[0, 2] + l1 * G[1, 2] + l2 * G[2, 2]) * gamma_most
        slack = ROUNDINGS * (l0 + l1 + l2) * size
        best = min(best, l0 * b0 + l1 * b1 + l2 * b2 + missed + slack)
        alpha = inverse[0, 0] * b0 + inverse[0, 1] * b1 + inverse[0, 2] * b2
        beta = inverse[1, 0] * b0 + inverse[1, 1] * b1 + inverse[1, 2] * b2
        gamma = inverse[2, 0] * b0 + inverse[2, 1] * b1 + inverse[2, 2] * b2
        enters, violation = _most_violated(alpha, beta, gamma, z, limit)
        if violation <= 1e-9 + 1e-12 * size:
            break
        g0, g1, g2 = _row(enters, z, edges)
        leaves, ratio = -1, np.inf
        for i in range(3):
            share = g0 * inverse[0, i] + g1 * inverse[1, i] + g2 * inverse[2, i]
            if share > 1e-12 and max(inverse[1, i], 0.0) / share < ratio:
                leaves, ratio = i, max(inverse[1, i], 0.0) / share
        if leaves < 0:
            return best, True
        basis[leaves] = enters
        G[leaves, 0], G[leaves, 1], G[leaves, 2] = g0, g1, g2
    return best, False


@njit(cache=True)
def speed_bounds(
    stamps: Ticks, tooth: float, acceleration: float, jerk: float, late: float = 1.0
) -> Any:
    """The nominal speed at the window's middle, pitches per tick: (low, high, empty).

    stamps: int64, rising, shape (n + 1,), n ≥ 1. acceleration, jerk: as in Scale.
    late: how far a stamp can be behind its edge, ticks.
    """
    edges = stamps.size
    D = stamps[edges - 1] - stamps[0]
    z, b, gamma_most = _half_spaces(stamps, tooth, acceleration, jerk, late)
    limit = np.append(b, np.array([gamma_most, gamma_most]))
    up = (limit[2 * edges - 1] + limit[0]) / (z[2 * edges - 1] - z[0])
    down = (limit[edges] + limit[edges - 1]) / (z[edges - 1] - z[edges])
    most = max(up, down) * (1 + ROUNDINGS)
    high, none = _greatest(z, limit, 2 * edges - 1, 0, most)
    low, nothing = _greatest(-z, limit, edges, edges - 1, most)
    mean, h = (edges - 1) / D, (D + late) / 2
    return mean * max(1 - low / h, 0.0), mean * (1 + high / h), none or nothing or low + high < 0


def feasible(edges: Ticks, scale: Scale) -> Estimate:
    """The speed at the window's middle, midway from the first stamp less its lateness to the last.

    edges: stamps of successive rising edges of a without a reversal, shape (n + 1,), n ≥ 1. Where
    nothing fits them (the acceleration was greater or not constant enough, an edge false or
    missing) the result is that of Π, flagged `infeasible`. Raises ValueError for fewer edges.
    """
    if edges.size < 2:
        raise ValueError(f"a feasible set needs at least 2 edges, not {edges.size}")
    assumed = scale.assumptions
    low, high, empty = speed_bounds(
        np.ascontiguousarray(edges, np.int64),
        assumed.tooth_error,
        scale.acceleration,
        scale.jerk,
        assumed.late_ticks,
    )
    if empty:
        mean = mean_speed(edges.size - 1, int(edges[-1] - edges[0]), scale)
        return replace(mean, flags=("infeasible",))
    return Estimate(
        value_kmh=scale.unit_kmh * (low + high) / 2,
        low_kmh=scale.unit_kmh * low * scale.low,
        high_kmh=scale.unit_kmh * high * scale.high,
        std_kmh=None,
        of=MIDDLE,
        rests_on=scale.premises(
            f"acceleration constant over the window, within ±{assumed.acceleration_max:g} m/s²"
            if not assumed.jerk_max
            else f"{scale.premise_acceleration}, jerk within ±{assumed.jerk_max:g} m/s³",
        ),
    )
