"""Is the one-degree-of-freedom pair with Coulomb friction exact, and is it the gear on rigid bearings?"""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from floquet import gear_pair_multipliers, monodromy
from floquet.gear.vaishya_singh import CoulombGearPair, stability_zones
from lumped import geometry, load_gear_pair, periodic_system
from lumped.errors import ParameterError
from lumped.model.bodies import bodies

MU = 0.2


@pytest.mark.parametrize("sign", ["reversing", "constant"])
@pytest.mark.parametrize("damping", [0.0, 0.05, 0.9, 1.6])  # the last two overdamped in some or all pieces
@pytest.mark.parametrize("ratio", [0.13, 0.7, 1.9])
def test_closed_form_equals_the_engine(sign: str, damping: float, ratio: float) -> None:
    pair = CoulombGearPair(damping_ratio=damping, friction=MU, sign=sign)
    result = monodromy(pair.system(ratio), 1e-11)
    # 1e-10: rtol 1e-11, norms up to 3.
    assert np.abs(pair.monodromy_matrix(ratio) - result.matrix).max() < 1e-10
    assert np.allclose(np.abs(pair.multipliers(ratio)), np.abs(result.multipliers), rtol=1e-6, atol=1e-12)
    spectrum = pair.spectrum(ratio)
    assert abs(spectrum.spectral_radius - result.spectral_radius) <= spectrum.error + result.error


def test_friction_scales_each_pair_by_one_plus_minus_mu_tan_alpha() -> None:
    # The same statement on the equations of motion of the full gear pair: in the q row of the feedback every
    # pair's k_i/m_e appears times 1 + s_i mu tan alpha, wherever the contact is (28/28, J_p = J_g).
    gear = load_gear_pair("nasa_28_28").with_(friction__law="coulomb", friction__coefficient=MU)
    system = periodic_system(gear, "feedback")
    g = geometry(gear)
    edges = system.cycle.edges
    times = np.concatenate([np.linspace(a, b, 9)[1:-1] for a, b in pairwise(edges)])
    pairs = system.cycle.sample(times)
    sign = np.where(pairs.position < g.L_XP, -1.0, 1.0)
    factor = 1.0 + sign * MU * np.tan(g.operating_pressure_angle)
    expected = (factor * pairs.stiffness).sum(axis=0) / bodies(gear).effective_mass
    assert np.allclose(-system.gain(times).stiffness[:, 0], expected, rtol=1e-12)  # rounding
    # And the preset has the same pieces: gains over the mean stiffness of the frictionless mesh.
    preset = CoulombGearPair(g.contact_ratio, 0.0, MU, g.operating_pressure_angle)
    mean = pairs.stiffness.max() * g.contact_ratio / bodies(gear).effective_mass
    assert np.allclose(preset.phases * g.mesh_period, edges, rtol=0, atol=1e-12 * g.mesh_period)
    middle = 0.5 * (edges[:-1] + edges[1:])
    assert np.allclose(-system.gain(middle).stiffness[:, 0] / mean, preset.gains, rtol=1e-12)


def test_gear_pair_on_rigid_bearings_has_its_multipliers() -> None:
    # Six states on stiffer and stiffer bearings: the multipliers of q approach those of the one equation, and
    # the difference goes with the mesh stiffness over the bearing stiffness (order 1).
    base = load_gear_pair("nasa_28_28").with_(
        friction__law="coulomb", friction__coefficient=MU, mesh__damping_ratio=0.0
    )
    g = geometry(base)
    system = periodic_system(base, "feedback")
    k = float(system.cycle.sample(np.array([0.9 * system.period])).stiffness.max())
    omega = np.sqrt(k * g.contact_ratio / bodies(base).effective_mass)
    preset = CoulombGearPair(g.contact_ratio, 0.0, MU, g.operating_pressure_angle)
    expected = preset.multipliers(2 * np.pi / system.period / omega)
    stiff = {f"bearings.{w}.{a}_damping_ratio": 1.0 for w in ("pinion", "gear") for a in ("loa", "oloa")}
    gap = []
    for factor in (1e3, 4e3):
        bearing = {f"bearings.{w}.loa_stiffness": factor * k for w in ("pinion", "gear")}
        values = gear_pair_multipliers(base.with_(stiff | bearing), 1e-9).feedback
        gap.append(max(np.abs(values - e).min() for e in expected))
    assert gap[0] < 0.05
    # Their damping disturbs with sqrt(k/K) to some power above one half; four times stiffer must at least
    # halve the difference.
    assert gap[1] < 0.55 * gap[0]


