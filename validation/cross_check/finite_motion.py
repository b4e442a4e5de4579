r"""What finite motions must change in the lumped motion, predicted without the multibody model.

The lumped model holds contact and friction at the nominal rotation. Three things follow the actual motion
instead; each is put back here into the lumped equations, whose periodic solution then is the prediction.

*Late entry, early exit.* With the overlap :math:`\delta` (the transmission error) and the length L of the
line of action, the flanks that meet at the distance :math:`\rho_p` from the pinion's tangent point have
:math:`\rho_p + \rho_g = L + \delta`, and their contact stands in the middle of the overlap, at
:math:`\xi = (\rho_p - \rho_g + L_{XY})/2`. The gear's tip lets go at :math:`\rho_g = L_{XY} - L_{XA}`, the
pinion's at :math:`\rho_p = L_{XD}`, so load is carried only from :math:`L_{XA} + s` to :math:`L_{XD} - s`,

.. math:: s = \tfrac12 (\delta + L - L_{XY}), \qquad
          L - L_{XY} = x_g - x_p + \frac{r_{bp} + r_{bg}}{L_{XY}} (y_g - y_p),

the second by differentiating :math:`L^2 = a^2 - (r_{bp} + r_{bg})^2`. Rotations move the contact along the
path, by :math:`p = \tfrac12 [r_{bp} (\theta_p + \psi) + r_{bg} (\theta_g - \psi)]` beyond its static value,
where :math:`\psi = (y_g - y_p)/L_{XY}` is the turn of the line of action; entry and exit are met where the
nominal position is :math:`L_{XA} + s - p` and :math:`L_{XD} - s - p`.

*Actual sliding velocity.* Friction has the sign and the size that belong to

.. math:: v_s = (\Omega_p + \dot\theta_p) \xi - (\Omega_g + \dot\theta_g)(L_{XY} - \xi)
          - (\dot y_p - \dot y_g) + (\Omega_p + \Omega_g) p + \tfrac12 (\Omega_p - \Omega_g)(L - L_{XY}).

The laws read this velocity, the radii :math:`\rho_p, \rho_g` of the actual contact, and the sum of the
rolling velocities :math:`(\Omega_p + \dot\theta_p + \dot\psi) \rho_p + (\Omega_g + \dot\theta_g -
\dot\psi) \rho_g`. Where the sign of friction changes over a velocity :math:`v_r`, a choice of the numerics,
it is that of :math:`\tanh(v_s/v_r)` here too.

*Turned line of action.* The normal load N acts along a line turned by :math:`\psi`, which pushes the pinion
off the nominal line by :math:`-N \psi` and the gear by :math:`+N \psi`: a spring :math:`N/L_{XY}` between y_p
and y_g. It is small beside the bearings, but it moves their lightly damped vibration, and with that the place
where sliding reverses.

Each depends on the motion it changes, so they are found by iteration. Teeth are held at zero sliding where
friction there can stop the sliding faster than the motion drives it through zero (Filippov's condition): with
:math:`\mu_0` the coefficient at zero sliding and :math:`1/m_s` the sliding acceleration per unit friction
force, where :math:`|\dot v_s + \mu N/m_s| < \mu_0 N/m_s` just before. Then sign() has no motion: the
iteration does not settle, or it finds a motion that could not pass zero.

Not predicted: teeth that let go; contact beyond the nominal path, where the bearings bring the centres so
close that s is negative; quadratic terms of the overlap in the displacements of the centres; the
levers of friction about moved centres. They are of first order as well, but with lengths of the machine in
place of the mesh deflection's, so smaller by far.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, replace

import numpy as np
import xarray as xr

from floquet.gear.orbit import GearOrbit
from floquet.gear.unilateral import contact_cycle
from lumped import GearPair
from lumped.arguments import some_of
from lumped.model.mesh_cycle import mesh_cycle
from lumped.model.periodic_system import periodic_system
from lumped.model.solution import initial_state
from lumped.model.steady import periodic_solution, sample_times
from lumped.typing import BoolArray, FloatArray
from validation.cross_check.loaded_motion import LoadedModel, PushedSystem
from validation.cross_check.parted_motion import PartedLoadedModel, PartedModel
from validation.cross_check.shifted_motion import ShiftedModel, Shifts

#: Times per mesh cycle at which the motion is read off: while it settles, and in the end at least.
_COARSE, _FINE = 1024, 4096
#: ``mesh.contact`` -> effects that are predicted; names as in ``multibody.EFFECTS``.
PREDICTED: Mapping[str, tuple[str, ...]] = {
    "prescribed": ("rotation_phase", "moving_line", "sliding_velocity", "entry_shift"),
    "loaded": ("rotation_phase", "moving_line", "sliding_velocity", "tip_contact", "path_work"),
}
_CHANGED = ("dte", "x_p", "x_g", "y_p", "y_g", "normal_load", "friction_force")


@dataclass(frozen=True, eq=False)
class FiniteMotion:
    """Predicted changes over the mesh cycle, to be added to the lumped periodic motion.

    Attributes
    ----------
    changes : quantity -> (k,), of tooth forces (pairs, k), at the times of the lumped motion
    entry, exit : how far into the path the load starts, and how far before its end it stops [m]
    settled : whether friction and motion settled and pass zero sliding; if not, friction may hold the teeth,
        and in the prediction it stays that of the nominal sliding velocity. Where not even that settles,
        nothing is predicted
    model : the lumped model with the effects that are predicted
    shifts : what the predicted motion moves; None where nothing is predicted
    jumps : (n,) times in the mesh cycle near which a predicted load jumps (loaded contact) [s]
    push : (6,) mean generalised forces of the teeth beside those of normal load and friction [N m, N]
    """

    changes: Mapping[str, FloatArray]
    entry: float
    exit: float
    settled: bool
    model: ShiftedModel
    shifts: Shifts | None
    push: FloatArray
    jumps: FloatArray

    def clear(self, time: FloatArray) -> BoolArray:
        """Which times [s] (k,) lie clear of the predicted jumps, by a step at which the motion is read."""
        if not self.jumps.size:
            return np.ones(time.size, dtype=np.bool_)
        period = self.model.cycle.period
        apart = np.abs(np.mod(time, period)[:, None] - self.jumps)
        return np.asarray(np.minimum(apart, period - apart).min(axis=1) > period / _FINE)

    def over(self, quantity: str, length: int) -> FloatArray:
        """Change of a quantity over whole cycles cut to ``length`` times."""
        change = self.changes[quantity]
        return np.resize(np.moveaxis(change, -1, 0), (length, *change.shape[:-1])).T


def finite_motion(
    pair: GearPair,
    cycle: xr.Dataset,
    effects: Collection[str] | None = None,
    *,
    friction_velocity: float = 0.0,
    orbit: GearOrbit | None = None,
) -> FiniteMotion:
    """Predict what finite motions change.

    Parameters
    ----------
    pair : a validated gear pair
    cycle : lumped periodic motion at even times over one mesh cycle, the end left out
    effects : names out of ``PREDICTED``, as ``multibody.steady_state`` takes them; default all of them
    friction_velocity : sliding velocity over which friction changes its sign (tanh) [m/s]; 0 at once
    orbit : the motion, of one mesh cycle, where teeth part

    Returns
    -------
    FiniteMotion

    Raises
    ------
    ParameterError : unknown effect
    NumericalError : the nominal motion is not periodic
    """
    known = PREDICTED[pair.mesh.contact]
    effects = known if effects is None else some_of("effects", effects, known, "Name predicted effects.")
    nominal = mesh_cycle(pair) if orbit is None else contact_cycle(pair)
    system = periodic_system(pair, "full", cycle=nominal)
    balance = periodic_solution(system, np.zeros(1), estimate_error=False)
    every = -(-_FINE // cycle.sizes["time"])
    coarse = sample_times(nominal.period, _COARSE)
    fine = sample_times(nominal.period, every * cycle.sizes["time"])
    static = initial_state(system, "static", balance)
    given = (pair, nominal, system, static, coarse, frozenset(effects), friction_velocity)
    loaded = pair.mesh.contact == "loaded"
    if orbit is None:
        model: ShiftedModel = (LoadedModel if loaded else ShiftedModel)(*given)
    else:
        model = (PartedLoadedModel if loaded else PartedModel)(*given, orbit)
    shifts, settled = model.settle(None)
    if settled:
        model = replace(model, times=fine)
        shifts, settled = model.settle(shifts)
    found = model.motion(shifts) if settled else None
    if found is not None and "sliding_velocity" in effects and model.held(found):
        found = None
    settled = found is not None
    if found is None:
        model = replace(model, times=fine, effects=model.effects - {"sliding_velocity"})
        shifts, without = model.settle(None)
        if not without:
            still = {name: np.zeros(cycle[name].shape) for name in _CHANGED}
            return FiniteMotion(still, 0.0, 0.0, False, model, None, np.zeros(6), np.empty(0))
        found = model.motion(shifts)
    motion, unmoved = model.response(found, fine), model.response(model.unmoved(), fine)
    changes = {name: (motion[name] - unmoved[name])[..., ::every] for name in _CHANGED}
    push, jumps = np.zeros(6), np.empty(0)
    if isinstance(found.system, PushedSystem):
        push, jumps = found.system.forces(fine).mean(axis=0), found.system.cycle.edges
    return FiniteMotion(changes, shifts.entry, shifts.exit, settled, model, shifts, push, jumps)
