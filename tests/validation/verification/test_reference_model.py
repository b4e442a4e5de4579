"""Does the evidence for the multibody model hold, and does each kind of it see a fault?"""

import dataclasses
import importlib

import pytest

import lumped
import multibody
from lumped import NumericalError
from lumped.friction.registry import LAWS
from multibody.contact import kernels as kn
from multibody.contact.machine import machine
from multibody.study import free_vibration, frozen_modes, turning
from multibody.study.shared import shared_of
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
    assert found.refused == ()
    assert len(found.checks) == 6
    assert all(check.reason for check in found.checks)


def test_one_percent_of_the_damping_in_the_force_core_is_seen(pair, monkeypatch):
    def stronger(pair):
        numbers = machine(pair)
        p = numbers.parameters.copy()
        p[kn.DAMPING] *= 1.01
        return dataclasses.replace(numbers, parameters=p)

    monkeypatch.setattr(free_vibration, "machine", stronger)
    assert checked(pair)[1] == {"damping"}


def test_one_percent_of_a_bearing_in_the_lumped_matrix_is_seen(pair, monkeypatch):
    stiffer = pair.with_({"bearings.gear.oloa_stiffness": 1.01 * pair.bearings.gear.oloa_stiffness})
    true = frozen_modes.periodic_system
    monkeypatch.setattr(frozen_modes, "periodic_system", lambda pair, form: true(stiffer, form))
    assert checked(pair)[1] == {"frozen_modes", "frozen_modes_exact"}


def test_one_percent_of_the_mass_in_the_third_build_is_seen(pair, monkeypatch):
    def heavier(numbers, *rest, **options):
        return true(dataclasses.replace(numbers, mass=1.01 * numbers.mass), *rest, **options)

    true = turning.build
    monkeypatch.setattr(turning, "build", heavier)
    assert checked(pair)[1] == {"third_build"}


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


def test_what_cannot_be_computed_is_said_and_not_judged(pair, monkeypatch):
    def fail(*_, **__):
        raise NumericalError("A mode of the frozen pair is overdamped.")

    monkeypatch.setattr(multibody, "frozen_modes", fail)
    found, failing = checked(pair)
    assert not failing
    assert found.modes is None
    assert found.refused == (
        "natural frequencies with frozen mesh: A mode of the frozen pair is overdamped.",
    )


def test_the_multibody_model_has_a_formula_of_every_law(pair):
    for law in LAWS:
        assert shared_of(pair.with_(friction__law=law)) == multibody.SHARED
