"""Periodic motion and stability as the multibody model sees them: perturbed states over one mesh cycle.

The 12-state map has a double multiplier +1, the rigid rotation of the free gear train. The verdict is taken
on the 10 states of the relative form (q, x_p, x_g, y_p, y_g and rates, q = r_bp theta_p - r_bg theta_g):
the rotations are perturbed with the rigid rotation J_p theta_p/r_bp + J_g theta_g/r_bg held fixed, and q is
read off.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from lumped.errors import NumericalError
from lumped.parameters import GearPair
from multibody import kernels as kn
from multibody.machine import Machine
from multibody.model import build
from multibody.records import from_lumped_state, to_lumped_state
from multibody.setup import CALL_LIMIT, Fidelity, Setup, prepare

FloatArray = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]

#: Perturbation over the static deflection: large for the linear level, where size does not matter; at the
#: exact level central differences err by its square times the nonlinearity, and by rtol over it.
_STEP = {"linear": 1.0, "exact": 1e-3}
_CLOSED = 1e-8


@dataclass(frozen=True, eq=False)
class FlowMap:
    """Periodic motion and its linearised map over one mesh cycle.

    Attributes
    ----------
    matrix : (10, 10) map of (q, x_p, x_g, y_p, y_g and rates)
    full : (12, 12) map of the lumped states (theta_p, theta_g, x_p, x_g, y_p, y_g and rates)
    state : (12,) state of the motion at t = 0 about which the map is taken
    brake_torque : torque that balances that motion [N m]
    closure : largest change of the state over one cycle, relative to its scale
    read, lift : (10, 12) reads the relative states off the lumped ones; (12, 10) perturbs the lumped states
        by relative ones, with the rigid rotation held fixed
    """

    matrix: FloatArray
    full: FloatArray
    read: FloatArray
    lift: FloatArray
    state: FloatArray
    brake_torque: float
    closure: float

    @property
    def multipliers(self) -> ComplexArray:
        """Characteristic multipliers of the relative form, largest modulus first."""
        values = np.linalg.eigvals(self.matrix).astype(np.complex128)
        return values[np.argsort(-np.abs(values), kind="stable")]

    @property
    def spectral_radius(self) -> float:
        """Largest modulus of a multiplier: above 1 the motion is unstable."""
        return float(np.abs(self.multipliers[0]))


def monodromy(
    pair: GearPair,
    *,
    fidelity: Fidelity = "exact",
    effects: Collection[str] | Mapping[str, bool] | None = None,
    rtol: float = 1e-10,
    friction_velocity: float | None = None,
    iterations: int = 3,
) -> FlowMap:
    """Monodromy matrix by perturbed runs over one mesh cycle, about the model's own periodic motion.

    Parameters
    ----------
    pair : a validated gear pair
    fidelity, effects, rtol, friction_velocity : as ``multibody.simulate``
    iterations : most Newton steps from the lumped periodic motion to the multibody one, with the brake
        torque as unknown; 0 takes the map about the lumped motion

    Raises
    ------
    NumericalError : no periodic motion is found near the lumped one
    """
    setup = prepare(
        pair,
        fidelity=fidelity,
        initial="periodic",
        effects=effects,
        rtol=rtol,
        friction_velocity=friction_velocity,
    )
    scale = _scale(setup)
    state, machine = to_lumped_state(setup.q, setup.v), setup.machine
    flow = _Flow(setup, machine)
    full, closure = np.empty((12, 12)), np.inf
    for remaining in range(iterations, -1, -1):
        end = flow(state)
        closure = float(np.abs((end - state) / scale).max())
        full = _differences(flow, state, scale * _STEP[fidelity])
        if closure < _CLOSED or remaining == 0:
            break
        by_torque = _by_torque(setup, machine, state)
        state, torque = _newton(full, by_torque, state, end, machine, scale)
        machine = replace(machine, torque_gear=machine.torque_gear + torque)
        flow = _Flow(setup, machine)
    if iterations > 0 and closure > 1e-4:
        raise NumericalError(
            f"No periodic multibody motion near the lumped one (mismatch {closure:.1e}): the pair may "
            "separate or sit on a stability boundary. Change the speed or the torque, or use iterations=0."
        )
    read, lift = _relative(machine)
    return FlowMap(read @ full @ lift, full, read, lift, state, machine.torque_gear, closure)


class _Flow:
    """State (12,) -> state after one mesh cycle."""

    def __init__(self, setup: Setup, machine: Machine) -> None:
        model = build(machine, setup.fidelity, setup.model.flags, CALL_LIMIT)
        self.setup = replace(setup, model=model)
        self.edges = setup.edges(1)

    def __call__(self, state: FloatArray) -> FloatArray:
        q, v = from_lumped_state(state)
        return to_lumped_state(*replace(self.setup, q=q, v=v).run(self.edges, lambda *_: None))


def _scale(setup: Setup) -> FloatArray:
    """Sizes of the 12 states in a vibration: static deflection, and that over the mesh cycle times 2 pi."""
    p = setup.machine.parameters
    length = setup.atol / setup.rtol * setup.machine.period * 100.0
    lengths = length * np.array([1 / p[kn.RADIUS_P], 1 / p[kn.RADIUS_G], 1, 1, 1, 1])
    return np.concatenate([lengths, lengths * 2 * np.pi / setup.machine.period])


def _differences(flow: _Flow, state: FloatArray, steps: FloatArray) -> FloatArray:
    columns = []
    for i, h in enumerate(steps):
        ahead, behind = state.copy(), state.copy()
        ahead[i] += h
        behind[i] -= h
        columns.append((flow(ahead) - flow(behind)) / (2.0 * h))
    return np.stack(columns, axis=1)


def _by_torque(setup: Setup, machine: Machine, state: FloatArray) -> FloatArray:
    """Derivative of the state after one cycle by the brake torque (12,)."""
    h = 1e-3 * machine.torque_gear
    ends = [
        _Flow(setup, replace(machine, torque_gear=machine.torque_gear + s * h))(state) for s in (1.0, -1.0)
    ]
    return np.asarray((ends[0] - ends[1]) / (2.0 * h))


def _newton(
    full: FloatArray,
    by_torque: FloatArray,
    state: FloatArray,
    end: FloatArray,
    machine: Machine,
    scale: FloatArray,
) -> tuple[FloatArray, float]:
    """One step of the bordered Newton iteration: closes the cycle, the rigid rotation held."""
    p = machine.parameters
    matrix = np.zeros((13, 13))
    matrix[:12, :12] = (np.eye(12) - full) * scale / scale[:, None]
    matrix[:12, 12] = -by_torque * machine.torque_gear / scale
    rigid = machine.inertia / np.array([p[kn.RADIUS_P], p[kn.RADIUS_G]])
    matrix[12, :2] = rigid * scale[:2] / (rigid * scale[:2]).max()
    step = np.linalg.solve(matrix, np.append((end - state) / scale, 0.0))
    return state + step[:12] * scale, float(step[12] * machine.torque_gear)


def _relative(machine: Machine) -> tuple[FloatArray, FloatArray]:
    """Matrices (10, 12) that reads the relative states off, and (12, 10) that perturbs them."""
    p = machine.parameters
    radii = np.array([p[kn.RADIUS_P], -p[kn.RADIUS_G]])
    by_inertia = radii / machine.inertia
    down, up = np.zeros((5, 6)), np.zeros((6, 5))
    down[0, :2] = radii
    up[:2, 0] = by_inertia / (radii @ by_inertia)
    down[1:, 2:] = up[2:, 1:] = np.eye(4)
    two = np.eye(2)
    return np.asarray(np.kron(two, down), dtype=float), np.asarray(np.kron(two, up), dtype=float)
