"""Alterations of the element laws of a tooth pair: its stiffness over the mesh cycle, its dampers, its error.

Each function takes the element laws over xi and returns altered ones. The stiffness of the whole mesh is the
sum over all pairs; where it changes, each pair keeps its share of it.

Sources: docs/how_to/check_your_model.md, "Explanations"; docs/theory/equations.md for the laws.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Literal, NamedTuple

import numpy as np

from lumped.mesh.damper import damping_coefficient
from lumped.path_function import PathFunction
from lumped.quasi_static.elements import MeshElements, mean_of_pairs
from lumped.quasi_static.tooth_error import relief_error, relief_starts, reliefs_of
from lumped.schema.bodies import bodies_of
from lumped.schema.pair import GearPair
from lumped.stiffness.base import RAMP
from lumped.typing import FloatArray

Damper = Literal[
    "of each pair",
    "of the whole mesh",
    "proportional",
    "constant",
    "constant for each pair",
    "proportional at the mesh frequency",
]
Stiffness = Literal[
    "",
    "reversed",
    "constant",
    "single pair",
    "double pair",
    "shared evenly",
    "whole mesh for each pair",
    "levels exchanged",
    "first harmonic",
    "first harmonic, half the swing",
    "two harmonics",
    "three harmonics",
    "five harmonics",
    "two levels",
]
#: Excitation of a mesh with constant stiffness.
Excitation = Literal["", "static error", "stiffness as a force"]
#: Fit error of an altered law over its largest value.
TOLERANCE = 1e-7
#: Positions closer than this share of the base pitch are one.
SAME = 1e-9
#: Places in a mesh cycle at which a stiffness is smoothed, and the harmonics of a smoothed stiffness.
_COURSE = 2048
_HARMONICS = 30
#: Harmonics that a change of the stiffness keeps.
_KEPT = {"first harmonic": 1, "two harmonics": 2, "three harmonics": 3, "five harmonics": 5}
#: Least stiffness over its mean, where a change would make it negative.
_LEAST_STIFFNESS = 0.02
#: No further breaks.
_NONE: FloatArray = np.empty(0)


def damper_factor(pair: GearPair, elements: MeshElements, law: Damper) -> Callable[[FloatArray], FloatArray]:
    """Return the factor over xi from the damper of each pair, 2 zeta sqrt(k_i m_e), to another law.

    With K the sum of k_i over all pairs, each pair takes its part k_i/K of the damper of the mesh:
    2 zeta sqrt(K m_e), proportional 2 zeta K sqrt(m_e/mean K), or 2 zeta K/omega with the mesh frequency,
    constant 2 zeta sqrt(mean K m_e). A constant damper for each pair is the whole of the last one.
    """
    total = total_of_pairs(pair, elements.stiffness)
    mean = mean_of_pairs(elements.stiffness, pair.geometry.base_pitch)
    mass = bodies_of(pair).effective_mass
    at_frequency = mass * (2.0 * np.pi / pair.geometry.mesh_period) ** 2

    def factor(xi: FloatArray) -> FloatArray:
        whole = np.maximum(total(xi), 1e-6 * mean)
        stiffness = np.maximum(elements.stiffness(xi), 1e-6 * mean)
        under_root = {
            "of the whole mesh": whole,
            "proportional": whole**2 / mean,
            "proportional at the mesh frequency": whole**2 / at_frequency,
        }.get(law, mean)
        of_mesh = damping_coefficient(1.0, np.asarray(under_root + 0.0 * whole), mass)
        of_pair = damping_coefficient(1.0, stiffness, mass)
        if law == "constant for each pair":
            return np.asarray(of_mesh / of_pair, dtype=np.float64)
        return np.asarray(of_mesh * stiffness / whole / of_pair, dtype=np.float64)

    return factor


def total_of_pairs(
    pair: GearPair, law: PathFunction, extra: float = 0.0
) -> Callable[[FloatArray], FloatArray]:
    """Return the sum of a law over all pairs, as a function of the position xi of one of them."""
    low, high = law.interval
    pitch = pair.geometry.base_pitch
    reach = int(np.ceil((high - low + extra) / pitch))
    shifts = np.arange(-reach, reach + 1) * pitch
    return lambda xi: np.asarray(law(np.add.outer(xi, shifts)).sum(axis=-1), dtype=np.float64)


def marks_of(pair: GearPair, laws: tuple[PathFunction, ...], low: float, high: float) -> FloatArray:
    """Positions strictly between low and high at which this pair, or another one, passes a break of a law."""
    pitch = pair.geometry.base_pitch
    reach = int(np.ceil((high - low) / pitch)) + 1
    places = np.concatenate([law.breaks for law in laws] + [[low, high]])
    copies = np.add.outer(places, np.arange(-reach, reach + 1) * pitch).ravel()
    return separate(copies, pair, low, high)


def separate(places: FloatArray, pair: GearPair, low: float, high: float) -> FloatArray:
    """Return the places strictly between low and high, sorted, of those that are one only the first."""
    least = SAME * pair.geometry.base_pitch
    inside = np.sort(places[(places > low + least) & (places < high - least)])
    return np.asarray(inside[np.diff(inside, prepend=-np.inf) > least], dtype=np.float64)


def fitted(
    function: Callable[[FloatArray], FloatArray],
    pair: GearPair,
    elements: MeshElements,
    interval: tuple[float, float] | None = None,
    further: FloatArray = _NONE,
) -> PathFunction:
    """Fit a law over xi that depends on the pair and its neighbours, with further places of its breaks."""
    low, high = elements.stiffness.interval if interval is None else interval
    marks = separate(np.append(marks_of(pair, (elements.stiffness,), low, high), further), pair, low, high)
    size = float(np.abs(function(np.linspace(low, high, 401)[1:-1])).max())
    breaks = np.concatenate([[low], marks, [high]])
    return PathFunction.fit(function, breaks, marks, tolerance=TOLERANCE * max(size, 1e-300))


def with_stiffness(pair: GearPair, elements: MeshElements, change: Stiffness) -> MeshElements:
    """Element laws with another stiffness over the mesh cycle; the dampers follow the new stiffness."""
    stiffness = elements.stiffness
    low, high = interval = stiffness.interval
    pitch = pair.geometry.base_pitch
    mean = mean_of_pairs(stiffness, pitch)
    total = total_of_pairs(pair, stiffness)
    middle = 0.5 * (low + high)
    if change == "reversed":
        changed = fitted(lambda xi: stiffness(low + high - xi), pair, elements)
    elif change == "constant":
        changed = fitted(lambda xi: mean * stiffness(xi) / total(xi), pair, elements)
    elif change == "shared evenly":
        pairs = total_of_pairs(pair, PathFunction.constant(1.0, low, high))
        changed = fitted(lambda xi: total(xi) / np.maximum(pairs(xi), 1.0), pair, elements)
    elif change == "whole mesh for each pair":
        changed = fitted(total, pair, elements)
    elif change == "levels exchanged":
        places = low + (np.arange(_COURSE) + 0.5) / _COURSE * pitch
        both = float(total(places).max() + total(places).min())
        changed = fitted(lambda xi: stiffness(xi) * (both - total(xi)) / total(xi), pair, elements)
    elif change == "two levels" or "harmonic" in change:
        course = _smoother(pair, stiffness, change)
        changed = fitted(lambda xi: stiffness(xi) * course(xi) / total(xi), pair, elements)
    else:
        count = 1.0 if change == "single pair" else 2.0
        one_pair = float(stiffness(np.array([middle]))[0])
        interval = (middle - 0.5 * count * pitch, middle + 0.5 * count * pitch)
        changed = PathFunction.constant(one_pair, *interval)
    return with_law(pair, elements, changed, interval)


def with_error(
    pair: GearPair, elements: MeshElements, added: Callable[[FloatArray], FloatArray]
) -> MeshElements:
    """Return element laws with a further error of all teeth [m], which repeats from pair to pair."""
    low, high = elements.error.interval

    def error(xi: FloatArray) -> FloatArray:
        return np.asarray(elements.error(xi) + added(xi))

    marks = marks_of(pair, (elements.error, elements.stiffness), low, high)
    size = float(np.abs(error(np.linspace(low, high, 401)[1:-1])).max())
    breaks = np.concatenate([[low], marks, [high]])
    fitted = PathFunction.fit(error, breaks, marks, tolerance=TOLERANCE * max(size, 1e-300))
    return replace(elements, error=fitted)


def wave_error(pair: GearPair, cosine: float, sine: float) -> Callable[[FloatArray], FloatArray]:
    """Return an error over xi at the mesh frequency: amplitudes [m] of its cosine and sine from A on."""
    g = pair.geometry

    def error(xi: FloatArray) -> FloatArray:
        angle = 2.0 * np.pi * (xi - g.L_XA) / g.base_pitch
        return np.asarray(cosine * np.cos(angle) + sine * np.sin(angle))

    return error


def static_error(
    pair: GearPair, stiffness: PathFunction, factor: float, orders: int = 0
) -> Callable[[FloatArray], FloatArray]:
    """Return the static deflection F/K(xi) of the mesh times a factor, as an error of all teeth [m].

    ``orders``: 0 for the whole deflection, -1 for its part that varies, n for its first n mesh orders.
    """
    force = pair.operating.pinion_torque / pair.geometry.base_radius_pinion
    if orders <= 0:
        total = total_of_pairs(pair, stiffness)
        course = _course_of(pair, stiffness)
        mean = float((force / course.values).mean()) if orders else 0.0
        return lambda xi: np.asarray(factor * (force / total(xi) - mean))
    course = _course_of(pair, stiffness)
    waves = np.fft.rfft(force / course.values)[1 : orders + 1] * (2.0 / _COURSE)
    numbers = np.arange(1, orders + 1)

    def series(xi: FloatArray) -> FloatArray:
        angle = 2.0 * np.pi * np.multiply.outer((xi - course.places[0]) / course.pitch, numbers)
        return np.asarray(factor * (np.exp(1j * angle) @ waves).real)

    return series


def with_late_force(pair: GearPair, elements: MeshElements, delay: float) -> MeshElements:
    """Return element laws whose force comes late by mesh cycles: a damper c - h k with the delay h [s].

    N(t - h) = k delta - h k delta' + c delta' in first order of h, as with the force of the last step.
    """
    late = delay * pair.geometry.mesh_period

    def damping(xi: FloatArray) -> FloatArray:
        return np.asarray(elements.damping(xi) - late * elements.stiffness(xi))

    return replace(elements, damping=fitted(damping, pair, elements))


def with_excitation(pair: GearPair, elements: MeshElements, excitation: Excitation) -> MeshElements:
    """Return element laws with a constant mesh stiffness that a transmission error excites.

    static error: e = F/K - F/mean K. stiffness as a force: (K - mean K) F/mean K as a force, so that
    e = -(K - mean K) F/(mean K)^2.
    """
    stiffness = elements.stiffness
    force = pair.operating.pinion_torque / pair.geometry.base_radius_pinion
    mean = mean_of_pairs(stiffness, pair.geometry.base_pitch)
    total = total_of_pairs(pair, stiffness)

    def error(xi: FloatArray) -> FloatArray:
        if excitation == "static error":
            return np.asarray(force / total(xi) - force / mean)
        return np.asarray(-(total(xi) - mean) * force / mean**2)

    return with_error(pair, with_stiffness(pair, elements, "constant"), error)


def with_lag(pair: GearPair, elements: MeshElements, lag: float) -> MeshElements:
    """Return element laws whose stiffness of the whole mesh comes late, by mesh cycles.

    A pair has k K(xi - lag p)/K(xi) with the base pitch p.
    """
    stiffness = elements.stiffness
    total = total_of_pairs(pair, stiffness)
    pitch = pair.geometry.base_pitch
    delay = lag * pitch
    low, high = stiffness.interval

    def late(xi: FloatArray) -> FloatArray:
        earlier = low + np.mod(xi - delay - low, pitch)  # the whole mesh repeats with the base pitch
        return np.asarray(stiffness(xi) * total(earlier) / total(xi))

    reach = int(np.ceil((high - low) / pitch)) + 2
    breaks = np.append(stiffness.breaks, [low, high])
    moved = np.add.outer(breaks, delay + pitch * np.arange(-reach, reach + 1)).ravel()
    return with_law(pair, elements, fitted(late, pair, elements, further=moved), stiffness.interval)


def with_ramps(pair: GearPair, elements: MeshElements, share: float) -> MeshElements:
    """Return element laws in which a tooth pair takes up and gives up its stiffness over a share of its path.

    The ramps are those of the stiffness models, whose square root is smooth.
    """
    stiffness = elements.stiffness
    low, high = stiffness.interval
    length = share * (high - low)

    def ramped(xi: FloatArray) -> FloatArray:
        inside = np.clip(np.minimum(xi - low, high - xi) / length, 0.0, 1.0)
        return np.asarray(stiffness(xi) * RAMP(inside))

    ends = np.array([low + length, high - length])
    return with_law(pair, elements, fitted(ramped, pair, elements, further=ends), stiffness.interval)


def with_shape(pair: GearPair, elements: MeshElements, slope: float, curvature: float) -> MeshElements:
    """Return element laws whose stiffness of a tooth pair has another shape over its path.

    A pair has k (1 + s u + c u^2) with slope s and curvature c; u runs from -1 to 1 over the path of contact.
    """
    stiffness = elements.stiffness
    low, high = stiffness.interval

    def shaped(xi: FloatArray) -> FloatArray:
        u = (2.0 * xi - low - high) / (high - low)
        factor = 1.0 + slope * u + curvature * u**2
        return np.asarray(stiffness(xi) * np.maximum(factor, _LEAST_STIFFNESS))

    return with_law(pair, elements, fitted(shaped, pair, elements), stiffness.interval)


def with_variation(pair: GearPair, elements: MeshElements, factor: float) -> MeshElements:
    """Element laws with another variation of the stiffness K of the whole mesh: k (mean + f (K - mean))/K."""
    stiffness = elements.stiffness
    mean = mean_of_pairs(stiffness, pair.geometry.base_pitch)
    total = total_of_pairs(pair, stiffness)

    def changed(xi: FloatArray) -> FloatArray:
        whole = total(xi)
        varied = np.maximum(mean + factor * (whole - mean), _LEAST_STIFFNESS * mean)
        return np.asarray(stiffness(xi) * varied / whole)

    return with_law(pair, elements, fitted(changed, pair, elements), stiffness.interval)


def with_law(
    pair: GearPair, elements: MeshElements, changed: PathFunction, interval: tuple[float, float]
) -> MeshElements:
    """Return element laws with another stiffness of the tooth pair on an interval; the dampers follow it."""
    stiffness = elements.stiffness
    mass = bodies_of(pair).effective_mass
    ratio = pair.mesh.damping_ratio

    def damping(xi: FloatArray) -> FloatArray:
        return np.asarray(damping_coefficient(ratio, np.maximum(changed(xi), 0.0), mass), dtype=np.float64)

    return replace(
        elements,
        stiffness=changed,
        damping=fitted(damping, pair, elements, interval, changed.breaks) if ratio else changed.scaled(0.0),
        error=elements.error if interval == stiffness.interval else _error_of_relief(pair, changed, interval),
    )


def _error_of_relief(pair: GearPair, stiffness: PathFunction, interval: tuple[float, float]) -> PathFunction:
    """Error of a tooth pair by the relief of both gears on another path of contact [m]."""
    if pair.mesh.relief == "ignored" or not reliefs_of(pair).size:
        return PathFunction.constant(0.0, *interval)
    g = pair.geometry
    places = np.concatenate([relief_starts(pair), stiffness.breaks, [g.L_XA, g.L_XD]])
    marks = separate(places, pair, *interval)
    size = float(np.abs(relief_error(pair, np.linspace(*interval, 401))).max())
    breaks = np.concatenate([[interval[0]], marks, [interval[1]]])
    tolerance = TOLERANCE * max(size, 1e-12)
    return PathFunction.fit(lambda xi: relief_error(pair, xi), breaks, marks, tolerance=tolerance)


def _smoother(
    pair: GearPair, stiffness: PathFunction, change: Stiffness
) -> Callable[[FloatArray], FloatArray]:
    """Return the stiffness of the whole mesh over xi, with less detail than it has.

    Its mean with one harmonic or three, or one value for each number of tooth pairs in contact.
    """
    low, high = stiffness.interval
    course = _course_of(pair, stiffness)
    places, values = course.places, course.values
    if change == "two levels":
        pairs = total_of_pairs(pair, PathFunction.constant(1.0, low, high))
        count = np.round(pairs(places))
        levels = {float(number): float(values[count == number].mean()) for number in np.unique(count)}
        numbers, means = np.array(sorted(levels)), np.array([levels[one] for one in sorted(levels)])
        return lambda xi: np.asarray(np.interp(np.round(pairs(xi)), numbers, means), dtype=np.float64)
    if change == "first harmonic, half the swing":  # half of the peak to peak as the amplitude
        first = np.abs(np.fft.rfft(values)[1]) * (2.0 / _COURSE)
        return _of_harmonics(course, np.array([0.5 * float(np.ptp(values)) / first]))
    return _of_harmonics(course, np.ones(_KEPT[change]))


class _Course(NamedTuple):
    """The stiffness of the whole mesh [N/m] at equal steps of a base pitch.

    Attributes
    ----------
    places : (n,) positions xi [m]
    values : (n,) stiffness
    pitch : base pitch [m]
    """

    places: FloatArray
    values: FloatArray
    pitch: float


def _course_of(pair: GearPair, stiffness: PathFunction) -> _Course:
    """The stiffness of the whole mesh over a base pitch."""
    pitch = pair.geometry.base_pitch
    places = stiffness.interval[0] + (np.arange(_COURSE) + 0.5) / _COURSE * pitch
    return _Course(places, total_of_pairs(pair, stiffness)(places), pitch)


def _of_harmonics(course: _Course, gains: FloatArray) -> Callable[[FloatArray], FloatArray]:
    """The mean of a stiffness and its first harmonics times gains (m,), never below a least stiffness."""
    orders = np.arange(1, gains.size + 1)
    waves = np.fft.rfft(course.values)[1 : gains.size + 1] * (2.0 / _COURSE) * gains
    mean = float(course.values.mean())

    def stiffness(xi: FloatArray) -> FloatArray:
        angle = 2.0 * np.pi * np.multiply.outer((xi - course.places[0]) / course.pitch, orders)
        return np.asarray(np.maximum(mean + (np.exp(1j * angle) @ waves).real, _LEAST_STIFFNESS * mean))

    return stiffness


def with_smoothing(pair: GearPair, elements: MeshElements, window: float) -> MeshElements:
    """Element laws whose stiffness of the whole mesh is averaged over a window [mesh cycles]."""
    stiffness = elements.stiffness
    total = total_of_pairs(pair, stiffness)
    orders = np.arange(1, _HARMONICS + 1)
    smooth = _of_harmonics(_course_of(pair, stiffness), np.sinc(window * orders))
    changed = fitted(lambda xi: stiffness(xi) * smooth(xi) / total(xi), pair, elements)
    return with_law(pair, elements, changed, stiffness.interval)
