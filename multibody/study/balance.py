"""Power balance of a multibody run: where the driving work goes.

The powers come from ``multibody.run.powers``, which does not read the forces that moved the bodies.

Sources: docs/theory/multibody.md, "Overlap, wrench and contact point"; the power balance of rigid bodies.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from lumped.arguments import whole_number
from lumped.display.result import DisplayedResult
from lumped.errors import refuse
from lumped.model.periodic_system import LTVSystem, Supports, on_springs
from lumped.model.solution import Initial
from lumped.schema.files import AnyPair, load_gear_pair
from lumped.schema.pair import GearPair
from lumped.typing import BoolArray, FloatArray
from multibody.contact.kinematics import TIP_CONTACT
from multibody.contact.records import X_G, X_P, Y_G, Y_P
from multibody.run.integration import Segment
from multibody.run.model import ExudynModel, contact_state
from multibody.run.powers import Powers, rotor_speeds, work
from multibody.run.setup import MOST_CYCLES, Fidelity, Setup, prepare

if TYPE_CHECKING:
    import xarray as xr

#: A step over less than the first share of the mesh cycle leads across an event. Where contact begins with a
#: load, a step over less than the second share also leads across an event, if the number of contacts changes
#: in the step. The integrator shrinks such a step at a jump that was not predicted: soft bearings shift the
#: jump far, or friction sticks.
_HAIR = 1e-11
_SHRUNK = 1e-6


@dataclass(frozen=True, repr=False)
class PowerBalance(DisplayedResult):
    """Work and energy over a run [J].

    Attributes
    ----------
    driving, braking : work of the driving torque, and work taken by the brake
    kinetic : increase of the kinetic energy, and of the elastic energy of the bearings
    bearings : dissipated in the bearings
    friction : dissipated by sliding friction between the teeth
    mesh_damping : dissipated by the damping of the teeth
    mesh_elastic : increase of the elastic energy of the teeth
    mesh_jump : elastic energy that comes with jumps of the stiffness, for which no force does work
    energy_residual : work on the teeth that goes into no energy, because the contact force has no part along
        the path of contact; zero with the effect ``path_work``
    """

    driving: float
    braking: float
    kinetic: float
    bearings: float
    friction: float
    mesh_damping: float
    mesh_elastic: float
    mesh_jump: float
    energy_residual: float

    @property
    def mesh_stiffness(self) -> float:
        """Work that the contact forces do on the elastic teeth [J]."""
        return self.mesh_elastic - self.mesh_jump + self.energy_residual

    @property
    def residual(self) -> float:
        """Driving work that is not accounted for [J]."""
        lost = self.bearings + self.friction + self.mesh_damping
        return self.driving - self.braking - self.kinetic - lost - self.mesh_stiffness


def power_balance(
    pair: AnyPair,
    cycles: int = 20,
    *,
    fidelity: Fidelity = "exact",
    initial: Initial | ArrayLike = "static",
    effects: Collection[str] | Mapping[str, bool] | None = None,
    rtol: float = 1e-8,
    friction_velocity: float | None = None,
    supports: Supports | None = None,
) -> PowerBalance:
    """Power balance of a run; arguments as ``multibody.simulate``.

    The balance is computed on springs alone: a pair with shafts needs ``supports="springs"``.
    The powers are integrated over every step of the integrator by four-point Gauss quadrature on its dense
    output.
    """
    pair = on_springs(load_gear_pair(pair), supports, "multibody.power_balance")
    cycles = whole_number("cycles", cycles, 1, MOST_CYCLES)
    setup = prepare(pair, fidelity, initial, effects, rtol, friction_velocity, "springs")
    return balance_of(setup, cycles)


def motion_balance(pair: GearPair, motion: xr.Dataset, rtol: float = 1e-8) -> PowerBalance:
    """Power balance of a periodic motion over one mesh cycle, by a run from its first state.

    Parameters
    ----------
    pair : a validated gear pair
    motion : on springs, of ``multibody.steady_state`` or ``simulate``, from the start of a mesh cycle
    rtol : relative tolerance of the run
    """
    start = motion.isel(time=0)
    about = motion.attrs
    if about["supports"] == "shafts":
        action = 'Compute the motion with supports="springs".'
        raise refuse("supports", "shafts", '"springs" for multibody.motion_balance', action)
    names = LTVSystem.of(pair, "full", supports="springs").state_names
    state = np.array([float(start[name]) for name in names])
    effects = [name for name in about["effects"].split(", ") if name]
    velocity = float(about["friction_velocity"])
    setup = prepare(pair, about["fidelity"], state, effects, rtol, velocity, "springs")
    return balance_of(setup.with_torques(setup.machine.torque_pinion, float(about["brake_torque"])), 1)


def balance_of(setup: Setup, cycles: int) -> PowerBalance:
    """Power balance of a model that is ready to run, over mesh cycles."""
    totals = np.zeros(len(Powers._fields))
    stored = [0.0]
    jumps = [0.0]

    def energy(segment: Segment, t: FloatArray) -> FloatArray:
        states = contact_state(setup.model, t, *segment.at(t))
        valid = np.arange(states.contacts.shape[1]) < states.counts[:, None]
        return np.asarray(np.where(valid, states.contacts["energy"], 0.0).sum(axis=1))

    def leads_across(segment: Segment) -> BoolArray:
        steps = np.diff(segment.times) / setup.machine.period
        across = steps < _HAIR
        short = np.flatnonzero(steps < _SHRUNK)
        before, after = (
            contact_state(setup.model, segment.times[j], segment.q[j], segment.v[j]).counts
            for j in (short, short + 1)
        )
        if not setup.model.flags & TIP_CONTACT:
            across[short] |= before != after
        return np.asarray(across, dtype=np.bool_)

    def visit(number: int, segment: Segment) -> None:
        totals[:] += work(setup.model, segment)
        hair = _HAIR * setup.machine.period
        across = np.flatnonzero(leads_across(segment))
        first_of = np.diff(across, prepend=-2) > 1
        last_of = np.diff(across, append=segment.times.size) > 1
        before = np.maximum(segment.times[across[first_of]] - hair, segment.times[0])
        after = segment.times[across[last_of] + 1]
        jumps.append(float((energy(segment, after) - energy(segment, before)).sum()))
        first, last = energy(segment, segment.times[[0, -1]])
        jumps.append(float(first) - stored[-1] if number else 0.0)
        stored.extend([float(first)] if not number else [])
        stored.append(float(last))

    edges = setup.edges(cycles)
    start = _stored(setup.model, setup.q, setup.v)
    q, v = setup.run(edges, visit)
    done = Powers(*totals)
    return PowerBalance(
        driving=float(done.driving),
        braking=float(done.braking),
        kinetic=_stored(setup.model, q, v) - start,
        bearings=float(done.bearings),
        friction=float(done.sliding),
        mesh_damping=float(done.tooth_dampers),
        mesh_elastic=stored[-1] - stored[1],
        mesh_jump=sum(jumps),
        energy_residual=float(done.energy_residual),
    )


def _stored(model: ExudynModel, q: FloatArray, v: FloatArray) -> float:
    """Kinetic energy and elastic energy of the bearings [J]."""
    m = model.machine
    omega_p, omega_g = rotor_speeds(m, v)
    kinetic = m.mass[0] * (v[X_P] ** 2 + v[Y_P] ** 2) + m.mass[1] * (v[X_G] ** 2 + v[Y_G] ** 2)
    kinetic += float(m.inertia[0] * omega_p**2 + m.inertia[1] * omega_g**2)
    return float(0.5 * (kinetic + m.bearing_stiffness.ravel() @ q[[X_P, Y_P, X_G, Y_G]] ** 2))
