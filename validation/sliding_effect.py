"""What taking friction at the actual sliding velocity must change, predicted from the lumped motion alone.

The lumped model reads mu at the nominal sliding velocity. Vibration shifts the actual one, which matters most
near the pitch point, where the nominal one vanishes. To first order the motion stays and only the friction
forces change; off the line of action each gear answers them through its own bearing.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import xarray as xr

from lumped import GearPair, geometry, mesh_elements
from lumped.equations import structure
from validation.metrics import FloatArray


@dataclass(frozen=True, eq=False)
class SlidingEffect:
    """Predicted changes over the mesh cycle, to be added to the lumped motion; empty without friction.

    Attributes
    ----------
    changes : ``friction_force`` (pairs, k) [N], ``y_p`` and ``y_g`` (k,) [m], at the times of the motion
    """

    changes: Mapping[str, FloatArray]

    def over(self, quantity: str, length: int) -> FloatArray | float:
        """Change of a quantity over whole cycles cut to ``length`` times; 0 where none is predicted."""
        if quantity not in self.changes:
            return 0.0
        change = self.changes[quantity]
        return np.resize(np.moveaxis(change, -1, 0), (length, *change.shape[:-1])).T


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
        return SlidingEffect({})
    velocity = cycle["sliding_velocity"].to_numpy()
    # The law is known as mu(xi), and xi - L_XP = v_s / (Omega_p + Omega_g) at nominal rotation.
    equivalent = np.clip(g.L_XP + velocity / (g.omega_pinion + g.omega_gear), g.L_XA, g.L_XD)
    actual = np.sign(velocity) * np.abs(friction(equivalent)) * cycle["normal_load"].to_numpy()
    time = cycle["time"].to_numpy()
    change = actual - nominal
    y_p, y_g = _oloa_response(pair, change.sum(axis=0), time)
    return SlidingEffect({"friction_force": change, "y_p": y_p, "y_g": y_g})


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
