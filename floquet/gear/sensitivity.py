"""How the largest multiplier of a gear pair changes with each parameter of a stability chart.

Sources: docs/theory/floquet.md, "Sensitivities".
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from floquet.engine.sensitivity import multiplier_derivatives, segment_time
from floquet.engine.system import PeriodicSystem
from floquet.gear.axes import GEAR_AXES, gear_axis, operating_value, vary
from floquet.gear.multipliers import OffLineOfAction, gear_pair_multipliers, gear_pair_system
from lumped.arguments import some_of
from lumped.errors import NumericalError
from lumped.labelling import labelled_dataset
from lumped.schema.files import AnyPair, load_gear_pair
from lumped.schema.pair import GearPair
from lumped.typing import FloatArray

if TYPE_CHECKING:
    import xarray as xr

# Differences of the coefficients, of order 4: truncation (5e-3)^4 relative, below 1e-9; the friction laws are
# fitted within 1e-10, which makes 2e-8. Smaller steps would magnify that misfit beyond what rtol allows.
_STEP = 5e-3
_CENTRAL = ((-2, 1 / 12), (-1, -2 / 3), (1, 2 / 3), (2, -1 / 12))
_FORWARD = ((0, -25 / 12), (1, 4.0), (2, -3.0), (3, 4 / 3), (4, -1 / 4))


def gear_sensitivities(
    pair: AnyPair, parameters: Sequence[str] | None = None, *, rtol: float = 1e-8
) -> xr.Dataset:
    """Derivatives of the largest |multiplier| of a gear pair with respect to parameters.

    The feedback block is written in segment time, where speed and contact ratio, which move period and
    switches, are ordinary coefficients; its dM/dp follows from dA/dp, and the derivatives from left and right
    eigenvectors (`multiplier_derivatives`). Those of the bearings off the line of action are in closed form.
    Only dA/dp is a difference quotient, of the coefficients themselves, which are smooth in every parameter.

    Parameters
    ----------
    pair : the gear pair at its operating point
    parameters : names out of `GEAR_AXES`; default all
    rtol : as in `monodromy`

    Returns
    -------
    Dataset over ``parameter``: ``value`` and ``derivative`` d(spectral radius)/dp, in the units of coordinate
    ``units``; ``relative`` = p d(spectral radius)/dp, the change for a change of p by 100 %;
    ``multipliers`` and ``multiplier_derivatives`` of the feedback block over ``multiplier``. Attributes:
    spectral_radius, and largest ("mesh" or "oloa"), the block of the largest multiplier.

    Raises
    ------
    ParameterError : unknown parameter
    NumericalError
        The largest multiplier is nearly defective, or a switch passes another one at this very point.
    """
    pair = load_gear_pair(pair)
    names = list(GEAR_AXES if parameters is None else some_of("parameters", parameters, GEAR_AXES))
    axes = [gear_axis(name) for name in names]
    whole = gear_pair_multipliers(pair, rtol)
    oloa = bool(np.abs(whole.oloa).max() > np.abs(whole.feedback).max())
    count = whole.feedback.size
    value, slope = np.empty(len(names)), np.empty(len(names))
    values = np.empty((len(names), count), dtype=complex)
    slopes = np.empty_like(values)
    for row, (name, axis) in enumerate(zip(names, axes, strict=True)):
        value[row] = operating_value(pair, name)
        step = _STEP * (abs(value[row]) or 1.0)
        central = value[row] - 2 * step > axis.low and value[row] + 2 * step <= axis.high
        stencil = _CENTRAL if central else _FORWARD
        points = [(weight / step, value[row] + node * step) for node, weight in stencil]
        base, dA = _coefficients(pair, name, value[row], points)
        found = multiplier_derivatives(base, dA, rtol, magnitude=abs(value[row]) or 1.0)
        values[row], slopes[row] = found.multipliers, found.derivatives
        slope[row] = _oloa_slope(pair, name, points) if oloa else found.radius()
    each = ("parameter", "multiplier")
    return labelled_dataset(
        {
            "value": ("parameter", value, "that of the parameter", "value at the operating point"),
            "derivative": (
                "parameter", slope, "1 over that of the parameter", "derivative of the spectral radius"
            ),
            "relative": ("parameter", slope * value, "1", "parameter times derivative"),
            "multipliers": (each, values, "1", "Floquet multipliers of the feedback block"),
            "multiplier_derivatives": (
                each, slopes, "1 over that of the parameter", "derivatives of the multipliers"
            ),
        },
        {"parameter": (np.array(names, dtype=object), "1", "parameter")},
        {
            "title": f"sensitivity of the largest multiplier of {pair.name}",
            "spectral_radius": whole.spectral_radius,
            "largest": "oloa" if oloa else "mesh",
        },
    ).assign_coords(units=("parameter", np.array([axis.units for axis in axes], dtype=object)))  # fmt: skip


class _Difference:
    """dA/dp as a weighted sum of the coefficients at neighbouring parameters."""

    def __init__(self, systems: list[tuple[float, PeriodicSystem]]) -> None:
        self.systems = systems

    def __call__(self, times: FloatArray) -> FloatArray:
        return np.asarray(sum(weight * system.evaluate(times) for weight, system in self.systems))


def _coefficients(
    pair: GearPair, name: str, value: float, points: list[tuple[float, float]]
) -> tuple[PeriodicSystem, _Difference]:
    """Feedback block in segment time at the parameter, and its derivative."""
    base = segment_time(gear_pair_system(vary(pair, {name: value}), "mesh"))
    near = [(w, segment_time(gear_pair_system(vary(pair, {name: p}), "mesh"))) for w, p in points]
    if any(system.edges.size != base.edges.size for _, system in near):
        raise NumericalError(
            f"at {name} = {value:g} two switches of the mesh cycle coincide, where the largest multiplier "
            "has different derivatives to either side. Move the operating point a little."
        )
    return base, _Difference(near)


def _oloa_slope(pair: GearPair, name: str, points: list[tuple[float, float]]) -> float:
    """Derivative of the largest |exp(s T)| of the bearings off the line of action."""
    moduli = []
    for _, value in points:
        at = vary(pair, {name: value})
        period = at.pair.geometry.mesh_period
        moduli.append(float(np.exp(OffLineOfAction.of(at).exponents.real * period).max()))
    return sum(weight * modulus for (weight, _), modulus in zip(points, moduli, strict=True))
