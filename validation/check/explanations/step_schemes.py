"""A motion by long steps of a simple scheme: implicit Euler steps damp it, explicit ones take damping away.

With x' = A(t) x + f(t) and a step h from t_n to t_(n+1)

    implicit Euler       x_(n+1) = (I - h A_(n+1))^-1 (x_n + h f_(n+1)),
    explicit Euler       x_(n+1) = x_n + h (A_n x_n + f_n),
    semi-implicit Euler  the new rates by the old state, then the new displacements by the new rates,
    trapezoidal rule     x_(n+1) = (I - h/2 A_(n+1))^-1 (x_n + h/2 (A_n x_n + f_n + f_(n+1))),
    Runge-Kutta          the classical method of fourth order, with A and f in the middle of the step too.

Sources: Hairer and Wanner, Solving Ordinary Differential Equations II, IV.3, for the schemes; the trapezoidal
rule is Newmark's method with gamma 1/2 and beta 1/4; docs/how_to/check_your_model.md, "Explanations".
"""

from __future__ import annotations

from typing import Literal, NamedTuple

import numpy as np
from scipy.signal import resample

from lumped.model.period_closure import BRAKE_TORQUE, MORE_PINION_TORQUE, balanced_start
from lumped.model.periodic_system import LTVSystem
from lumped.model.steady import relative_spectral_radius
from lumped.typing import FloatArray

Scheme = Literal[
    "", "implicit Euler", "explicit Euler", "semi-implicit Euler", "trapezoidal rule", "Runge-Kutta"
]


class Stepped(NamedTuple):
    """The periodic motion by steps of a scheme.

    Attributes
    ----------
    states : (samples, n) at equal times over the mesh cycle, joined by waves between steps
    pinion_torque, brake_torque : [N m]
    spectral_radius : largest modulus of the multipliers, without the rigid rotation
    """

    states: FloatArray
    pinion_torque: float
    brake_torque: float
    spectral_radius: float


def stepped(system: LTVSystem, scheme: Scheme, steps: int, samples: int) -> Stepped:
    """Return the linear periodic motion of the "full" system by steps of a scheme.

    Raises
    ------
    NumericalError : a further multiplier is at +1
    """
    maps, additions = _maps(system, scheme, steps)
    n = system.size
    phi, forced = np.eye(n), np.zeros((n, additions.shape[2]))
    for one, more in zip(maps, additions, strict=True):
        phi, forced = one @ phi, one @ forced + more
    state, weights = balanced_start(system, phi, forced)
    states = np.empty((steps, n))
    for place, (one, more) in enumerate(zip(maps, additions, strict=True)):
        states[place] = state
        state = one @ state + more @ weights
    return Stepped(
        states=np.asarray(resample(states, samples, axis=0), dtype=np.float64),
        pinion_torque=system.pinion_torque + float(weights[MORE_PINION_TORQUE]),
        brake_torque=float(weights[BRAKE_TORQUE]),
        spectral_radius=relative_spectral_radius(system, phi),
    )


def _maps(system: LTVSystem, scheme: Scheme, steps: int) -> tuple[FloatArray, FloatArray]:
    """Maps (steps, n, n) of all steps, and what the three forcings of a linear motion add (steps, n, 3)."""
    h = system.period / steps
    a, forcing = _coefficients(system, h * np.arange(steps, dtype=np.float64))
    unit = np.eye(system.size)
    if scheme == "explicit Euler":
        return np.asarray(unit + h * a, dtype=np.float64), np.asarray(h * forcing)
    if scheme == "semi-implicit Euler":
        m = len(system.coordinates)
        kick = h * a
        kick[:, :m] = 0.0
        drift = unit.copy()
        drift[:m, m:] = h * np.eye(m)
        return np.asarray(drift @ (unit + kick), dtype=np.float64), np.asarray(h * drift @ forcing)
    if scheme == "Runge-Kutta":
        return _runge_kutta(system, h, a, forcing)
    next_a, next_forcing = np.roll(a, -1, axis=0), np.roll(forcing, -1, axis=0)
    if scheme == "implicit Euler":
        inverse = np.linalg.inv(unit - h * next_a)
        return np.asarray(inverse, dtype=np.float64), np.asarray(h * inverse @ next_forcing)
    inverse = np.linalg.inv(unit - 0.5 * h * next_a)
    maps = np.asarray(inverse @ (unit + 0.5 * h * a), dtype=np.float64)
    return maps, np.asarray(0.5 * h * inverse @ (forcing + next_forcing), dtype=np.float64)


def _coefficients(system: LTVSystem, times: FloatArray) -> tuple[FloatArray, FloatArray]:
    """A (k, n, n) at times (k,), and the three forcings of a linear motion (k, n, 3)."""
    torques = np.stack([system.torque_pinion, system.torque_gear], axis=1)
    of_torques = np.broadcast_to(torques, (times.size, *torques.shape))
    forcing = np.concatenate([system.forcing(times)[:, :, None], of_torques], axis=2)
    return system.matrices(times), np.asarray(forcing, dtype=np.float64)


def _runge_kutta(
    system: LTVSystem, h: float, a: FloatArray, forcing: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Maps and additions of the classical method of fourth order: each slope is linear in the state."""
    middle_a, middle = _coefficients(system, h * np.arange(0.5, a.shape[0], dtype=np.float64))
    unit = np.eye(system.size)
    slopes = [(a, forcing)]
    for share, here, force in (
        (0.5, middle_a, middle),
        (0.5, middle_a, middle),
        (1.0, np.roll(a, -1, axis=0), np.roll(forcing, -1, axis=0)),
    ):
        of_state, of_force = slopes[-1]
        slopes.append((here @ (unit + share * h * of_state), here @ (share * h * of_force) + force))
    maps, additions = (
        h / 6.0 * (one + 2.0 * (second + third) + last)
        for one, second, third, last in zip(*slopes, strict=True)
    )
    return np.asarray(unit + maps, dtype=np.float64), np.asarray(additions, dtype=np.float64)