def test_constant_friction_is_a_change_of_speed_and_damping() -> None:
    # With s = +1 always, k and c grow by f = 1 + mu tan alpha: the frictionless pair at speed/sqrt(f) with
    # damping ratio zeta sqrt(f), exactly.
    f = 1.0 + MU * np.tan(np.deg2rad(20.0))
    ratios = np.linspace(0.1, 3.0, 200)
    constant = CoulombGearPair(damping_ratio=0.02, friction=MU, sign="constant")
    scaled = CoulombGearPair(damping_ratio=0.02 * np.sqrt(f))
    assert np.allclose(
        np.abs(constant.multipliers(ratios)), np.abs(scaled.multipliers(ratios / np.sqrt(f))), rtol=1e-9
    )  # rounding of angles up to 60 rad, magnified near double multipliers


def test_reversing_friction_leaves_the_mean_alone() -> None:
    # Approach and recess are equally long, so the mean stiffness, the determinant and with it the total
    # damping per cycle do not depend on mu; and mu -> -mu is the cycle run backwards: even in mu without
    # damping.
    pair = CoulombGearPair(friction=MU)
    assert pair.gains @ np.diff(pair.phases) == pytest.approx(1.0, rel=1e-14)
    ratios = np.linspace(0.2, 3.0, 57)
    dry = replace(pair, friction=0.0)
    with_friction, without = (np.linalg.det(p.monodromy_matrix(ratios)) for p in (pair, dry))
    assert np.allclose(with_friction, without, rtol=1e-12)  # rounding

    def trace(mu: float) -> np.ndarray:
        one = CoulombGearPair(damping_ratio=0.0, friction=mu)
        return np.trace(one.monodromy_matrix(ratios), axis1=1, axis2=2)

    # tr M is then even in mu; as a function of mu^2 its difference quarters when mu is halved.
    full, half = np.abs(trace(MU) - trace(0.0)).max(), np.abs(trace(MU / 2) - trace(0.0)).max()
    assert full / half == pytest.approx(4.0, rel=0.05)  # next term mu^4 (mu tan alpha)^2 = 0.5 %


def test_zones_over_speed_and_damping() -> None:
    zones = stability_zones(CoulombGearPair(friction=MU), np.linspace(0.6, 2.4, 91), [0.0, 0.01, 0.3])
    none, reversing, constant = (zones.sel(friction=name) for name in ("none", "reversing", "constant"))
    for chart in (none, reversing, constant):
        # 20 times the damping that closes the principal tongue: nothing is unstable. Without damping nothing
        # can be called stable, since |multiplier| = 1.
        assert (chart.verdict.sel(damping_ratio=0.3) == 1).all()
        assert not (chart.verdict.sel(damping_ratio=0.0) == 1).any()
        assert (chart.verdict.sel(damping_ratio=0.01) == -1).any()
    # Friction of one sign moves every tongue by sqrt(1 + mu tan alpha) = 3.6 %, here that around 2 omega;
    # zones are known to a node (1 %).
    unstable = [(c.verdict.sel(damping_ratio=0.0) == -1).values for c in (none, constant)]
    speed = none.speed_ratio.values
    moved = [speed[bad & (speed > 1.5)].mean() for bad in unstable]
    assert moved[1] / moved[0] == pytest.approx(np.sqrt(1 + MU * np.tan(np.deg2rad(20.0))), abs=0.012)


@pytest.mark.parametrize(
    "bad", [{"contact_ratio": 2.1}, {"damping_ratio": -0.1}, {"friction": 1.0}, {"pressure_angle": 20.0}]
)
def test_bad_parameters_are_refused(bad: dict[str, float]) -> None:
    with pytest.raises(ParameterError, match=next(iter(bad))):
        CoulombGearPair(**bad)
    with pytest.raises(ParameterError, match="speed_ratio"):
        CoulombGearPair().system(0.0)
