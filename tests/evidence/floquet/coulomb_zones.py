"""A gear pair with one degree of freedom and Coulomb friction: the damped Meissner equation in closed form.

Vaishya and Singh (J. Sound Vib. 243 (2001) 525-545) write the gear pair on rigid bearings as one equation
for the dynamic transmission error, whose coefficients are constant between the events of the cycle, and solve
it by state transition matrices piece by piece. This module states that problem for unity ratio and equal
inertias, where it is exact: with 1/m_e = r^2/J_p + r^2/J_g = 2 r^2/J and moment arms X_p + X_g = L_XY,

    m_e delta'' + sum_i (1 + s_i mu tan alpha) (c_i delta' + k_i delta) = T_p/r_b ,

because the friction force s_i mu N_i acts with the arm m_e (r X_p/J + r X_g/J) = L_XY/(2 r) = tan alpha, the
same at every point of contact. Friction multiplies each pair's stiffness and damping by 1 + s_i mu tan alpha,
s_i = -1 in approach and +1 in recess. In double contact with one pair on either side of the pitch point the
two cancel. Lengths of time are in parts of the mesh cycle, frequencies in units of omega.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise
from typing import Literal

import numpy as np
import numpy.typing as npt

from floquet import PeriodicSystem, gear_pair_multipliers, monodromy
from floquet.engine.system import second_order
from lumped import GearPair, load_gear_pair
from lumped.model.periodic_system import periodic_system
from lumped.schema.bodies import bodies
from lumped.typing import ComplexArray, FloatArray
from tests.evidence.check import Check, order

FrictionSign = Literal["reversing", "constant"]
MU = 0.2
_RATIOS = np.linspace(0.2, 3.0, 57)


@dataclass(frozen=True)
class CoulombGearPair:
    """One-degree-of-freedom gear pair of unity ratio with pairs of constant stiffness."""

    contact_ratio: float = 1.638  # 1 <= sigma <= 2
    damping_ratio: float = 0.05  # zeta of the mean mesh, c_i = zeta k_i 2/omega
    friction: float = 0.0  # mu >= 0
    pressure_angle: float = np.deg2rad(20.0)  # operating pressure angle alpha [rad]
    sign: FrictionSign = "reversing"  # "reversing", the friction force turns round at the pitch point

    @property
    def phases(self) -> FloatArray:
        """Events of the cycle as its parts: a pair enters, the older one leaves, the pitch point, the end.

        The pitch point halves the path of contact (equal gears), so it is passed at sigma/2 of the cycle, in
        single contact.
        """
        return np.array([0.0, self.contact_ratio - 1.0, 0.5 * self.contact_ratio, 1.0])

    @property
    def gains(self) -> FloatArray:
        """Total mesh stiffness in each of the three pieces over its mean without friction, (3,).

        First piece: a pair in approach and a pair in recess. Second: a pair in approach. Third: a pair in
        recess.
        """
        m = self.friction * float(np.tan(self.pressure_angle))
        approach, recess = (1.0 - m, 1.0 + m) if self.sign == "reversing" else (1.0 + m, 1.0 + m)
        return np.array([approach + recess, approach, recess]) / self.contact_ratio

    def system(self, speed_ratio: float) -> PeriodicSystem:
        """Return the pair for the general engine, states (delta, delta') with time in 1/omega."""
        period = 2.0 * np.pi / speed_ratio
        phases = self.phases
        gains = self.gains
        zeta = self.damping_ratio

        def A(t: FloatArray) -> FloatArray:
            g = gains[np.clip(np.searchsorted(phases, t / period, side="right") - 1, 0, 2), None, None]
            return second_order(g, 2.0 * zeta * g)

        return PeriodicSystem(A, period, tuple(phases[1:-1] * period), vectorized=True)

    def transition(self, speed_ratio: npt.ArrayLike, piece: int) -> FloatArray:
        """State transition matrix over one piece of the cycle in closed form, (...,) -> (..., 2, 2).

        x'' + 2 a x' + g x = 0 over h: exp(-a h) times the matrix of cos, sin(w h)/w with w^2 = g - a^2, which
        stays valid for the overdamped and the critical case with complex w.
        """
        h = np.diff(self.phases)[piece] * 2.0 * np.pi / np.asarray(speed_ratio, dtype=float)
        g = self.gains[piece]
        a = self.damping_ratio * g
        w = np.sqrt(complex(g - a * a))
        cosine = np.cos(w * h).real
        sine = (h * np.sinc(w * h / np.pi)).real  # sin(w h)/w without a division by zero
        rows = [[cosine + a * sine, sine], [-g * sine, cosine - a * sine]]
        return np.asarray(np.exp(-a * h)[..., None, None] * np.moveaxis(np.array(rows), (0, 1), (-2, -1)))

    def monodromy_matrix(self, speed_ratio: npt.ArrayLike) -> FloatArray:
        """Product of the three transition matrices, the first piece acting first; (...,) -> (..., 2, 2)."""
        first, second, third = (self.transition(speed_ratio, piece) for piece in range(3))
        return np.asarray(third @ second @ first)

    def multipliers(self, speed_ratio: npt.ArrayLike) -> ComplexArray:
        """Both multipliers, the larger modulus first, (...,) -> (..., 2).

        lambda^2 - tr M lambda + det M = 0 with det M = exp(-integral of 2 zeta g) (Liouville) exactly.
        """
        ratio = np.asarray(speed_ratio, dtype=float)
        M = self.monodromy_matrix(ratio)
        half = 0.5 * np.trace(M, axis1=-2, axis2=-1)
        decay = 2.0 * self.damping_ratio * float(self.gains @ np.diff(self.phases)) * 2.0 * np.pi / ratio
        determinant = np.exp(-decay)
        root = np.sqrt((half**2 - determinant).astype(complex))
        large = half + np.where(half < 0.0, -1.0, 1.0) * root
        return np.stack([large, determinant / large], axis=-1)


def check_coulomb_gear_pair() -> Iterator[Check]:
    """Closed form against engine and gear; what friction of either kind can and cannot change."""
    yield Check("gear pair with Coulomb friction", "M in closed form", _transition(), 1e-10)
    exact = "a pair's gain over the cycle, 28/28 with J_p = J_g"
    yield Check("1 ± μ tan α in the equations of motion", exact, _factor(), 1e-12)
    soft, stiff = (_on_bearings(factor) for factor in (1e4, 4e4))
    yield Check("rigid bearings", "multipliers in closed form, bearings 40000 times k", stiff, 2e-3)
    observed = np.log2(soft / stiff) / 2.0
    yield order("rigid bearings: in the mesh stiffness over that of the bearings", observed, 1.0, 0.1)
    exact = "|multiplier| of the frictionless pair at speed/√f, damping ζ√f, f = 1 + μ tan α"
    yield Check("friction of one sign", exact, _rescaled(), 1e-9)
    wet = CoulombGearPair(friction=MU)
    dry = CoulombGearPair()
    decay = np.linalg.det(wet.monodromy_matrix(_RATIOS)) / np.linalg.det(dry.monodromy_matrix(_RATIOS))
    worst = np.abs(decay - 1.0).max()
    yield Check("friction that reverses: decay", "det M without friction", worst, 1e-12)
    full, half = (np.abs(_trace(mu) - _trace(0.0)).max() for mu in (MU, MU / 2))
    yield order("friction that reverses: growth in μ", np.log2(full / half), 2.0, 0.05)


def _transition() -> float:
    worst = 0.0
    for sign in ("reversing", "constant"):
        for damping in (0.0, 0.05, 0.9, 1.6):  # overdamped in some or all pieces
            pair = CoulombGearPair(damping_ratio=damping, friction=MU, sign=sign)
            for ratio in (0.13, 0.7, 1.9):
                M = monodromy(pair.system(ratio), 1e-11).matrix
                worst = max(worst, float(np.abs(M - pair.monodromy_matrix(ratio)).max()))
    return worst


def _gear() -> GearPair:
    return load_gear_pair("nasa_28_28").with_(
        {
            "friction.law": "coulomb", "friction.coefficient": MU, "mesh.damping_ratio": 0.0,
            "mesh.relief": "ignored", "mesh.contact": "prescribed",
        }
    )  # fmt: skip


def _factor() -> float:
    """Deviation of the q row of the gear's equations from sum k_i (1 + s_i mu tan alpha)/m_e."""
    gear = _gear()
    system = periodic_system(gear, "mesh")
    g = gear.geometry
    times = np.concatenate([np.linspace(a, b, 9)[1:-1] for a, b in pairwise(system.cycle.edges)])
    pairs = system.cycle.sample(times)
    sign = np.where(pairs.position < g.L_XP, -1.0, 1.0)
    factor = 1.0 + sign * MU * np.tan(g.operating_pressure_angle)
    expected = (factor * pairs.stiffness).sum(axis=0) / bodies(gear).effective_mass
    return float(np.abs(-system.gain(times).stiffness[:, 0] / expected - 1.0).max())


def _on_bearings(factor: float) -> float:
    """Distance of the closed form from the multipliers of the gear on bearings this much stiffer than k."""
    gear = _gear()
    system = periodic_system(gear, "mesh")
    g = gear.geometry
    k = float(system.cycle.sample(np.array([0.9 * system.period])).stiffness.max())
    omega = np.sqrt(k * g.contact_ratio / bodies(gear).effective_mass)
    exact = CoulombGearPair(g.contact_ratio, 0.0, MU, g.operating_pressure_angle)
    expected = exact.multipliers(2.0 * np.pi / system.period / omega)
    changes = {f"bearings.{w}.loa_stiffness": factor * k for w in ("pinion", "gear")}
    # Damped, so that the motions of the bearings are not mistaken for those of the mesh.
    changes |= {f"bearings.{w}.loa_damping_ratio": 0.02 for w in ("pinion", "gear")}
    values = gear_pair_multipliers(gear.with_(changes), 1e-9).feedback
    return float(max(np.abs(values - e).min() for e in expected))


def _rescaled() -> float:
    f = 1.0 + MU * np.tan(np.deg2rad(20.0))
    constant = CoulombGearPair(damping_ratio=0.02, friction=MU, sign="constant")
    scaled = CoulombGearPair(damping_ratio=0.02 * np.sqrt(f))
    difference = np.abs(constant.multipliers(_RATIOS)) - np.abs(scaled.multipliers(_RATIOS / np.sqrt(f)))
    return float(np.abs(difference).max())


def _trace(mu: float) -> FloatArray:
    pair = CoulombGearPair(damping_ratio=0.0, friction=mu)
    return np.asarray(np.trace(pair.monodromy_matrix(_RATIOS), axis1=1, axis2=2))
