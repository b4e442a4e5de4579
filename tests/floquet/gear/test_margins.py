"""Are the margins of stability what closed forms and an independent integrator say?"""

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import brentq, minimize_scalar

from floquet.gear.multipliers import gear_pair_multipliers
from floquet.gear.tongues import stability_margins
from lumped import geometry, load_gear_pair, periodic_system
from lumped.schema.bodies import bodies
from tests.evidence.floquet.coulomb_zones import CoulombGearPair
from tests.unlike_pairs import unlike_pair

MU = 0.2


def with_friction(mu: float):
    pair = load_gear_pair("nasa_28_28").with_(mesh__contact="prescribed", mesh__relief="ignored")
    return pair.with_(friction__law="coulomb", friction__coefficient=mu, mesh__damping_ratio=0.004)


def test_tip_on_rigid_bearings_is_that_of_the_closed_form() -> None:
    # On rigid bearings the pair is one damped Meissner equation (Vaishya and Singh), whose multipliers are in
    # closed form: speed and damping of the tip of the tongue at twice the natural frequency follow from them
    # by root finding. There c_i = 2 zeta k_i/omega with omega^2 = sigma k/m_e; here c_i = 2 zeta sqrt(k m_e).
    base = with_friction(MU)
    g = geometry(base)
    system = periodic_system(base, "mesh")
    k = float(system.cycle.sample(np.array([0.9 * system.period])).stiffness.max())
    omega = np.sqrt(k * g.contact_ratio / bodies(base).effective_mass)
    exact = CoulombGearPair(g.contact_ratio, 0.0, MU, g.operating_pressure_angle)

    def radius(ratio, damping):
        return np.abs(
            replace(exact, damping_ratio=damping * np.sqrt(g.contact_ratio)).multipliers(ratio)[..., 0]
        )

    def top(damping):
        return minimize_scalar(lambda r: -radius(r, damping), bounds=(1.9, 2.1), options={"xatol": 1e-9})

    critical = brentq(lambda z: -top(z).fun - 1.0, 0.01, 0.2, xtol=1e-12)
    rpm = omega * 60.0 / (2.0 * np.pi * 28)
    low = brentq(lambda r: radius(r, 0.004) - 1.0, 1.75, 1.95, xtol=1e-12) * rpm
    errors = []
    for stiffness in (400.0 * k, 800.0 * k):
        changes = {f"bearings.{w}.loa_stiffness": stiffness for w in ("pinion", "gear")}
        changes |= {f"bearings.{w}.loa_damping_ratio": 0.5 for w in ("pinion", "gear")}
        margins = stability_margins(base.with_(changes), (1.8 * rpm, 2.2 * rpm))
        (tongue,) = margins.tongues
        assert tongue.label == "2w1/1"
        margin = tongue.critical_damping, tongue.tip_speed, margins.unstable_here[0, 0] - margins.rpm
        errors.append(np.array(margin) / [critical, top(critical).x * rpm, low - margins.rpm] - 1.0)
    coarse, fine = errors
    assert (np.abs(fine) < 2.5e-3).all()
    # What is left is the give of the bearings, k/K: twice as stiff, twice as close, and gone in the limit.
    # The damping also feels that of the bearings, which goes with a higher power and the other sign.
    assert np.allclose(coarse[1:] / fine[1:], 2.0, rtol=0.02)
    assert np.abs(2.0 * fine - coarse)[1:].max() < 1e-4


@pytest.fixture(scope="module")
def pair():
    """Rack of 25 degrees, unequal gears and bearings."""
    light = {"friction.law": "coulomb", "friction.coefficient": 0.06, "friction.maximum": None}
    light |= {"mesh.contact": "prescribed", "mesh.damping_ratio": 0.004}
    return unlike_pair("rack_25_degrees_always_pushing").with_(light)


@pytest.fixture(scope="module")
def margins(pair):
    return stability_margins(pair, (8000.0, 14300.0))


def independent(pair, rpm: float, damping: float) -> float:
    """Spectral radius by Gauss collocation on the matrices, not by the compiled kernel."""
    there = pair.with_({"operating.pinion_speed": float(rpm), "mesh.damping_ratio": float(damping)})
    return gear_pair_multipliers(there, 1e-9, method="gauss").spectral_radius


def test_tips_are_the_roots_that_an_independent_integrator_finds(pair, margins) -> None:
    assert [t.label for t in margins.tongues] == ["2w3/5", "2w3/3"]
    for tongue in margins.tongues:

        def top(damping, tongue=tongue):
            return -minimize_scalar(
                lambda rpm: -independent(pair, rpm, damping),
                bounds=(tongue.tip_speed - 5.0, tongue.tip_speed + 5.0),
                options={"xatol": 0.05},
            ).fun

        critical = tongue.critical_damping
        # Growth changes by about 0.2 per 0.01 of damping: a part in 1e4 of the damping is 1e-5, and shows.
        assert top(critical * (1.0 - 1e-4)) > 1.0 > top(critical * (1.0 + 1e-4))


def test_damping_at_the_operating_speed_is_a_root(pair) -> None:
    inside = stability_margins(pair.with_(operating__pinion_speed="13600 rpm"), (13000.0, 14300.0))
    limit = inside.damping_at_speed
    below, above = (independent(pair, 13600.0, limit * (1.0 + side)) for side in (-1e-5, 1e-5))
    assert below > 1.0 > above
    assert limit < inside.critical_damping


def test_a_range_without_a_tongue_has_no_margins_but_an_answer(pair) -> None:
    margins = stability_margins(pair, (1000.0, 1100.0))
    assert margins.tongues == ()
    assert margins.critical_damping == 0.0
    assert margins.unstable_here.size == 0
    assert margins.dataset.sizes["tongue"] == 0


def test_the_next_tongue_above_the_range_is_the_one_that_a_wider_search_finds(pair) -> None:
    wider_search = stability_margins(pair, (26000.0, 50000.0))
    below, target = wider_search.tongues[-2:]
    narrow = stability_margins(pair, (26000.0, 0.5 * (below.upper + target.lower)))
    assert narrow.above.label == target.label
    assert narrow.above.lower == pytest.approx(target.lower, rel=1e-7)
    assert narrow.above.upper == pytest.approx(target.upper, rel=1e-7)
    assert narrow.above.critical_damping == pytest.approx(target.critical_damping, rel=1e-5)
    # A tongue that begins within the range is not the next one.
    inside = stability_margins(pair, (26000.0, 0.5 * (below.lower + below.upper)))
    assert inside.above.lower == pytest.approx(target.lower, rel=1e-7)
    assert wider_search.above is None


def test_the_search_above_stays_within_the_speeds_of_the_schema() -> None:
    pair = unlike_pair("contact_ratio_1_1_large_shifts").with_(
        mesh__contact="prescribed", operating__pinion_speed=150_000.0, bearings__pinion__loa_stiffness=1e12,
        mesh__damping_ratio=0.0,
    )  # fmt: skip
    margins = stability_margins(pair, (100_000.0, 190_000.0))
    assert margins.above is None or margins.above.upper <= 200_000.0
