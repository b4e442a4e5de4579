"""Are the multipliers of teeth that differ those of other integrators, within their proven bounds?"""

from dataclasses import replace
from functools import reduce

import numpy as np
import pytest

from floquet import gear_pair_multipliers, revolution_multipliers
from floquet.gear import multipliers
from floquet.gear.gains import OwnGains, own_tables
from floquet.rank_one.piecewise import fit_pieces
from lumped.model.cycle_maps import CycleSteps, linear_steps
from lumped.model.periodic_system import LTVSystem
from lumped.model.tooth_laws import ToothLaws
from lumped.schema.bodies import bodies
from tests.unlike_pairs import unlike_pair

#: 20/30, a rack of 22.5 degrees. Teeth of the pinion that differ repeat after 20 cycles, of both after 60.
#: Motions off the line of action are damped so much that the mesh decides the rate.
PAIR = unlike_pair("unlike_teeth_finite_elements").healthy.with_(
    {
        "friction.law": "coulomb", "friction.coefficient": 0.06, "mesh.stiffness": {"model": "rectangular"},
        "pinion.tip_relief": None, "gear.tip_relief": None, "operating.pinion_speed": 4000,
        "bearings.pinion.oloa_damping_ratio": 0.5, "bearings.gear.oloa_damping_ratio": 0.5,
    }
)  # fmt: skip
CLASS_6 = {f"{gear}.deviations": {"tolerance_class": 6} for gear in ("pinion", "gear")}
HUNTING = {"pinion.teeth": 19, "gear.teeth": 41, "centre_distance": None} | CLASS_6
ECCENTRIC = {"pinion.mounting": {"eccentricity": 20, "phase": 50}}


def cracked(*teeth):
    return {"pinion.faults": [{"kind": "crack", "tooth": tooth, "depth": 1.0} for tooth in teeth]}


def by_gauss_steps(pair, times, rate):
    """Rate, near ``rate``, and mean log of the determinants of the linear form, its steps so much shorter."""
    system = LTVSystem.of(pair.healthy, "mesh", supports="springs")
    maps = CycleSteps(pair, system, 1, times * linear_steps(system)).cycle_maps()[..., :6]
    largest = np.abs(np.linalg.eigvals(reduce(lambda product, one: one @ product, maps / rate))).max()
    return rate * largest ** (1.0 / len(maps)), np.linalg.slogdet(maps)[1].mean()


@pytest.mark.parametrize("contact", ["prescribed", "loaded"])
@pytest.mark.parametrize("change", [CLASS_6, ECCENTRIC, cracked(3), HUNTING])
def test_rates_are_those_of_gauss_steps_and_of_finer_polynomials(contact, change, monkeypatch):
    pair = PAIR.with_({"mesh.contact": contact, "mesh.relief": "ignored"} | change)
    result = revolution_multipliers(pair)
    monkeypatch.setattr(multipliers, "_BLOCK", 4)
    finer = revolution_multipliers(pair, 1e-11)
    times, most, compared = (8, 1e-7, 4) if result.cycles <= 60 else (2, 1e-6, 2)
    coarse, fine = (by_gauss_steps(pair, times * n, result.rate)[0] for n in (1, 2))
    assert 4.0 * abs(fine - coarse) < most
    assert abs(result.rate - fine) <= result.error + 4.0 * abs(fine - coarse)
    assert abs(result.rate - finer.rate) < 1e-3 * result.error
    assert (result.rates.size, result.error < 1e-9) == (compared + 4, True)
    assert np.abs(result.multipliers[0]) == pytest.approx(result.rate**result.cycles, rel=1e-9, abs=0.0)


@pytest.mark.parametrize("contact", ["prescribed", "loaded"])
def test_like_teeth_have_the_multipliers_of_the_mesh_cycle_to_the_power_of_the_cycles(contact):
    pair = PAIR.with_({"mesh.contact": contact, "mesh.relief": "static"})
    expected = gear_pair_multipliers(pair)
    rate = np.abs(expected.feedback).max()
    power = np.poly(expected.feedback[:2] ** 20)
    like = {"pinion.deviations": {"index": [0.0] * 20, "first_order": "steps"}}
    for change in (like, {"pinion.mounting": {"eccentricity": 1e-9}}):  # which makes the cycles' maps differ
        result = revolution_multipliers(pair.with_(change))
        assert (result.cycles, result.certificate, result.stable) == (20, "proven", True)
        assert abs(result.rate - rate) <= result.error + expected.error < 1e-9
        assert np.poly(result.multipliers[:2]) == pytest.approx(power, rel=1e-7, abs=0.0)
        assert result.rate == pytest.approx(result.healthy_rate, rel=1e-9)


