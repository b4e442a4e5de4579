"""Does the hypercube over the paper's open assumptions vary what it says, and count what fails?"""

import numpy as np
import pytest

from lumped import NumericalError, bodies, load_gear_pair
from lumped.path_of_contact import contact_path
from reproductions.he_cho_singh_2008.claims import sensitivity
from reproductions.he_cho_singh_2008.claims.numbers import measure
from reproductions.he_cho_singh_2008.claims.sensitivity import ASSUMPTIONS, sample_assumptions, vary


@pytest.fixture(scope="module")
def pair():
    return load_gear_pair("nasa_28_28")


@pytest.fixture(scope="module")
def stated(pair):
    return measure(pair)


#: The preset's own values, in the order of the assumptions.
NEUTRAL = np.array([1.0, 1.0, 1e8, 1.0, 0.05, 0.05, 0.1018, 10.0, 0.2, 50.0, 0.0])


def test_the_ranges_of_the_assumptions_hold_the_preset():
    for assumption, value in zip(ASSUMPTIONS, NEUTRAL, strict=True):
        assert assumption.low <= value <= assumption.high, assumption.name


def test_neutral_assumptions_give_the_stated_numbers(pair, stated):
    same = measure(vary(pair, NEUTRAL))
    for name, value in stated.items():
        # R_comp is sqrt 2 * 0.1018 = 0.14397 um here, 0.144 um in the preset
        assert same[name] == pytest.approx(value, rel=2e-3, abs=1e-9), name


def test_every_assumption_reaches_its_parameter(pair):
    values = np.array([0.7, 2.1, 5e7, 1.6, 0.03, 0.08, 0.4, 23.0, 0.15, 90.0, 0.9])
    varied = vary(pair, values)
    own = bodies(pair)
    new = bodies(varied)
    assert (new.inertia_pinion, new.inertia_gear) == pytest.approx(
        (0.7 * own.inertia_pinion, 0.7 * own.inertia_gear), rel=1e-12
    )
    assert (new.mass_pinion, new.mass_gear) == pytest.approx(
        (2.1 * own.mass_pinion, 2.1 * own.mass_gear), rel=1e-12
    )
    for b in (varied.bearings.pinion, varied.bearings.gear):
        assert (b.loa_stiffness, b.oloa_stiffness) == pytest.approx((5e7, 8e7), rel=1e-12)
        assert (b.loa_damping_ratio, b.oloa_damping_ratio) == (0.03, 0.03)
    path = contact_path(varied)
    assert path.roughness == pytest.approx(0.4e-6, rel=1e-12)
    assert path.composite_roughness == pytest.approx(0.4e-6 * np.sqrt(2.0), rel=1e-12)
    assert path.viscosity == pytest.approx(0.023, rel=1e-12)
    assert varied.mesh.damping_ratio == 0.08
    assert varied.mesh.stiffness.model == "parabolic"
    assert (varied.friction.maximum, varied.friction.sharpness) == pytest.approx((0.15, 90e3))


def test_the_hypercube_fills_every_stratum_once(pair):
    found = sample_assumptions(pair, 8, seed=3)
    assert (len(found.numbers), found.failed) == (8, 0)  # the ranges are such that motions exist
    for column, assumption in zip(found.samples.T, ASSUMPTIONS, strict=True):
        if assumption.logarithmic:
            u = np.log(column / assumption.low) / np.log(assumption.high / assumption.low)
        else:
            u = (column - assumption.low) / (assumption.high - assumption.low)
        np.testing.assert_array_equal(np.sort(np.floor(8 * u)), np.arange(8))
    again = sample_assumptions(pair, 8, seed=3)
    assert found.numbers == again.numbers


def _failing(monkeypatch, every):
    """Let every so-many-th sample have no periodic motion."""
    calls = []

    def fake(pair):
        calls.append(pair)
        if len(calls) % every == 0:
            raise NumericalError("no periodic motion")
        return {"mean_ratio": float(len(calls))}

    monkeypatch.setattr(sensitivity, "measure", fake)


def test_samples_without_a_motion_are_counted_and_left_out(pair, monkeypatch):
    _failing(monkeypatch, every=3)
    found = sample_assumptions(pair, 8)
    assert found.failed == 2
    assert [row["mean_ratio"] for row in found.numbers] == [1.0, 2.0, 4.0, 5.0, 7.0, 8.0]
    assert found.samples.shape == (6, len(ASSUMPTIONS))


def test_a_pair_whose_samples_mostly_fail_is_refused(pair, monkeypatch):
    _failing(monkeypatch, every=1)
    with pytest.raises(NumericalError, match="8 of 8 samples"):
        sample_assumptions(pair, 8)
    _failing(monkeypatch, every=2)
    assert sample_assumptions(pair, 8).failed == 4  # half is enough
