"""Alterations of where a tooth pair touches, and of what its stiffness is made: path, tables, compliances.

Each function takes the element laws over xi and returns altered ones.

Sources: docs/how_to/check_your_model.md, "Explanations"; docs/theory/mesh_physics.md for the parts.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import lru_cache
from types import MappingProxyType
from typing import Literal, NamedTuple

import numpy as np
from scipy.interpolate import CubicSpline

from lumped.errors import NumericalError
from lumped.path_function import PathFunction
from lumped.quasi_static.elements import MeshElements
from lumped.schema.pair import GearPair
from lumped.stiffness.energy import EnergyStiffness, pair_compliance
from lumped.typing import FloatArray
from validation.check.explanations.pair_laws import (
    TOLERANCE,
    fitted,
    separate,
    total_of_pairs,
    with_law,
)

Part = Literal["bending", "shear", "axial", "foundation", "hertz", "pinion", "gear"]
Compliance = Literal[
    "",
    "no bending",
    "no shear",
    "no compression",
    "no foundation",
    "no contact",
    "a quarter of the contact",
    "half the contact",
    "twice the contact",
    "four times the contact",
    "the pinion's tooth alone",
    "the gear's tooth alone",
    "two teeth of the pinion",
    "two teeth of the gear",
]


#: Straight lines or a cubic spline between entries; or steps with the value at their start or middle.
TableJoin = Literal["lines", "spline", "steps", "middles"]


class _Factors(NamedTuple):
    """Factors on parts of the compliance; a part of both teeth is left out, halved or doubled."""

    parts: Mapping[Part, float]
    words: str


#: Label -> factors on the parts of the compliance, with the explanation.
COMPLIANCES: Mapping[Compliance, _Factors] = MappingProxyType(
    {
        "no bending": _Factors({"bending": 0.0}, "the bending of the teeth left out of the compliance"),
        "no shear": _Factors({"shear": 0.0}, "the shear of the teeth left out of the compliance"),
        "no compression": _Factors(
            {"axial": 0.0}, "the axial compression of the teeth left out of the compliance"
        ),
        "no foundation": _Factors(
            {"foundation": 0.0}, "the gear bodies, the fillet foundation, left out of the compliance"
        ),
        "no contact": _Factors({"hertz": 0.0}, "the Hertzian contact left out of the compliance"),
        "a quarter of the contact": _Factors(
            {"hertz": 0.25}, "a quarter of the compliance of the Hertzian contact"
        ),
        "four times the contact": _Factors(
            {"hertz": 4.0}, "four times the compliance of the Hertzian contact"
        ),
        "half the contact": _Factors({"hertz": 0.5}, "half of the compliance of the Hertzian contact"),
        "twice the contact": _Factors({"hertz": 2.0}, "twice the compliance of the Hertzian contact"),
        "the pinion's tooth alone": _Factors({"gear": 0.0}, "the compliance of the pinion's tooth alone"),
        "the gear's tooth alone": _Factors({"pinion": 0.0}, "the compliance of the gear's tooth alone"),
        "two teeth of the pinion": _Factors(
            {"gear": 0.0, "pinion": 2.0}, "the compliance of the pinion's tooth for both teeth"
        ),
        "two teeth of the gear": _Factors(
            {"gear": 2.0, "pinion": 0.0}, "the compliance of the gear's tooth for both teeth"
        ),
    }
)
#: Places of the path of contact at which compliances are computed.
_PLACES = 81
#: Least stiffness over its largest value, where a change would make it negative.
_LEAST_STIFFNESS = 0.02


def with_compliance(pair: GearPair, elements: MeshElements, change: Compliance) -> MeshElements:
    """Return element laws of the energy method with factors on parts of the compliance of a tooth pair.

    Raises
    ------
    NumericalError : the stiffness of the pair does not come from the energy method
    """
    stiffness = elements.stiffness
    places, share = _shares(pair, change)
    rest = CubicSpline(places, 1.0 + share)

    def changed(xi: FloatArray) -> FloatArray:
        return np.asarray(stiffness(xi) / rest(xi))

    return with_law(pair, elements, fitted(changed, pair, elements), stiffness.interval)


@lru_cache(maxsize=64)
def _shares(pair: GearPair, change: Compliance) -> tuple[FloatArray, FloatArray]:
    """Places (n,) [m], and the change of the compliance there over the whole compliance."""
    model = pair.mesh.stiffness
    if not isinstance(model, EnergyStiffness):
        raise NumericalError("Parts of the compliance are those of the energy method.")
    places = np.linspace(pair.geometry.L_XA, pair.geometry.L_XD, _PLACES)
    parts = pair_compliance(pair, places, hertz=model.hertz)
    of_both = {
        name: getattr(parts.pinion, name) + getattr(parts.gear, name)
        for name in ("bending", "shear", "axial", "foundation")
    }
    values = {"hertz": parts.hertz, "pinion": parts.pinion.total, "gear": parts.gear.total, **of_both}
    added = sum(values[part] * (factor - 1.0) for part, factor in COMPLIANCES[change].parts.items())
    return places, np.asarray(added * parts.stiffness, dtype=np.float64)


def with_path(pair: GearPair, elements: MeshElements, start: float, end: float) -> MeshElements:
    """Return element laws on a path of contact whose ends lie further along its line by so many base pitches.

    The stiffness over the path is stretched. The friction coefficient goes on beyond the old ends.

    Raises
    ------
    NumericalError : the path is shorter than a base pitch
    """
    stiffness = elements.stiffness
    pitch = pair.geometry.base_pitch
    low, high = stiffness.interval
    new = (low + start * pitch, high + end * pitch)
    if new[1] - new[0] < pitch:
        raise NumericalError(
            "A path of contact that is shorter than a base pitch leaves teeth out of contact."
        )
    scale = (high - low) / (new[1] - new[0])

    def stretched(xi: FloatArray) -> FloatArray:
        return np.asarray(stiffness(np.clip(low + (xi - new[0]) * scale, low, high)))

    further = new[0] + (stiffness.breaks - low) / scale
    changed = with_law(pair, elements, fitted(stretched, pair, elements, new, further), new)
    return replace(changed, friction=_longer(pair, elements.friction, new))


def _longer(pair: GearPair, friction: PathFunction, interval: tuple[float, float]) -> PathFunction:
    """Friction coefficient on another interval; beyond its old ends it stays."""
    low, high = friction.interval
    inside = 1e-9 * pair.geometry.base_pitch

    def further(xi: FloatArray) -> FloatArray:
        return np.asarray(friction(np.clip(xi, low + inside, high - inside)))

    marks = separate(np.append(friction.breaks, [low, high, pair.geometry.L_XP]), pair, *interval)
    size = float(np.abs(further(np.linspace(*interval, 401)[1:-1])).max())
    breaks = np.concatenate([[interval[0]], marks, [interval[1]]])
    return PathFunction.fit(further, breaks, marks, tolerance=TOLERANCE * max(size, 1e-300))


def with_table(pair: GearPair, elements: MeshElements, entries: int, join: TableJoin) -> MeshElements:
    """Return element laws whose stiffness of the whole mesh comes from a table over the mesh cycle.

    Entries are at equal steps from A on; between them are straight lines, or a cubic spline that repeats with
    the cycle; or each holds over its step, with the value at the start or in the middle of the step.
    """
    stiffness = elements.stiffness
    low, _ = stiffness.interval
    pitch = pair.geometry.base_pitch
    total = total_of_pairs(pair, stiffness)
    phases = np.arange(entries + 1) / entries
    # Just behind the entry: at A the new pair carries load.
    behind = 0.5 / entries if join == "middles" else 1e-6
    values = total(low + (phases % 1.0 + behind) * pitch)
    curve = CubicSpline(phases, values, bc_type="periodic") if join == "spline" else None

    def from_table(xi: FloatArray) -> FloatArray:
        phase = np.mod((xi - low) / pitch, 1.0)
        if curve is not None:
            return np.asarray(np.maximum(curve(phase), _LEAST_STIFFNESS * values.max()))
        if join in ("steps", "middles"):
            return np.asarray(values[np.minimum((phase * entries).astype(int), entries - 1)])
        return np.asarray(np.interp(phase, phases, values))

    return _of_whole_mesh(pair, elements, from_table, low + phases[:-1] * pitch)


def with_table_of_places(
    pair: GearPair, elements: MeshElements, entries: int, join: TableJoin
) -> MeshElements:
    """Return element laws, friction too, from a table of places at equal steps of the base pitch from A on.

    Each entry holds over its step, with the values at its start or, by "middles", in its middle. A tooth pair
    carries load in the steps whose place is on its path.
    """
    stiffness, friction = elements.stiffness, elements.friction
    low, high = stiffness.interval
    step = pair.geometry.base_pitch / entries
    first = 0.5 if join == "middles" else 0.0
    count = int(np.ceil((high - low) / step - first - 1e-9))
    new = (low, low + count * step)
    inside = 1e-6 * step

    def held(law: PathFunction) -> Callable[[FloatArray], FloatArray]:
        def at_place(xi: FloatArray) -> FloatArray:
            number = np.clip(np.floor((xi - low) / step), 0, count - 1)
            return law(np.clip(low + (number + first) * step, low + inside, high - inside))

        return at_place

    places = np.asarray(low + step * np.arange(count + 1), dtype=np.float64)
    changed = with_law(pair, elements, fitted(held(stiffness), pair, elements, new, places), new)
    of_friction = held(friction)
    size = float(np.abs(of_friction(places[:-1] + 0.5 * step)).max())
    laws = PathFunction.fit(of_friction, places, places[1:-1], tolerance=TOLERANCE * max(size, 1e-300))
    return replace(changed, friction=laws)


def with_table_of_pair(pair: GearPair, elements: MeshElements, entries: int) -> MeshElements:
    """Return element laws whose stiffness of a tooth pair comes from a table over its path.

    Entries are at equal steps of the base pitch from A on, zero behind D, with straight lines between them.
    The line to the first zero reaches behind D. Negative: zero at A too.
    """
    stiffness = elements.stiffness
    low, high = stiffness.interval
    step = pair.geometry.base_pitch / abs(entries)
    count = int(np.floor((high - low) / step * (1.0 - 1e-9))) + 2
    nodes = np.asarray(low + step * np.arange(count), dtype=np.float64)
    inside = np.clip(nodes, low + 1e-9 * step, high - 1e-9 * step)
    values = np.where(nodes < high, stiffness(inside), 0.0)
    if entries < 0:
        values[0] = 0.0
    new = (float(nodes[0]), float(nodes[-1]))

    def from_table(xi: FloatArray) -> FloatArray:
        return np.asarray(np.interp(xi, nodes, values))

    changed = with_law(pair, elements, fitted(from_table, pair, elements, new, nodes), new)
    return replace(changed, friction=_longer(pair, elements.friction, new))


def _of_whole_mesh(
    pair: GearPair,
    elements: MeshElements,
    course: Callable[[FloatArray], FloatArray],
    places: FloatArray,
) -> MeshElements:
    """Element laws with another stiffness of the whole mesh, which has breaks at places of a base pitch."""
    stiffness = elements.stiffness
    total = total_of_pairs(pair, stiffness)
    pitch = pair.geometry.base_pitch
    low, high = stiffness.interval

    def changed(xi: FloatArray) -> FloatArray:
        return np.asarray(stiffness(xi) * course(xi) / total(xi))

    further = np.add.outer(places, pitch * np.arange(int(np.ceil((high - low) / pitch)) + 1)).ravel()
    return with_law(pair, elements, fitted(changed, pair, elements, None, further), stiffness.interval)


def with_fewer_pairs(pair: GearPair, elements: MeshElements, most: int) -> MeshElements:
    """Return element laws in which at most so many pairs carry load, the newest; negative: the oldest."""
    stiffness = elements.stiffness
    low, high = stiffness.interval
    length = abs(most) * pair.geometry.base_pitch
    new = (low, min(low + length, high)) if most > 0 else (max(high - length, low), high)
    changed = with_law(pair, elements, fitted(stiffness, pair, elements, new), new)
    return replace(changed, friction=_longer(pair, elements.friction, new))


def with_last_value_held(pair: GearPair, elements: MeshElements) -> MeshElements:
    """Return element laws whose stiffness stays as at D up to the next whole mesh cycle behind A."""
    stiffness = elements.stiffness
    low, high = stiffness.interval
    pitch = pair.geometry.base_pitch
    new = (low, low + np.ceil((high - low) / pitch) * pitch)
    last = high - 1e-9 * pitch

    def held(xi: FloatArray) -> FloatArray:
        return stiffness(np.minimum(xi, last))

    changed = with_law(pair, elements, fitted(held, pair, elements, new, np.array([high])), new)
    return replace(changed, friction=_longer(pair, elements.friction, new))


def with_compliance_in_series(pair: GearPair, elements: MeshElements, share: float) -> MeshElements:
    """Return element laws with a further constant compliance of each pair, over 1/k of the mean k."""
    stiffness = elements.stiffness
    mean = stiffness.mean()

    def softer(xi: FloatArray) -> FloatArray:
        ratio = stiffness(xi) / mean
        return np.asarray(stiffness(xi) / np.maximum(1.0 + share * ratio, _LEAST_STIFFNESS))

    return with_law(pair, elements, fitted(softer, pair, elements), stiffness.interval)


def with_bearings_in_series(pair: GearPair, elements: MeshElements) -> MeshElements:
    """Return element laws whose mesh stiffness K has the bearings along the line of action in it.

    1/K' = 1/K + 1/k_p + 1/k_g, as from a torsion test of the whole gearbox.
    """
    stiffness = elements.stiffness
    total = total_of_pairs(pair, stiffness)
    bearings = pair.bearings
    compliance = 1.0 / bearings.pinion.loa_stiffness + 1.0 / bearings.gear.loa_stiffness

    def softer(xi: FloatArray) -> FloatArray:
        return np.asarray(stiffness(xi) / (1.0 + compliance * total(xi)))

    return with_law(pair, elements, fitted(softer, pair, elements), stiffness.interval)


def with_peak(pair: GearPair, elements: MeshElements, shift: float) -> MeshElements:
    """Return element laws of a parabola whose peak lies further along the path by a share of half the path.

    The fall from the peak is that of the parabola of the pair, over the same length.
    """
    stiffness = elements.stiffness
    low, high = stiffness.interval
    half = 0.5 * (high - low)
    middle = 0.5 * (low + high)
    inside = 1e-9 * half
    peak, end = (float(one) for one in stiffness(np.array([middle, high - inside])))

    def moved(xi: FloatArray) -> FloatArray:
        values = peak - (peak - end) * ((xi - middle) / half - shift) ** 2
        return np.asarray(np.maximum(values, _LEAST_STIFFNESS * peak))

    return with_law(pair, elements, fitted(moved, pair, elements), stiffness.interval)
