"""Comparison of a gear mesh of ROSS, or of matrices of another model, with the same pair in spurcheck.

Sources: attributes of ``Mesh`` and ``GearElementTVMS`` of ROSS 2.3 (github.com/petrobras/ross); its stiffness
is the potential-energy method with a linear contact, as ``hertz = "linear"`` of docs/theory/mesh_physics.md.
Both begin a mesh cycle with a pair at A.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

import lumped
from lumped.arguments import real_array
from lumped.errors import refuse
from lumped.labelling import labelled_dataset, provenance
from lumped.model.periodic_system import Supports, periodic_system, supports_of
from lumped.schema.files import AnyPair, load_gear_pair
from lumped.schema.pair import GearPair
from lumped.typing import FloatArray
from validation.exchange.new_pair_file import new_pair

if TYPE_CHECKING:
    import numpy.typing as npt
    import xarray as xr

#: Largest relative differences that agree. Geometry is exact. Variants of the method for the stiffness differ
#: by some per cent. Frequencies are square roots of stiffness.
_GEOMETRY = 1e-6
_STIFFNESS = 0.05
_FREQUENCY = 0.025


class Row(NamedTuple):
    """One compared quantity: values of the other model and of spurcheck, and the largest difference."""

    name: str
    unit: str
    theirs: float
    ours: float
    limit: float


def compare_ross(mesh: Any, speed: float | str, torque: float | str) -> xr.Dataset:
    """Compare a mesh of two ``GearElementTVMS`` of ROSS with the same pair here.

    Parameters
    ----------
    mesh : ``ross.Mesh`` of two ``GearElementTVMS``, or anything with their attributes; spur gears
    speed : of the driving gear [rpm]
    torque : on the driving gear [N m]

    Returns
    -------
    xarray.Dataset over ``quantity``: ``ross`` and ``spurcheck`` in the unit ``units``; ``difference``, the
    value of ROSS over the value of spurcheck, less 1; ``limit`` and ``agrees``. The variation in step is the
    part of the stiffness variation of ROSS that is in phase with the variation of spurcheck, over the mean. A
    shift, or time that runs backwards, makes the variation in step small. Both transmission errors are of the
    lumped model, with the stiffness of ROSS and of spurcheck. The attribute ``parameters`` is the pair as a
    parameter file.

    Raises
    ------
    ParameterError : no such mesh, helical gears, or a pair that cannot exist
    """
    pair = _pair(mesh, speed, torque)
    g = pair.geometry
    gears = (mesh.driving_gear, mesh.driven_gear)
    # The last point of a mesh cycle is the first of the next one.
    theirs = np.asarray(mesh.stiffness_range, dtype=float)[:-1]
    phase = np.arange(theirs.size) / theirs.size
    cycle = lumped.mesh_cycle(pair)
    ours = cycle.sample(phase * cycle.period).stiffness.sum(axis=0)
    with_theirs = pair.with_(stiffness={"phase": phase, "stiffness [N/m]": theirs})
    motions = [lumped.steady_state(one) for one in (with_theirs, pair)]
    their_swing, our_swing = (np.ptp(motion["dte"].to_numpy()) for motion in motions)
    bodies = lumped.bodies(pair)
    rows: list[Row] = [
        Row("base radius, driving gear", "m", gears[0].base_radius, g.base_radius_pinion, _GEOMETRY),
        Row("base radius, driven gear", "m", gears[1].base_radius, g.base_radius_gear, _GEOMETRY),
        Row("contact ratio", "1", mesh.contact_ratio, g.contact_ratio, _GEOMETRY),
        Row("mass, driving gear", "kg", gears[0].m, bodies.mass_pinion, _STIFFNESS),
        Row("moment of inertia, driving gear", "kg m^2", gears[0].Ip, bodies.inertia_pinion, _STIFFNESS),
        *_over_cycle("mesh stiffness", "N/m", theirs, ours),
        Row("transmission error, peak to peak", "m", their_swing, our_swing, _STIFFNESS),
    ]
    return _compared("ross", rows, pair, "springs")


def compare_matrices(
    pair: AnyPair, M: npt.ArrayLike, K: npt.ArrayLike, *, supports: Supports | None = None
) -> xr.Dataset:
    """Compare mass and stiffness matrices of another model of a gear pair with the lumped model.

    The compared quantities do not depend on the coordinates: the natural frequencies of the mean stiffness
    and, over the mesh cycle, the sum of squared frequencies, which is the trace of M^-1 K. Friction and
    damping are left out of both models.
    Source: docs/theory/equations.md.

    Parameters
    ----------
    pair : the gear pair, with its bearings
    M : (n, n) mass matrix of any coordinates and units that make M^-1 K a matrix in 1/s^2
    K : (n, n) stiffness matrix, or (m, n, n) at m equal steps of a mesh cycle that begins with a pair at A
    supports : "springs", the four of ``bearings``, or "shafts", with their modes up to
        ``shafts.max_frequency``; by default the shafts of a pair that has them

    Returns
    -------
    xarray.Dataset as of ``compare_ross``, with ``matrices`` in place of ``ross``

    Raises
    ------
    ParameterError : matrices of other shapes, or a singular M
    """
    pair = load_gear_pair(pair).with_(law="none")
    mass = real_array("M", M)
    stiffness = np.atleast_3d(real_array("K", K).T).T
    n = stiffness.shape[-1]
    if mass.shape != (n, n) or stiffness.shape[-2] != n or np.linalg.matrix_rank(mass) < n:
        shapes = f"M {mass.shape}, K {np.shape(K)}"
        raise refuse("M, K", shapes, "M (n, n), regular, and K (n, n) or (m, n, n)", "Correct the shapes.")
    system = periodic_system(pair, "elastic", supports=supports)
    m = len(system.coordinates)
    count = len(stiffness) if len(stiffness) > 1 else 512
    ours = -system.matrices(np.arange(count) * (system.period / count))[:, m:, :m]
    theirs = np.linalg.solve(mass, stiffness)
    modes = [_frequencies(one.mean(axis=0)) for one in (theirs, ours)]
    rows = [Row("number of natural frequencies", "1", modes[0].size, modes[1].size, 0.0)]
    for number, (a, b) in enumerate(zip(*modes, strict=False), start=1):
        rows.append(Row(f"natural frequency {number}", "Hz", a, b, _FREQUENCY))
    if len(stiffness) > 1:
        traces = [np.trace(one, axis1=1, axis2=2) for one in (theirs, ours)]
        rows += _over_cycle("sum of squared frequencies", "rad^2/s^2", *traces)
    return _compared("matrices", rows, pair, supports_of(pair, supports))


def _frequencies(squares: FloatArray) -> FloatArray:
    """Return the natural frequencies [Hz] of M^-1 K in increasing order, without rigid motions."""
    values = np.sort(np.linalg.eigvals(squares).real)
    return np.asarray(np.sqrt(values[values > 1e-9 * values[-1]]) / (2.0 * np.pi), dtype=np.float64)


def _over_cycle(name: str, unit: str, theirs: FloatArray, ours: FloatArray) -> list[Row]:
    """Return the rows of a quantity over a mesh cycle: mean, largest, smallest, variation in step.

    The variation in step is small if the curves are shifted in time, or if time runs backwards in one model.
    """
    rows = [
        Row(f"{name}, {word}", unit, float(value(theirs)), float(value(ours)), _STIFFNESS)
        for word, value in (("mean", np.mean), ("largest", np.max), ("smallest", np.min))
    ]
    their_variation = theirs / theirs.mean() - 1.0
    our_variation = ours / ours.mean() - 1.0
    size = float(np.sqrt(np.mean(our_variation**2)))
    in_step = np.mean(their_variation * our_variation) / size
    return [*rows, Row(f"{name}, variation in step, over the mean", "1", in_step, size, _STIFFNESS)]


def _compared(theirs: str, rows: list[Row], pair: GearPair, supports: Supports) -> xr.Dataset:
    """Return the rows as a dataset. ``theirs``: name of the variable for the values of the other model."""
    their_values = np.array([row.theirs for row in rows], dtype=float)
    our_values = np.array([row.ours for row in rows], dtype=float)
    limits = np.array([row.limit for row in rows])
    difference = their_values / our_values - 1.0
    columns = {
        theirs: (their_values, "value of the other model"),
        "spurcheck": (our_values, "value here"),
        "difference": (difference, "value of the other model over that here, less 1"),
        "limit": (limits, "largest difference that agrees"),
        "agrees": (np.abs(difference) <= limits, "whether it agrees"),
    }
    result = labelled_dataset(
        {name: ("quantity", values, "1", words) for name, (values, words) in columns.items()},
        {"quantity": ([row.name for row in rows], "1", "quantity")},
        provenance(pair) | {"supports": supports},
    )
    return result.assign_coords(units=("quantity", [row.unit for row in rows]))


def _pair(mesh: Any, speed: float | str, torque: float | str) -> GearPair:
    """Return the pair that equals a mesh of ROSS, with stiffness by the method of ROSS."""
    try:
        if mesh.helix_angle != 0.0:
            raise refuse("mesh", f"helix angle {mesh.helix_angle:g} rad", "spur gears", "Compare spur gears.")
        gears = {"pinion": mesh.driving_gear, "gear": mesh.driven_gear}
        first = mesh.driving_gear
        changes: dict[str, Any] = {
            "basic_rack.pressure_angle": f"{float(first.pr_angle)!r} rad",
            "basic_rack.addendum_coefficient": first.addendum_coeff,
            "basic_rack.dedendum_coefficient": first.addendum_coeff + first.tip_clearance_coeff,
            "basic_rack.fillet_radius_coefficient": first.tip_clearance_coeff
            / (1.0 - np.sin(first.pr_angle)),
            "mesh.stiffness": {"model": "energy", "hertz": "linear"},
            "mesh.contact": "prescribed",
            "mesh.relief": "ignored",
        }
        for name, one in gears.items():
            changes |= {
                f"{name}.face_width": f"{float(one.width)!r} m",
                f"{name}.bore": f"{float(one.bore_diameter)!r} m",
                f"{name}.youngs_modulus": f"{float(one.material.E)!r} Pa",
                f"{name}.poisson_ratio": float(one.material.Poisson),
                f"{name}.density": float(one.material.rho),
            }
        teeth = f"{first.n_teeth}/{mesh.driven_gear.n_teeth}"
        pair = new_pair(teeth, f"{float(first.module)!r} m", f"{float(first.width)!r} m", speed, torque)
    except AttributeError as error:
        needed = "ross.Mesh of two GearElementTVMS"
        raise refuse("mesh", f"{type(mesh).__name__}: {error}", needed, "Give such a mesh.") from None
    return pair.with_(changes)
