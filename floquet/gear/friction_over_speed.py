"""How friction changes with speed: over which speeds one block with factors on its friction will do."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from floquet.gear.axes import GearVariation, operating_rpm
from lumped.friction.base import PITCH_RESOLUTION, ContactPath, mean_coefficient
from lumped.friction.registry import law_named
from lumped.path_of_contact.friction import contact_path, fit_law
from lumped.schema.pair import GearPair
from lumped.typing import FloatArray

_POSITIONS = 8
# Agreement along the path, relative to mu: rounding of the laws, far below the 1e-10 to which mu is fitted.
_SAME = 1e-12


@dataclass(frozen=True, eq=False)
class FrictionFamily:
    """Speeds at which mu is a weighted sum of two functions of the position.

    Attributes
    ----------
    speed_rpm : the speed whose friction law is the reference
    members : (k,) indices of the speeds
    level : |mu| of the second function, which only changes sign at the pitch point; None where one is enough
    factors : (k, 1) of mu at the reference speed; or (k, 2) of mu less the level, and of the level
    law : the law at other speeds; None where it is the same at all
    """

    speed_rpm: float
    members: npt.NDArray[np.intp]
    level: float | None
    factors: FloatArray
    law: _Law | None

    def factors_at(self, speeds_rpm: FloatArray) -> FloatArray | None:
        """Factors (k, 1 or 2) at further speeds; None where these are not all of the family."""
        if self.law is None:
            return np.ones((speeds_rpm.size, 1))
        members, weights = self.law.weights(self.speed_rpm, speeds_rpm)
        if members.size < speeds_rpm.size or (self.level is None and weights[:, 1].any()):
            return None
        return self.law.factors(self.speed_rpm, self.level is not None, weights)


def depends_on_speed(pair: GearPair) -> bool:
    """Say whether mu(xi) changes with speed: every law but a constant one whose coefficient is given."""
    return not law_named(pair.friction.law).is_constant(pair.friction)


def friction_families(variation: GearVariation, speeds_rpm: FloatArray) -> list[FrictionFamily]:
    """Group speeds over which friction needs but one fit.

    Law III goes with a power of speed, I and IV with their mean coefficient, and law II, a logarithm, rises
    and falls as a whole. Law V is each of these as long as its regimes do not move. None of this is taken for
    granted: the law is evaluated along the path at every speed, and its switches are compared.

    Parameters
    ----------
    variation : the pair as a chart varies it
    speeds_rpm : (k,) pinion speeds, all different
    """
    pair = variation.pair
    rest = np.arange(speeds_rpm.size)
    if not depends_on_speed(pair):
        return [FrictionFamily(operating_rpm(pair), rest, None, np.ones((rest.size, 1)), None)]
    law = _Law(variation)
    families = []
    while rest.size:
        reference = float(speeds_rpm[rest[rest.size // 2]])
        members, weights = law.weights(reference, speeds_rpm[rest])
        apart = bool(weights[:, 1].any())
        level = (variation.friction_mean or law.mean(reference)) if apart else None
        factors = law.factors(reference, apart, weights)
        families.append(FrictionFamily(reference, rest[members], level, factors, law))
        rest = np.delete(rest, members)
    return families


class _Law:
    """The friction law of a pair at other speeds than its own."""

    def __init__(self, variation: GearVariation) -> None:
        pair = variation.pair
        self.law = law_named(pair.friction.law)
        self.path, self.settings = contact_path(pair), pair.friction
        self.to_mean = variation.friction_mean is not None
        self.positions = _positions(self.path)
        self.known: dict[float, tuple[FloatArray, list[float]]] = {}

    def at(self, rpm: float) -> ContactPath:
        ratio = self.path.omega_gear / self.path.omega_pinion
        omega = rpm * np.pi / 30.0
        return replace(self.path, omega_pinion=omega, omega_gear=omega * ratio)

    def values(self, rpm: float) -> tuple[FloatArray, list[float]]:
        """Mu at the positions, and the positions of its switches, at a speed."""
        if rpm not in self.known:
            there = self.at(rpm)
            mu = self.law.signed(self.positions, there, self.settings)
            self.known[rpm] = mu, self.law.switches(there, self.settings)
        return self.known[rpm]

    def weights(self, reference: float, speeds_rpm: FloatArray) -> tuple[npt.NDArray[np.intp], FloatArray]:
        """Speeds (k,) at which mu = a mu_reference + b sign(xi - L_XP), and a, b there, (k, 2)."""
        mu, switches = self.values(reference)
        sign = np.sign(self.positions - self.path.L_XP)
        basis = np.stack([mu, sign], axis=1)
        members, found = [], []
        for i, rpm in enumerate(speeds_rpm):
            now, others = self.values(float(rpm))
            one = np.array([now @ mu / (mu @ mu) if mu.any() else 1.0, 0.0])
            for pair in (one, np.linalg.lstsq(basis, now, rcond=None)[0]):
                if np.abs(basis @ pair - now).max() <= _SAME * np.abs(now).max():
                    if _alike(switches, others, self.path):
                        members.append(i)
                        found.append(pair)
                    break
        return np.array(members, dtype=np.intp), np.array(found)

    def factors(self, reference: float, apart: bool, weights: FloatArray) -> FloatArray:
        """Factors of mu, or of mu less its mean and of the mean, from the weights of mu and of the sign.

        mu = a mu_0 + b sign = a (mu_0 - mean sign) + (a + b/mean) (mean sign)
        """
        a, b = weights.T
        if self.to_mean:  # the law is scaled to one mean, whatever the speed
            mean = self.mean(reference)
            a, b = weights.T * (mean / (a * mean + b))
        return np.stack([a, a + b / self.mean(reference)], axis=1) if apart else a[:, None]

    def mean(self, reference: float) -> float:
        """Mean of |mu| over the path."""
        return mean_coefficient(fit_law(self.at(reference), self.settings, self.law.name))


def _positions(path: ContactPath) -> FloatArray:
    """Positions on either side of P, from where laws are held constant to the ends of the path."""
    sides = []
    for reach in (path.L_XA - path.L_XP, path.L_XD - path.L_XP):
        near = np.geomspace(math.copysign(0.5 * PITCH_RESOLUTION, reach), 0.1 * reach, _POSITIONS)
        sides += [near, np.linspace(0.1 * reach, reach, _POSITIONS + 2)[1:-1]]
    return path.L_XP + np.concatenate(sides)


def _alike(one: list[float], other: list[float], path: ContactPath) -> bool:
    return len(one) == len(other) and bool(
        np.allclose(sorted(one), sorted(other), rtol=0.0, atol=_SAME * path.L_XY)
    )
