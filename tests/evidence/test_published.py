"""Is a published value that one of the models misses named?"""

import importlib

import pytest

from tests.evidence import published
from tests.evidence.published import missed_values


@pytest.mark.parametrize(
    ("place", "formula"),
    [("lumped.friction.benedict_kelley", "benedict_kelley"), ("lumped.lubrication.film", "film_thickness")],
)
def test_a_value_that_the_lumped_formula_misses(place, formula, monkeypatch):
    module = importlib.import_module(place)
    true = getattr(module, formula)

    def wrong(*arguments, **options):
        return 1.001 * true(*arguments, **options)

    wrong.__doc__, wrong.__module__ = true.__doc__, place
    monkeypatch.setattr(module, formula, wrong)
    assert missed_values() == [f"{formula}: lumped"]


def test_a_value_that_the_multibody_formula_misses(monkeypatch):
    own = published.OWN["xu_kahraman"]
    monkeypatch.setitem(published.OWN, "xu_kahraman", lambda: 1.001 * own())
    assert missed_values() == ["xu_kahraman: multibody"]
