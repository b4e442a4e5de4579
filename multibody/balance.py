"""Energy ledger of a multibody run: where the driving work goes.

The ledger is kept from contact records (loads, sliding and closing velocities), not from the forces that
moved the bodies, so a wrong wrench, sign or lever shows up as a residual.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from lumped.parameters import GearPair
from lumped.solution import Initial
from multibody import kernels as kn
from multibody.integration import Segment
from multibody.kinematics import MAX_PAIRS
from multibody.model import ExudynModel
from multibody.setup import Fidelity, prepare

FloatArray = NDArray[np.float64]
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(4)


@dataclass(frozen=True)
class PowerBalance:
    """Work and energy over a run [J].

    Attributes
    ----------
    driving : work of the driving torque
    braking : work taken by the brake
    stored : increase of kinetic energy and of elastic energy in the bearings
    bearings : dissipated in the bearings
    friction : dissipated by sliding friction between the teeth
    mesh_damping : dissipated by the damping of the teeth
    mesh_stiffness : work done on the elastic teeth: stored, or moved by the change of stiffness and profile
        along the path
    """

    driving: float
    braking: float
    stored: float
    bearings: float
    friction: float
    mesh_damping: float
    mesh_stiffness: float

    @property
    def residual(self) -> float:
        """Driving work that is not accounted for [J]."""
        gone = self.braking + self.stored + self.bearings + self.friction
        return self.driving - gone - self.mesh_damping - self.mesh_stiffness


def power_balance(
    pair: GearPair,
    cycles: int = 20,
    *,
    fidelity: Fidelity = "exact",
    initial: Initial | ArrayLike = "static",
    effects: Collection[str] | Mapping[str, bool] | None = None,
    rtol: float = 1e-8,
    friction_velocity: float | None = None,
) -> PowerBalance:
    """Energy ledger of a run; arguments as ``multibody.simulate``.

    The powers are integrated over every step of the integrator by four-point Gauss quadrature on its dense
    output.
    """
    setup = prepare(
        pair,
        fidelity=fidelity,
        initial=initial,
        effects=effects,
        rtol=rtol,
        friction_velocity=friction_velocity,
    )
    work = np.zeros(6)

    def visit(_number: int, segment: Segment) -> None:
        steps = np.diff(segment.times)[:, None]
        t = (segment.times[:-1, None] + 0.5 * steps * (1.0 + _NODES)).ravel()
        powers = _powers(setup.model, t, *segment.at(t))
        work[:] += (0.5 * steps * _WEIGHTS).ravel() @ powers

    start = _stored(setup.model, setup.q, setup.v)
    q, v = setup.run(setup.edges(cycles), visit)
    driving, braking, bearings, friction, damping, stiffness = (float(w) for w in work)
    return PowerBalance(
        driving=driving,
        braking=braking,
        stored=_stored(setup.model, q, v) - start,
        bearings=bearings,
        friction=friction,
        mesh_damping=damping,
        mesh_stiffness=stiffness,
    )


def _speeds(model: ExudynModel, v: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Actual speeds of pinion and gear in their running senses [rad/s]."""
    p = model.machine.parameters
    return p[kn.OMEGA_P] - v[..., 2], p[kn.OMEGA_G] + v[..., 5]


def _stored(model: ExudynModel, q: FloatArray, v: FloatArray) -> float:
    m = model.machine
    omega_p, omega_g = _speeds(model, v)
    kinetic = m.mass[0] * (v[0] ** 2 + v[1] ** 2) + m.mass[1] * (v[3] ** 2 + v[4] ** 2)
    kinetic += float(m.inertia[0] * omega_p**2 + m.inertia[1] * omega_g**2)
    elastic = m.bearing_stiffness.ravel() @ q[[0, 1, 3, 4]] ** 2
    return float(0.5 * (kinetic + elastic))


def _powers(model: ExudynModel, t: FloatArray, q: FloatArray, v: FloatArray) -> FloatArray:
    """Driving, braking, bearing, friction, mesh damping and mesh stiffness power at n states, (n, 6) [W]."""
    m = model.machine
    omega_p, omega_g = _speeds(model, v)
    powers = np.zeros((t.size, 6))
    powers[:, 0], powers[:, 1] = m.torque_pinion * omega_p, m.torque_gear * omega_g
    powers[:, 2] = v[:, [0, 1, 3, 4]] ** 2 @ m.bearing_damping.ravel()
    wrench, contacts = np.empty(6), np.empty((2 * MAX_PAIRS, kn.N_RECORD))
    for i in range(t.size):
        count = model.core(
            t[i], q[i], v[i], model.parameters, model.flags, m.table, m.offsets, wrench, contacts
        )
        c = contacts[:count]
        # A contact that does not press stores and dissipates nothing.
        pressed = c[c[:, kn.LOAD] != 0.0]
        damping = float(np.sum(pressed[:, kn.C] * pressed[:, kn.OVERLAP_RATE] ** 2))
        powers[i, 3] = c[:, kn.FRICTION_FORCE] @ c[:, kn.SLIDE]
        powers[i, 4], powers[i, 5] = damping, c[:, kn.LOAD] @ c[:, kn.CLOSING] - damping
    return powers