def test_the_rate_is_that_of_all_motions_also_off_the_line_of_action():
    """Light damping of the bearings there: with like teeth these motions fade slowest."""
    light = {f"bearings.{gear}.oloa_damping_ratio": 0.005 for gear in ("pinion", "gear")}
    pair = PAIR.with_({"mesh.contact": "prescribed"} | light)
    expected = gear_pair_multipliers(pair)
    assert expected.spectral_radius > 1.1 * np.abs(expected.feedback).max()
    result = revolution_multipliers(pair.with_({"pinion.mounting": {"eccentricity": 1e-9}}))
    assert result.rate == pytest.approx(expected.spectral_radius, rel=1e-6)


def test_all_multipliers_have_the_product_of_the_determinants_of_gauss_steps():
    pair = PAIR.with_({"operating.pinion_speed": 60000, "mesh.contact": "loaded"} | cracked(3))
    result = revolution_multipliers(pair)
    assert result.rates.size == 10
    # m y'' + c y' + K y = 0 of both gears: the product of its multipliers is exp(-c T/m).
    body = bodies(pair)
    bearings = pair.bearings
    apart = 0.0
    for mass, bearing in ((body.mass_pinion, bearings.pinion), (body.mass_gear, bearings.gear)):
        apart -= 2.0 * bearing.oloa_damping_ratio * np.sqrt(bearing.oloa_stiffness / mass)
    expected = by_gauss_steps(pair, 8, result.rate)[1] + apart * pair.geometry.mesh_period
    assert np.log(result.rates).sum() == pytest.approx(expected, rel=1e-6)


def test_the_bound_holds_for_maps_that_are_off_as_far_as_they_may(monkeypatch):
    pair = PAIR.with_(cracked(3))
    map_error = 1e-6
    maps = multipliers.fast_monodromies

    def shrunk(*arguments, **named):
        flow = maps(*arguments, **named)
        wrong = map_error * np.linalg.norm(flow.matrices, axis=(1, 2))
        return replace(flow, matrices=(1.0 - map_error) * flow.matrices, errors=flow.errors + wrong)

    exact = revolution_multipliers(pair).rate
    monkeypatch.setattr(multipliers, "fast_monodromies", shrunk)
    result = revolution_multipliers(pair)
    rate_error = exact - result.rate
    assert rate_error == pytest.approx(map_error / 20 * exact, rel=1e-3)
    assert rate_error < result.error < 100.0 * rate_error


def test_pieces_end_where_a_pair_touches_its_damper_is_full_or_its_tip_leaves_the_line():
    pair = PAIR.with_({"mesh.contact": "loaded", "mesh.relief": "ignored"} | CLASS_6)
    gains = OwnGains(
        own_tables(ToothLaws(pair, every=True)), LTVSystem.of(pair.healthy, "mesh", supports="springs"), 5, 8
    )
    # Else pieces are halved around every kink, down to the tolerance: 115 of a cycle.
    assert fit_pieces(gains, gains.edges, np.ones(3), rtol=1e-11)[0].size < 27 * 8


def test_a_softer_tooth_moves_the_rate_by_its_share_of_the_pairs():
    # To first order a change of one cycle in 20 moves the logarithm by 1/20 of what it does in every cycle.
    pair = PAIR.with_({"mesh.contact": "prescribed", "mesh.relief": "ignored"})
    both = (revolution_multipliers(pair.with_(cracked(*teeth))) for teeth in ([3], range(1, 21)))
    one, every = (np.log(result.rate / result.healthy_rate) for result in both)
    assert abs(every) > 1e-4
    # What is left is of second order in the stiffness that the crack takes away.
    assert 20.0 * one == pytest.approx(every, rel=0.01)
