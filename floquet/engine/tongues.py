"""Tongues of instability along a line: their ends, the damping to close them, and their names.

Sources: docs/theory/floquet.md, "Where instability is, and what it is called".
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from itertools import combinations_with_replacement
from typing import Any

import numpy as np
import numpy.typing as npt
from scipy.optimize import brentq

from lumped.errors import NumericalError
from lumped.typing import FloatArray

Radius = Callable[[FloatArray], FloatArray]
"""Increasing places along a line (k,) -> spectral radii (k,)."""
RadiusAt = Callable[[FloatArray, float], FloatArray]
"""(places along the line (k,), damping) -> spectral radii (k,)."""

# A combination tongue of relative detuning beyond this is not believed while another candidate fits.
_DETUNING = 0.05


@dataclass(frozen=True, order=True)
class Tongue:
    """Label of a tongue: excitation frequency = (omega_i + sign omega_j)/order, modes numbered from 1.

    i = j with sign +1 is a parametric resonance of one mode, i < j a combination resonance: of the sum
    (sign +1) or of the difference (sign -1, omega_j - omega_i).

    Attributes
    ----------
    mode_i, mode_j : i <= j
    sign : +1 or -1
    order : k >= 1
    """

    mode_i: int
    mode_j: int
    sign: int
    order: int

    def __str__(self) -> str:
        if self.mode_i == self.mode_j:
            return f"2w{self.mode_i}/{self.order}"
        first, second = (self.mode_i, self.mode_j) if self.sign > 0 else (self.mode_j, self.mode_i)
        return f"(w{first}{'+' if self.sign > 0 else '-'}w{second})/{self.order}"


def tongue_coordinates(dim: str, tongues: Iterable[Tongue]) -> dict[str, tuple[str, npt.NDArray[Any]]]:
    """Coordinates of a dataset whose dimension goes over tongues: label, modes, sign and order."""
    rows = np.array([(str(t), t.mode_i, t.mode_j, t.sign, t.order) for t in tongues], dtype=object)
    label, *numbers = rows.reshape(-1, 5).T
    names = ("mode_i", "mode_j", "sign", "order")
    numbers_by_name = {
        name: (dim, column.astype(np.int64)) for name, column in zip(names, numbers, strict=True)
    }
    return {"label": (dim, label), **numbers_by_name}


def combinations(omega: FloatArray) -> Iterator[tuple[int, int, int, float]]:
    """Pairs of modes i <= j from 0, sign, and the frequency omega_j + sign omega_i that they resonate at."""
    for i, j in combinations_with_replacement(range(omega.size), 2):
        yield i, j, 1, float(omega[j] + omega[i])
        if i < j:
            yield i, j, -1, float(omega[j] - omega[i])


def mode_shares(state: npt.ArrayLike, omega: FloatArray) -> FloatArray:
    """How much each mode of the mean system takes part in a motion, forwards and backwards; (2, m), sum one.

    Shares of the action |.|^2/omega: a sum resonance feeds both modes with equal action (Manley and Rowe).
    """
    x = np.asarray(state, dtype=complex)
    m = omega.size
    actions = np.abs(np.stack([x[:m] - 1j * x[m:], x[:m] + 1j * x[m:]])) ** 2 / omega
    return np.asarray(actions / actions.sum())


def label_tongue(matrix: npt.ArrayLike, omega: FloatArray, excitation: float) -> Tongue:
    """Name the instability of a monodromy matrix by the shape of its fastest growing motion.

    Parametric excitation at Omega couples two rotating motions whose frequencies differ by k Omega. At
    omega_i + omega_j = k Omega mode i turns forwards and mode j backwards; at omega_j - omega_i = k Omega
    both turn in the same direction. So the growing eigenvector gives the pair of modes and the sign, and the
    frequencies give the order k. A pair detuned by more than 5 % is not chosen while another pair takes part.

    matrix : (2m, 2m) monodromy matrix in the modal states (omega eta, eta') of the mean system
    omega, excitation : (m,) natural frequencies of the mean system, Omega = 2 pi/T [rad/s]
    """
    values, vectors = np.linalg.eig(np.asarray(matrix, dtype=float))
    forward, backward = mode_shares(vectors[:, np.argmax(np.abs(values))], omega)
    candidates: list[tuple[bool, float, Tongue]] = []
    for i, j, sign, total in combinations(omega):
        along, against = (forward, backward) if sign < 0 else (backward, forward)
        weight = math.sqrt(max(forward[i] * along[j], backward[i] * against[j]))
        order = max(1, round(total / excitation))
        near = abs(total / (order * excitation) - 1.0) <= _DETUNING
        candidates.append((near, weight, Tongue(i + 1, j + 1, sign, order)))
    _, _, tongue = max(candidates)
    return tongue


@dataclass(frozen=True)
class TongueTip:
    """Where a tongue closes.

    Attributes
    ----------
    damping : critical damping, at and above which no place of the window is unstable
    place : where along the line the tongue closes
    """

    damping: float
    place: float


def tongue_tip(
    radius: RadiusAt, window: tuple[float, float], bracket: tuple[float, float], *, xtol: float = 1e-9
) -> TongueTip:
    """Find the damping that closes a tongue: the root of the largest radius - 1 in the window.

    The window holds no other tongue. ``bracket`` is a damping at which the tongue is open and one at which
    the tongue is closed; NumericalError: it is not.
    """
    places: dict[float, float] = {}

    def excess(damping: float) -> float:
        places[damping], top = _highest(lambda x: radius(x, damping), *window)
        return top - 1.0

    if excess(bracket[0]) <= 0.0 or excess(bracket[1]) > 0.0:
        raise NumericalError(
            f"the tongue between {window[0]:g} and {window[1]:g} does not close between damping "
            f"{bracket[0]:g} and {bracket[1]:g}. Give one at which it is open and one at which it is not."
        )
    damping = float(brentq(excess, *bracket, xtol=xtol, rtol=1e-9))
    excess(damping)
    return TongueTip(damping, places[damping])


def _highest(
    function: Callable[[FloatArray], FloatArray], low: float, high: float, count: int = 33
) -> tuple[float, float]:
    """Place and value of the largest value in [low, high], by repeated sampling around the best sample.

    The top of a smooth peak is known to (width)^2: four rounds of a factor 16 leave 1e-9 of its height.
    """
    best = low
    top = -np.inf
    for _ in range(4):
        x = np.linspace(low, high, count)
        values = function(x)
        k = int(np.argmax(values))
        if values[k] > top:
            best = float(x[k])
            top = float(values[k])
        low = float(x[max(k - 1, 0)])
        high = float(x[min(k + 1, count - 1)])
    return best, top


@dataclass(frozen=True)
class UnstableInterval:
    """An interval of the parameter in which the spectral radius exceeds one.

    Attributes
    ----------
    lower, upper : ends of the interval; ends of the range where ``open_below`` or ``open_above``
    peak, peak_radius : place of the largest spectral radius, and this radius
    open_below, open_above : whether the interval runs on beyond the range that was searched
    """

    lower: float
    upper: float
    peak: float
    peak_radius: float
    open_below: bool
    open_above: bool


def seeded_nodes(lines: FloatArray, low: float, high: float, coarse: int, width: float = 0.03) -> FloatArray:
    """Nodes for a search in [low, high]: evenly spaced ones, and a graded cluster at every predicted line.

    A thin tongue is close to its line: offsets grow in proportion from 1e-6 to ``width`` on both sides.
    """
    offsets = np.geomspace(1e-6, width, 25)
    offsets = np.concatenate([-offsets[::-1], [0.0], offsets])
    clusters = (lines[:, None] * (1.0 + offsets)).ravel()
    nodes = np.concatenate([np.linspace(low, high, coarse), clusters])
    return np.unique(nodes[(nodes >= low) & (nodes <= high)])


def unstable_intervals(
    radius: Radius, nodes: FloatArray, *, xtol: float = 1e-9, threshold: float = 1e-9
) -> list[UnstableInterval]:
    """Intervals of instability with at least one of the nodes (k,) inside.

    ``xtol`` is the relative error of their ends. First, nodes are added around local maxima of the radius
    near 1. A radius above 1 + threshold is unstable.
    """
    nodes, values = _refine_maxima(radius, nodes, radius(nodes))
    unstable = values > 1.0 + threshold
    if not unstable.any():
        return []
    change = np.flatnonzero(unstable[1:] != unstable[:-1])
    ends = _bisect(radius, nodes[change], nodes[change + 1], unstable[change], threshold, xtol)
    result = []
    starts = np.flatnonzero(unstable & ~np.concatenate([[False], unstable[:-1]]))
    stops = np.flatnonzero(unstable & ~np.concatenate([unstable[1:], [False]]))
    for first, last in zip(starts, stops, strict=True):
        peak = first + int(np.argmax(values[first : last + 1]))
        lower = nodes[0] if first == 0 else ends[np.searchsorted(change, first - 1)]
        upper = nodes[-1] if last == nodes.size - 1 else ends[np.searchsorted(change, last)]
        top = (float(nodes[peak]), float(values[peak]))
        open_ends = (first == 0, last == nodes.size - 1)
        result.append(UnstableInterval(float(lower), float(upper), *top, *map(bool, open_ends)))
    return result


def _refine_maxima(
    radius: Radius, nodes: FloatArray, values: FloatArray, rounds: int = 6
) -> tuple[FloatArray, FloatArray]:
    """Add nodes around local maxima of the radius, five on either side in each round."""
    for _ in range(rounds):
        inner = (values[1:-1] >= values[:-2]) & (values[1:-1] >= values[2:])
        top = np.flatnonzero(inner) + 1
        # A smooth maximum well below one hides nothing: its neighbours differ by less than what is missing.
        drop = np.maximum(values[top] - values[top - 1], values[top] - values[top + 1])
        top = top[(values[top] + 4.0 * drop > 1.0) & (drop > 1e-12)]
        if top.size == 0:
            break
        fraction = np.arange(1, 6) / 6.0
        below = nodes[top - 1][:, None] + (nodes[top] - nodes[top - 1])[:, None] * fraction
        above = nodes[top][:, None] + (nodes[top + 1] - nodes[top])[:, None] * fraction
        new = np.setdiff1d(np.concatenate([below.ravel(), above.ravel()]), nodes)
        if new.size == 0:
            break
        merged = np.concatenate([nodes, new])
        order = np.argsort(merged)
        nodes = merged[order]
        values = np.concatenate([values, radius(new)])[order]
    return nodes, values


def _bisect(
    radius: Radius,
    lower: FloatArray,
    upper: FloatArray,
    lower_unstable: npt.NDArray[np.bool_],
    threshold: float,
    xtol: float,
) -> FloatArray:
    """Bisect all brackets together; the lower and the upper ends differ in stability."""
    lower = lower.copy()
    upper = upper.copy()
    while lower.size and ((upper - lower) > xtol * np.abs(upper)).any():
        middle = 0.5 * (lower + upper)
        unique, inverse = np.unique(middle, return_inverse=True)
        same = (radius(unique)[inverse] > 1.0 + threshold) == lower_unstable
        lower = np.where(same, middle, lower)
        upper = np.where(same, upper, middle)
    return np.asarray(0.5 * (lower + upper))
