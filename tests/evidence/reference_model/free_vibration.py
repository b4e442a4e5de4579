"""Damping of the multibody model by what it does: free vibration that decays.

The mesh is frozen in the middle of the path of contact, without friction and torque. Bodies that are too
heavy to move leave the rotation of the teeth on each other; a mesh without stiffness leaves each body on its
bearings. The logarithmic decrement of each motion must be that of the damping ratio in the schema.

Sources: the decrement of consecutive samples, R. de Prony 1795; docs/theory/multibody.md, "What is own and
what is shared".
"""

from dataclasses import dataclass, replace

import numpy as np

from lumped.schema.pair import GearPair
from lumped.typing import FloatArray
from multibody.contact import friction as fr
from multibody.contact import layout as kn
from multibody.contact.elements import stiffness_at
from multibody.contact.machine import Machine, machine
from multibody.run.integration import Segment, integrate
from multibody.run.model import build

#: Bodies of this many times their mass do not move in a few swings of the teeth.
_HEAVY = 1e12
#: Initial amplitude [m]; the system is linear. Samples per run, and length of the run over a period.
_AMPLITUDE, _SAMPLES, _PERIODS = 1e-6, 64, 2.0
_RTOL = 1e-11


@dataclass(frozen=True)
class Decay:
    """One free vibration.

    ``motion`` is "mesh", or "pinion x" to "gear y": a body on its bearing along (x) and off (y) the line of
    action; ``measured`` and ``given`` are damping ratios, of a mesh with several pairs that of their sum.
    """

    motion: str
    frequency: float
    measured: float
    given: float


def damping_check(pair: GearPair) -> tuple[Decay, ...]:
    """Measure the damping ratios of the mesh and of the four bearing directions by free decay."""
    numbers = _frozen(machine(pair))
    p = numbers.parameters
    fixed = replace(numbers, mass=_HEAVY * numbers.mass)
    q = np.zeros(6)
    q[2], q[5] = -_AMPLITUDE / p[kn.RADIUS_P], 0.0
    places = _in_contact(numbers)
    k = np.array([max(stiffness_at(numbers.table, xi), 0.0) for xi in places])
    share = float(np.sum(np.sqrt(k)) / np.sqrt(np.sum(k)))  # of pairs side by side, each with its own ratio
    mobility = p[kn.RADIUS_P] ** 2 / numbers.inertia[0] + p[kn.RADIUS_G] ** 2 / numbers.inertia[1]
    omega, ratio = np.sqrt(k.sum() * mobility), pair.mesh.damping_ratio * share
    found = [_decay("mesh", fixed, q, omega, ratio, numbers.overlap)]
    free = replace(numbers, table=np.column_stack([numbers.table[:, :2], 0.0 * numbers.table[:, 2:]]))
    for i, (name, bearing) in enumerate((("pinion", pair.bearings.pinion), ("gear", pair.bearings.gear))):
        ratios = (bearing.loa_damping_ratio, bearing.oloa_damping_ratio)
        for j, axis in enumerate("xy"):
            q, read = np.zeros(6), np.zeros(6)
            q[3 * i + j], read[3 * i + j] = _AMPLITUDE, 1.0
            omega = np.sqrt(free.bearing_stiffness[i, j] / free.mass[i])
            found.append(_decay(f"{name} {axis}", free, q, omega, ratios[j], read))
    return tuple(found)


def _frozen(numbers: Machine) -> Machine:
    """The machine without friction and torque, held where a pair is in the middle of its path."""
    p = numbers.parameters.copy()
    single = 0.5 * (p[kn.L_XA] + p[kn.L_XD])
    time = np.mod(single - p[kn.L_XA], p[kn.PITCH]) / (p[kn.OMEGA_P] * p[kn.RADIUS_P])
    p[kn.T_LOW] = p[kn.T_HIGH] = time
    p[kn.FRICTION + fr.LAW] = fr.LAWS["none"]
    p[kn.RELIEFS] = 0.0
    return replace(numbers, parameters=p, torque_pinion=0.0, torque_gear=0.0)


def _in_contact(numbers: Machine) -> FloatArray:
    p = numbers.parameters
    first = p[kn.L_XA] + p[kn.T_LOW] * p[kn.OMEGA_P] * p[kn.RADIUS_P]
    return np.arange(first, p[kn.L_XD], p[kn.PITCH])


def _decay(
    motion: str, numbers: Machine, q: FloatArray, omega: float, given: float, read: FloatArray
) -> Decay:
    """Run from rest at q and fit the motion that ``read`` sees; omega sets how long."""
    times = np.linspace(0.0, _PERIODS * 2.0 * np.pi / omega, _SAMPLES + 1)
    seen: list[FloatArray] = []

    def visit(_number: int, segment: Segment) -> None:
        seen.append(segment.at(times)[0] @ read)

    # Bilateral teeth that do not move along their path: no effect acts, and the phase is held.
    model = build(numbers, 0, 1_000_000)
    edges = times[[0, -1]]
    integrate(model, q, np.zeros(6), edges, rtol=_RTOL, atol=1e-18, clamp=False, visit=visit)
    x = seen[0]
    step = times[1] - times[0]
    # x(n + 2) = s x(n + 1) - p x(n) for every damped oscillator; p is the decrement over one step, squared.
    rows, right = np.column_stack([x[1:-1], -x[:-2]]), x[2:]
    trace, product = np.linalg.lstsq(rows, right, rcond=None)[0]
    roots = np.log(np.roots([1.0, -trace, product]).astype(complex)) / step
    size = float(np.sqrt(np.real(roots[0] * roots[1])))
    return Decay(motion, size / (2.0 * np.pi), float(-np.real(roots.sum()) / (2.0 * size)), given)
