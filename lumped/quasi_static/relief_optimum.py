"""Tip relief of both gears for least static transmission error at a design torque.

Both gears get the same tip relief, given by its amount and its length along the line of action: back from D
on the pinion and from A on the gear. With one constant stiffness per pair the best linear relief is known:
amount F/k, the deflection of a single pair, over the whole length of double contact; it makes the
transmission error constant at the design torque.

Sources: Harris 1958 for the relief of constant transmission error; docs/theory/mesh_physics.md.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.optimize import minimize

from lumped.arguments import real_number
from lumped.display.result import DisplayedResult
from lumped.errors import refuse
from lumped.gear_geometry.geometry import Geometry
from lumped.quasi_static.load_sharing import share_load
from lumped.quasi_static.transmission_error import MeshPositions, mesh_positions
from lumped.schema.files import AnyPair, load_gear_pair
from lumped.schema.pair import GearPair
from lumped.typing import FloatArray

#: Weight of the amount against the transmission error: breaks ties, leaves the bottom of a V-shaped valley.
_LEAST_MATERIAL = 1e-2


@dataclass(frozen=True, repr=False)
class OptimalRelief(DisplayedResult):
    """Linear tip relief of both gears with the least peak to peak static transmission error.

    Attributes
    ----------
    amount : C at the tip [m]
    length : of the relief along the line of action [m]
    start_roll_angle_pinion, start_roll_angle_gear : where it starts [rad]
    peak_to_peak : of the static transmission error with it [m]
    unmodified : the same without relief [m]
    torque : design torque on the pinion [N m]
    """

    amount: float
    length: float
    start_roll_angle_pinion: float
    start_roll_angle_gear: float
    peak_to_peak: float
    unmodified: float
    torque: float


def optimal_relief(pair: AnyPair, *, torque: float | None = None) -> OptimalRelief:
    """Linear tip relief of both gears for the least peak to peak static transmission error.

    A map over amounts up to twice the largest deflection and over lengths finds the valley. A simplex search
    finds the bottom of the valley, because the objective has kinks. More relief over less length can be as
    good: it only takes the tips out of contact. Among equal optima the one with the least amount is taken.

    Parameters
    ----------
    pair : a validated gear pair; its own tip relief is replaced, root relief kept
    torque : design torque > 0 [N m]; default the operating torque

    Raises
    ------
    ParameterError : the design torque is not positive, or the stiffness is that of the whole mesh, which has
        the profile in it
    """
    pair = load_gear_pair(pair)
    if pair.mesh.stiffness.whole_mesh:
        allowed = "a model, or the curve of one tooth pair: that of the whole mesh has the profile in it"
        action = "Write kind = 'pair' with such a curve, or with_(stiffness='finite_elements')."
        raise refuse("mesh.stiffness.kind", "total", allowed, action)
    design_torque = pair.operating.pinion_torque if torque is None else torque
    moment = real_number(
        "torque", design_torque, 0.0, above=True, unit="N m", action="Give the design torque."
    )
    plain_tips = pair.with_(pinion__tip_relief=None, gear__tip_relief=None, operating__pinion_torque=moment)
    g = pair.geometry
    bare = mesh_positions(plain_tips)
    force = moment / pair.geometry.base_radius_pinion
    plain = share_load(bare.stiffness, bare.error, force, bare.coupling).transmission_error
    scale = float(plain.max() - min(bare.error.min(), 0.0))
    path = g.L_XD - g.L_XA
    amounts = np.linspace(0.0, 2.0 * scale, 41)
    lengths = np.linspace(0.02, 0.6, 40) * path
    grid = np.stack([_peak_to_peak(bare, g, force, amounts, float(one)) for one in lengths], axis=1)
    preferred = grid / scale + _LEAST_MATERIAL * amounts[:, None] / scale
    i, j = np.unravel_index(int(np.argmin(preferred)), grid.shape)

    def objective(x: FloatArray) -> float:
        if not (0.0 <= x[0] <= 3.0 and 0.01 < x[1] < 0.95):
            return 10.0
        swing = _peak_to_peak(bare, g, force, np.array([x[0] * scale]), x[1] * path)
        return float(swing[0] / scale + _LEAST_MATERIAL * x[0])

    start = np.array([amounts[i] / scale, lengths[j] / path])
    simplex = start + np.array([[0.0, 0.0], [0.04, 0.0], [0.0, 0.015]])
    search = minimize(
        objective,
        start,
        method="Nelder-Mead",
        options={"initial_simplex": simplex, "xatol": 1e-6, "fatol": 1e-9, "maxiter": 600},
    )
    amount = float(search.x[0] * scale)
    length = float(search.x[1] * path)
    return OptimalRelief(
        amount=amount,
        length=length,
        start_roll_angle_pinion=(g.L_XD - length) / g.base_radius_pinion,
        start_roll_angle_gear=(g.L_XY - g.L_XA - length) / g.base_radius_gear,
        peak_to_peak=float(_peak_to_peak(bare, g, force, np.array([amount]), length)[0]),
        unmodified=float(np.ptp(plain)),
        torque=force * g.base_radius_pinion,
    )


def with_tip_relief(pair: AnyPair, optimum: OptimalRelief) -> GearPair:
    """Return the pair with this tip relief on both gears.

    Parameters
    ----------
    pair : a validated gear pair
    optimum : the relief
    """
    pair = load_gear_pair(pair)

    def section(start: float) -> dict[str, object]:
        return {"amount": optimum.amount * 1e6, "start_roll_angle": math.degrees(start)}

    return pair.with_(
        pinion__tip_relief=section(optimum.start_roll_angle_pinion),
        gear__tip_relief=section(optimum.start_roll_angle_gear),
    )


def _peak_to_peak(
    mesh: MeshPositions, g: Geometry, force: float, amounts: FloatArray, length: float
) -> FloatArray:
    """Peak to peak transmission error for several amounts at one length; (a,) [m]."""
    xi = np.clip(mesh.xi, g.L_XA, g.L_XD)
    form = np.maximum((xi - g.L_XD) / length + 1.0, 0.0) + np.maximum((g.L_XA - xi) / length + 1.0, 0.0)
    error = mesh.error + amounts[:, None, None] * form
    approach = share_load(mesh.stiffness, error, force, mesh.coupling).transmission_error
    return np.asarray(np.ptp(approach, axis=1))
