"""What taking friction at the actual sliding velocity must change, predicted from the lumped motion alone.

The lumped model reads mu at the nominal sliding velocity. Vibration shifts the actual one, which matters most
near the pitch point, where the nominal one vanishes. To first order the motion stays and only the friction
forces change; off the line of action each gear answers them through its own bearing.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import xarray as xr

from lumped import GearPair, geometry, mesh_elements
from lumped.equations import structure
from validation.metrics import FloatArray, relative_l2


@dataclass(frozen=True)
class SlidingEffect:
    """Predicted relative L2 differences; zero where there is no friction.

    Attributes
    ----------
    friction_force : of the friction forces of the tooth pairs
    y_p, y_g : of the motions off the line of action
    """

    friction_force: float = 0.0
    y_p: float = 0.0
    y_g: float = 0.0


def sliding_effect(pair: GearPair, cycle: xr.Dataset) -> SlidingEffect:
    """Predict the first-order effect of the actual sliding velocity.

    Parameters
    ----------
    pair : a validated gear pair
    cycle : lumped periodic motion at even times over whole mesh cycles, the end left out

    Returns
    -------
    SlidingEffect
    """
    g, friction = geometry(pair), mesh_elements(pair).friction
    nominal = cycle["friction_force"].to_numpy()
    if not nominal.any():
        return SlidingEffect()
    velocity = cycle["sliding_velocity"].to_numpy()
    # The law is known as mu(xi), and xi - L_XP = v_s / (Omega_p + Omega_g) at nominal rotation.
    equivalent = np.clip(g.L_XP + velocity / (g.omega_pinion + g.omega_gear), g.L_XA, g.L_XD)
    actual = np.sign(velocity) * np.abs(friction(equivalent)) * cycle["normal_load"].to_numpy()
    time = cycle["time"].to_numpy()
    y = _oloa_response(pair, nominal.sum(axis=0), time)
    y_actual = _oloa_response(pair, actual.sum(axis=0), time)
    return SlidingEffect(
        friction_force=relative_l2(actual, nominal),
        y_p=relative_l2(y_actual[0], y[0]),
        y_g=relative_l2(y_actual[1], y[1]),
    )


def _oloa_response(pair: GearPair, force: FloatArray, time: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Periodic y_p and y_g under a periodic friction force, by the receptances of eqs. 8 and 9 [m]."""
    s = structure(pair)
    omega = 2.0 * np.pi * np.fft.rfftfreq(time.size, float(time[1] - time[0]))
    spectrum = np.fft.rfft(force)
    p, g = (
        np.fft.irfft(
            sign * spectrum / (s.stiffness[j] + 1j * omega * s.damping[j] - omega**2 * s.mass[j]), time.size
        )
        for j, sign in ((4, 1.0), (5, -1.0))
    )
    return p, g
