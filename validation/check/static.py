"""The first rung of a check: what another model states or shows before anything moves.

Contact ratio, base radii, bodies, static force, mesh stiffness over the mesh phase, natural frequencies, mass
and stiffness matrices: each quantity that the other model states is compared with the value of the lumped
model. A difference here explains differences of the motion, so the check reports it first.

Sources: docs/theory/equations.md; docs/how_to/check_your_model.md, "Static rung".
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from lumped.arguments import real_array
from lumped.errors import refuse
from lumped.labelling import labelled_dataset
from lumped.model.averaged import natural_frequencies
from lumped.model.mesh_cycle import mesh_cycle
from lumped.model.periodic_system import periodic_system
from lumped.schema.bodies import bodies_of
from lumped.schema.pair import GearPair
from lumped.typing import FloatArray
from validation.check.curves import STATICS, Curves
from validation.check.mesh_frequency import nominal_cycles
from validation.check.origin import origin

if TYPE_CHECKING:
    import xarray as xr

#: Largest relative differences that agree. Geometry is exact, but programs print three digits. Variants
#: of one method for the stiffness differ by some per cent. Frequencies are square roots of stiffness.
_GEOMETRY = 5e-3
_BODIES = 0.02
_STIFFNESS = 0.05
_FREQUENCY = 0.025
#: Trial phases of a mesh stiffness in a mesh cycle.
_PHASES = 512


class StaticRow(NamedTuple):
    """One static quantity: values of the other model and of the lumped model, and what agrees.

    Attributes
    ----------
    name : plain name
    unit : SI unit
    theirs, ours : values
    limit : largest relative difference that agrees
    """

    name: str
    unit: str
    theirs: float
    ours: float
    limit: float

    @property
    def difference(self) -> float:
        """Their value over ours, less 1."""
        if self.ours == 0.0:
            return 0.0 if self.theirs == 0.0 else math.inf
        return self.theirs / self.ours - 1.0

    @property
    def agrees(self) -> bool:
        """Whether the difference is within the limit."""
        return abs(self.difference) <= self.limit


@dataclass(frozen=True, eq=False)
class StaticRung:
    """Static quantities of another model beside those of the lumped model.

    Attributes
    ----------
    pair : the gear pair
    rows : the quantities that the other model states or shows; may be empty
    """

    pair: GearPair
    rows: tuple[StaticRow, ...]

    @property
    def wrong(self) -> tuple[StaticRow, ...]:
        """The quantities that differ, the largest difference over its limit first."""
        differing = [row for row in self.rows if not row.agrees]
        return tuple(sorted(differing, key=lambda row: -abs(row.difference) / max(row.limit, 1e-12)))

    @property
    def agrees(self) -> bool:
        """Whether no quantity differs."""
        return not self.wrong

    @cached_property
    def table(self) -> xr.Dataset:
        """Dataset over ``quantity``: theirs and ours in the unit ``units``, difference, limit, agrees."""
        columns = {
            "theirs_static": ([row.theirs for row in self.rows], "value of the other model"),
            "ours_static": ([row.ours for row in self.rows], "value of spurcheck"),
            "difference": ([row.difference for row in self.rows], "their value over ours, less 1"),
            "limit": ([row.limit for row in self.rows], "largest difference that agrees"),
            "agrees": ([row.agrees for row in self.rows], "whether the difference is within the limit"),
        }
        dataset = labelled_dataset(
            {name: ("quantity", values, "1", words) for name, (values, words) in columns.items()},
            {"quantity": ([row.name for row in self.rows], "1", "quantity")},
            origin(self.pair),
        )
        return dataset.assign_coords(units=("quantity", [row.unit for row in self.rows]))


def static_rung(curves: Curves, pair: GearPair) -> StaticRung:
    """Return the comparison of everything static that another model states or shows.

    Parameters
    ----------
    curves : the curves; their ``statics``, and a channel of ``mesh_stiffness``
    pair : the gear pair

    Raises
    ------
    ParameterError : a static value of a wrong shape
    """
    healthy = pair.healthy
    rows: list[StaticRow] = []
    for name, value in curves.statics.items():
        if name in _OURS:
            rows.append(_number(name, value, healthy))
    if "natural_frequencies" in curves.statics:
        theirs = np.sort(real_array("natural_frequencies", curves.statics["natural_frequencies"]).ravel())
        # Without rigid motions.
        rows += _frequency_rows(
            theirs[theirs > 1e-6 * theirs[-1]], np.sort(natural_frequencies(healthy).to_numpy())
        )
    if "M" in curves.statics or "K" in curves.statics:
        rows += _matrix_rows(curves.statics, healthy)
    for channel in curves.of_quantity("mesh_stiffness"):
        rows += _stiffness_rows(nominal_cycles(curves, pair), channel.values, healthy)
    return StaticRung(pair, tuple(rows))


#: Static number -> plain name, limit, and how ours is read from the pair.
_OURS: Mapping[str, tuple[str, float, Callable[[GearPair], float]]] = {
    "contact_ratio": ("contact ratio", _GEOMETRY, lambda pair: pair.geometry.contact_ratio),
    "base_radius_pinion": (
        "base radius of the pinion", _GEOMETRY, lambda pair: pair.geometry.base_radius_pinion
    ),
    "base_radius_gear": ("base radius of the gear", _GEOMETRY, lambda pair: pair.geometry.base_radius_gear),
    "centre_distance": ("centre distance", _GEOMETRY, lambda pair: pair.geometry.centre_distance),
    "mass_pinion": ("mass of the pinion", _BODIES, lambda pair: bodies_of(pair).mass_pinion),
    "mass_gear": ("mass of the gear", _BODIES, lambda pair: bodies_of(pair).mass_gear),
    "inertia_pinion": (
        "moment of inertia of the pinion", _BODIES, lambda pair: bodies_of(pair).inertia_pinion
    ),
    "inertia_gear": ("moment of inertia of the gear", _BODIES, lambda pair: bodies_of(pair).inertia_gear),
    "static_force": (
        "static mesh force", _GEOMETRY,
        lambda pair: pair.operating.pinion_torque / pair.geometry.base_radius_pinion,
    ),
}  # fmt: skip


def _number(name: str, value: FloatArray, pair: GearPair) -> StaticRow:
    """Row of a static number."""
    words, limit, ours = _OURS[name]
    number = real_array(name, value).ravel()
    if number.size != 1:
        raise refuse(name, f"{number.size} values", "one number", "Give one number in SI units.")
    return StaticRow(words, STATICS[name], float(number[0]), float(ours(pair)), limit)


def _matrix_rows(statics: Mapping[str, FloatArray], pair: GearPair) -> list[StaticRow]:
    """Rows of mass and stiffness matrices in any coordinates.

    The compared quantities do not depend on the coordinates: the natural frequencies of the mean stiffness
    and, over the mesh cycle, the sum of squared frequencies, which is the trace of M^-1 K. Friction and
    damping are left out of both models.
    """
    if not {"M", "K"} <= statics.keys():
        missing = "K" if "M" in statics else "M"
        raise refuse(missing, "missing", "M and K, or neither", "Give both matrices.")
    mass = real_array("M", statics["M"])
    stiffness = np.atleast_3d(real_array("K", statics["K"]).T).T
    size = stiffness.shape[-1]
    if mass.shape != (size, size) or stiffness.shape[-2] != size or np.linalg.matrix_rank(mass) < size:
        shapes = f"M {mass.shape}, K {np.shape(statics['K'])}"
        raise refuse("M, K", shapes, "M (n, n), regular, and K (n, n) or (m, n, n)", "Correct the shapes.")
    system = periodic_system(pair.with_(law="none"), "elastic")
    half = len(system.coordinates)
    count = len(stiffness) if len(stiffness) > 1 else _PHASES
    ours = -system.matrices(np.arange(count) * (system.period / count))[:, half:, :half]
    theirs = np.linalg.solve(mass, stiffness)
    rows = _frequency_rows(_frequencies(theirs.mean(axis=0)), _frequencies(ours.mean(axis=0)))
    if len(stiffness) > 1:
        traces = [np.trace(each, axis1=1, axis2=2) for each in (theirs, ours)]
        rows += _over_cycle("sum of squared frequencies", "rad^2/s^2", traces[0], traces[1])
    return rows


def _frequencies(squares: FloatArray) -> FloatArray:
    """Return the natural frequencies [Hz] of M^-1 K in increasing order, without rigid motions."""
    values = np.sort(np.linalg.eigvals(squares).real)
    return np.asarray(np.sqrt(values[values > 1e-9 * values[-1]]) / (2.0 * np.pi), dtype=np.float64)


def _frequency_rows(theirs: FloatArray, ours: FloatArray) -> list[StaticRow]:
    """Rows of natural frequencies [Hz] in increasing order, and of their number."""
    rows = [StaticRow("number of natural frequencies", "1", theirs.size, ours.size, 0.0)]
    pairs = zip(theirs, ours, strict=False)
    return rows + [
        StaticRow(f"natural frequency {number}", "Hz", float(their), float(our), _FREQUENCY)
        for number, (their, our) in enumerate(pairs, start=1)
    ]


def _stiffness_rows(cycles: FloatArray, values: FloatArray, pair: GearPair) -> list[StaticRow]:
    """Rows of a mesh stiffness over mesh cycles from any phase on: in the phase with the best agreement."""
    phases = np.arange(_PHASES) / _PHASES
    cycle = mesh_cycle(pair)
    ours = cycle.sample(phases * cycle.period).stiffness.sum(axis=0)
    by_phase = np.argsort(np.mod(cycles, 1.0))
    theirs = np.interp(phases, np.mod(cycles, 1.0)[by_phase], values[by_phase], period=1.0)
    spectrum = np.fft.rfft(theirs - theirs.mean()).conj() * np.fft.rfft(ours - ours.mean())
    shift = int(np.argmax(np.fft.irfft(spectrum, _PHASES)))
    return list(_over_cycle("mesh stiffness", "N/m", np.roll(theirs, shift), ours))


def _over_cycle(name: str, unit: str, theirs: FloatArray, ours: FloatArray) -> Iterator[StaticRow]:
    """Rows of a quantity over a mesh cycle: mean, largest, smallest, variation in step.

    The variation in step is the part of their variation that is in phase with ours, over the mean. It is
    small if the curves are shifted in time, or if time runs backwards in one model.
    """
    values: tuple[tuple[str, Callable[[FloatArray], float]], ...] = (
        ("mean", lambda curve: float(np.mean(curve))),
        ("largest", lambda curve: float(np.max(curve))),
        ("smallest", lambda curve: float(np.min(curve))),
    )
    for word, value in values:
        yield StaticRow(f"{name}, {word}", unit, value(theirs), value(ours), _STIFFNESS)
    their_variation = theirs / theirs.mean() - 1.0
    our_variation = ours / ours.mean() - 1.0
    size = float(np.sqrt(np.mean(our_variation**2)))
    if size > 0.0:
        in_step = float(np.mean(their_variation * our_variation)) / size
        yield StaticRow(f"{name}, variation in step, over the mean", "1", in_step, size, _STIFFNESS)
