"""Powers of a multibody motion at instants, and the work of a step: where the driving work goes.

The powers are computed from contact records (loads, sliding and closing velocities), not from the forces that
moved the bodies. So a wrong wrench, sign or lever shows in the power balance.

Sources: docs/theory/multibody.md, "Overlap, wrench and contact point"; the power balance of rigid bodies.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from lumped.typing import FloatArray
from multibody.contact.kinematics import PATH_WORK
from multibody.contact.machine import Machine
from multibody.contact.records import PHI_G, PHI_P, X_G, X_P, Y_G, Y_P
from multibody.run.integration import Segment
from multibody.run.model import ExudynModel, contact_state

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(4)


class Powers(NamedTuple):
    """Powers at n instants (n,) [W], or their integrals over time [J], or their means [W].

    Attributes
    ----------
    driving, braking : of the driving torque, and taken by the brake
    sliding : taken by sliding friction between the teeth
    tooth_dampers : taken by the damping of the teeth
    bearings : taken by the dampers of the bearings
    shafts : taken by the damping of the shafts and couplings
    energy_residual : power on the teeth that goes into no energy, because the contact force has no part along
        the path of contact; zero with the effect ``path_work``
    """

    driving: FloatArray
    braking: FloatArray
    sliding: FloatArray
    tooth_dampers: FloatArray
    bearings: FloatArray
    shafts: FloatArray
    energy_residual: FloatArray

    @property
    def lost(self) -> FloatArray:
        """All losses together."""
        return self.sliding + self.tooth_dampers + self.bearings + self.shafts


def rotor_speeds(machine: Machine, v: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Actual speeds [rad/s] of the driving and the braked rotor in their running senses, rates (n, size)."""
    rolling = machine.record.rolling
    turning = v[..., [PHI_P, PHI_G]] if machine.train is None else v @ machine.train.torques.T
    return rolling.omega_p - turning[..., 0], rolling.omega_g + turning[..., 1]


def powers(model: ExudynModel, t: FloatArray, q: FloatArray, v: FloatArray) -> Powers:
    """Powers at n states: times (n,) [s], coordinates and rates (n, size)."""
    machine = model.machine
    none = np.zeros(t.size)
    torques = machine.torques(t, q)
    driven, braked = rotor_speeds(machine, v)
    bearings, shafts = _support_powers(machine, v)
    states = contact_state(model, t, q, v)
    contacts = states.contacts
    contacts[np.arange(contacts.shape[1]) >= states.counts[:, None]] = 0.0
    by_dampers = (contacts["load"] - contacts["elastic_load"]) * contacts["compression_rate"]
    along_path = (contacts["path_force"] * contacts["path_rate"]).sum(axis=1)
    return Powers(
        driving=torques[:, 0] * driven,
        braking=torques[:, 1] * braked,
        sliding=(contacts["friction_force"] * contacts["sliding_velocity"]).sum(axis=1),
        tooth_dampers=by_dampers.sum(axis=1),
        bearings=bearings,
        shafts=shafts,
        energy_residual=none if model.flags & PATH_WORK else along_path,
    )


def _support_powers(machine: Machine, v: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Power that the dampers of the bearings take, and the dampers of shafts and couplings, (n,) each [W]."""
    train = machine.train
    if train is None:
        return v[:, [X_P, Y_P, X_G, Y_G]] ** 2 @ machine.bearing_damping.ravel(), np.zeros(len(v))
    damping = np.concatenate([shaft.bearing_damping for shaft in train.shafts])
    bearings = np.einsum("kd,kdn->n", damping, (train.bearings @ v.T) ** 2)
    # Gyroscopic terms, which are antisymmetric, take no power.
    return bearings, np.einsum("ni,ij,nj->n", v, train.damping, v) - bearings


def work(model: ExudynModel, segment: Segment) -> Powers:
    """Integrals of the powers over a segment [J], by four-point Gauss quadrature in each of its steps."""
    steps = np.diff(segment.times)[:, None]
    t = (segment.times[:-1, None] + 0.5 * steps * (1.0 + _NODES)).ravel()
    weights = (0.5 * steps * _WEIGHTS).ravel()
    return Powers(*(weights @ power for power in powers(model, t, *segment.at(t))))
