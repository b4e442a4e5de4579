"""How friction changes with speed: where it is only a factor, a chart over speed needs but one block."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from floquet.gear_axes import GearVariation
from floquet.system import FloatArray
from lumped.friction.along_path import contact_path, friction_settings
from lumped.friction.base import ContactPath
from lumped.friction.registry import law_named
from lumped.parameters import GearPair

_POSITIONS = 9
# Agreement of the factor along the path: rounding of the laws, far below the 1e-10 to which mu is fitted.
_SAME = 1e-12


def depends_on_speed(pair: GearPair) -> bool:
    """Say whether mu(xi) changes with speed: every law but a constant one whose coefficient is given."""
    friction = pair.friction
    nominal = friction.law in ("coulomb", "smoothed_coulomb") and friction.coefficient is not None
    return not (friction.law == "none" or nominal)


def friction_factors(variation: GearVariation, speeds_rpm: FloatArray) -> FloatArray | None:
    """Mu at these speeds over mu at the speed of the pair, or None where that is no single factor.

    Law III goes with a power of speed, I and IV with their mean coefficient; II and V have switches that
    move. None of this is taken for granted: the law is evaluated along the path at every speed.

    Parameters
    ----------
    variation : the pair at its own speed, as a chart varies it
    speeds_rpm : (k,) pinion speeds
    """
    pair = variation.pair
    if not depends_on_speed(pair):
        return np.ones(speeds_rpm.size)
    law = law_named(pair.friction.law)
    path, settings = contact_path(pair), friction_settings(pair)
    xi = np.linspace(path.L_XA, path.L_XD, _POSITIONS + 2)[1:-1]
    own = law.signed(xi, path, settings)
    xi, own = xi[own != 0.0], own[own != 0.0]
    switches = law.switches(path, settings)
    factors = np.empty(speeds_rpm.size)
    for i, rpm in enumerate(speeds_rpm):
        there = _at_speed(path, rpm * np.pi / 30.0)
        ratio = law.signed(xi, there, settings) / own
        if np.ptp(ratio) > _SAME * abs(ratio[0]) or not _alike(switches, law.switches(there, settings), path):
            return None
        factors[i] = ratio[0]
    # Scaled to a given mean, a law that keeps its shape does not change at all.
    return np.ones_like(factors) if variation.friction_mean is not None else factors


def _at_speed(path: ContactPath, omega: float) -> ContactPath:
    ratio = path.omega_gear / path.omega_pinion
    return replace(path, omega_pinion=omega, omega_gear=omega * ratio)


def _alike(one: list[float], other: list[float], path: ContactPath) -> bool:
    return len(one) == len(other) and bool(
        np.allclose(sorted(one), sorted(other), rtol=0.0, atol=_SAME * path.L_XY)
    )
