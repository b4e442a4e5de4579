"""Does the evidence for the multibody model hold, and does each kind of it see a fault?"""

import importlib

import pytest

import lumped
from validation.verification import published
from validation.verification.published import OWN, published_values
from validation.verification.reference_model import reference_model


def checked(pair):
    found = reference_model(pair, pair.operating.pinion_torque / pair.geometry.base_radius_pinion)
    return found, {check.key for check in found.checks if not check.passes}


@pytest.mark.parametrize("name", lumped.preset_names())
def test_the_multibody_model_of_every_preset_passes(name):
    found, failing = checked(lumped.load_gear_pair(name))
    assert not failing
    assert len(found.checks) == 2
    assert all(check.reason for check in found.checks)


def test_a_static_load_of_another_radius_is_seen(pair):
    wrong = pair.operating.pinion_torque / pair.geometry.reference_radius_pinion
    assert [c.key for c in reference_model(pair, wrong).checks if not c.passes] == ["static_load"]


@pytest.mark.parametrize(
    ("place", "formula"),
    [("lumped.friction.benedict_kelley", "benedict_kelley"), ("lumped.lubrication.film", "film_thickness")],
)
def test_a_published_value_that_the_lumped_formula_misses_is_named(place, formula, pair, monkeypatch):
    module = importlib.import_module(place)
    true = getattr(module, formula)

    def wrong(*arguments, **options):
        return 1.001 * true(*arguments, **options)

    wrong.__doc__, wrong.__module__ = true.__doc__, place
    monkeypatch.setattr(module, formula, wrong)
    missed = [value.formula for value in published_values() if not value.passes]
    assert len(missed) == 1
    assert missed[0].startswith(formula)
    assert checked(pair)[1] == {"published_values"}


def test_a_published_value_that_the_multibody_formula_misses_is_named(monkeypatch):
    own = OWN["xu_kahraman"]
    monkeypatch.setitem(published.OWN, "xu_kahraman", lambda: 1.001 * own())
    assert [value.formula.partition("(")[0] for value in published_values() if not value.passes] == [
        "xu_kahraman"
    ]
