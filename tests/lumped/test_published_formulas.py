"""Do the published formulas give the numbers that their docstrings show?"""

import doctest
import importlib

import pytest

from validation.verification.published import FORMULAS


@pytest.mark.parametrize("module", FORMULAS)
def test_every_formula_shows_a_number_and_it_is_right(module):
    loaded = importlib.import_module(module)
    shown = {test.name.rpartition(".")[2] for test in doctest.DocTestFinder().find(loaded) if test.examples}
    assert shown >= FORMULAS[module]
    assert doctest.testmod(loaded).failed == 0
