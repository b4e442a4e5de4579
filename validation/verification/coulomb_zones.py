"""One degree of freedom with Coulomb friction (Vaishya and Singh): against the engine and the full gear pair.

Unity ratio and equal inertias: friction multiplies the stiffness of each tooth pair by 1 + s mu tan(alpha).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from itertools import pairwise

import numpy as np

from floquet import gear_pair_multipliers, monodromy
from floquet.engine.tongues import tongue_tip
from floquet.gear.coulomb_zones import CoulombGearPair
from lumped import GearPair, load_gear_pair
from lumped.model.bodies import bodies
from lumped.model.periodic_system import periodic_system
from lumped.typing import FloatArray
from validation.verification.checks import Check, error_check, order_check

MU = 0.2
_RATIOS = np.linspace(0.2, 3.0, 57)


def check_coulomb_gear_pair() -> Iterator[Check]:
    """Closed form against engine and gear; what friction of either kind can and cannot change."""
    yield error_check("gear pair with Coulomb friction", "M in closed form", _transition(), 1e-10)
    exact = "a pair's gain over the cycle, 28/28 with J_p = J_g"
    yield error_check("1 ± μ tan α in the equations of motion", exact, _factor(), 1e-12)
    soft, stiff = (_on_bearings(factor) for factor in (1e4, 4e4))
    yield error_check("rigid bearings", "multipliers in closed form, bearings 40000 times k", stiff, 2e-3)
    observed = np.log2(soft / stiff) / 2.0
    yield order_check("rigid bearings: in the mesh stiffness over that of the bearings", observed, 1.0, 0.1)
    exact = "|multiplier| of the frictionless pair at speed/√f, damping ζ√f, f = 1 + μ tan α"
    yield error_check("friction of one sign", exact, _rescaled(), 1e-9)
    wet, dry = CoulombGearPair(friction=MU), CoulombGearPair()
    decay = np.linalg.det(wet.monodromy_matrix(_RATIOS)) / np.linalg.det(dry.monodromy_matrix(_RATIOS))
    worst = np.abs(decay - 1.0).max()
    yield error_check("friction that reverses: decay", "det M without friction", worst, 1e-12)
    full, half = (np.abs(_trace(mu) - _trace(0.0)).max() for mu in (MU, MU / 2))
    yield order_check("friction that reverses: growth in μ", np.log2(full / half), 2.0, 0.05)


def _transition() -> float:
    worst = 0.0
    for sign in ("reversing", "constant"):
        for damping in (0.0, 0.05, 0.9):
            pair = CoulombGearPair(damping_ratio=damping, friction=MU, sign=sign)
            for ratio in (0.13, 0.7, 1.9):
                M = monodromy(pair.system(ratio), 1e-11).matrix
                worst = max(worst, float(np.abs(M - pair.monodromy_matrix(ratio)).max()))
    return worst


def _gear() -> GearPair:
    return load_gear_pair("nasa_28_28").with_(
        {
            "friction.law": "coulomb",
            "friction.coefficient": MU,
            "mesh.damping_ratio": 0.0,
            "mesh.relief": "ignored",
        }
    )


def _factor() -> float:
    """Deviation of the q row of the gear's equations from sum k_i (1 + s_i mu tan alpha)/m_e."""
    gear = _gear()
    system, g = periodic_system(gear, "mesh"), gear.geometry
    times = np.concatenate([np.linspace(a, b, 9)[1:-1] for a, b in pairwise(system.cycle.edges)])
    pairs = system.cycle.sample(times)
    sign = np.where(pairs.position < g.L_XP, -1.0, 1.0)
    factor = 1.0 + sign * MU * np.tan(g.operating_pressure_angle)
    expected = (factor * pairs.stiffness).sum(axis=0) / bodies(gear).effective_mass
    return float(np.abs(-system.gain(times).stiffness[:, 0] / expected - 1.0).max())


def _on_bearings(factor: float) -> float:
    """Distance of the closed form from the multipliers of the gear on bearings this much stiffer than k."""
    gear = _gear()
    system, g = periodic_system(gear, "mesh"), gear.geometry
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


def zone_tips(orders: int = 4) -> list[tuple[str, str, float, float]]:
    """Where the zones 2 omega/k close: (zone, friction, damping ratio, mesh over natural frequency)."""
    f = np.sqrt(1.0 + MU * np.tan(np.deg2rad(20.0)))
    cases = {
        "none": (CoulombGearPair(), 1.0),
        "reversing": (CoulombGearPair(friction=MU), 1.0),
        "constant": (CoulombGearPair(friction=MU, sign="constant"), f),
    }
    rows = []
    for k in range(1, orders + 1):
        for case, (pair, stretch) in cases.items():
            centre = 2.0 / k * stretch
            tip = tongue_tip(_radius_of(pair), (0.96 * centre, 1.02 * centre), (1e-4, 0.3), xtol=1e-10)
            rows.append((f"2ω/{k}" if k > 1 else "2ω", case, tip.damping, tip.place))
    return rows


def _radius_of(pair: CoulombGearPair) -> Callable[[FloatArray, float], FloatArray]:
    def radius(ratios: FloatArray, damping: float) -> FloatArray:
        return np.asarray(np.abs(replace(pair, damping_ratio=damping).multipliers(ratios)[:, 0]))

    return radius
