"""Is the load shared as compatibility and equilibrium demand?"""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from lumped import NumericalError
from lumped.quasi_static import share_load


@given(
    k=st.lists(st.floats(0.01, 10.0), min_size=3, max_size=3),
    e=st.lists(st.floats(-5.0, 5.0), min_size=3, max_size=3),
    force=st.floats(0.0, 50.0),
)
def test_equilibrium_and_compatibility(k, e, force):
    k, e = np.array(k), np.array(e)
    found = share_load(k, e, force)
    rounding = 1e-12 * (1.0 + force + np.abs(k * e).sum())  # sums of a few products
    assert found.load.sum() == pytest.approx(force, abs=10 * rounding)
    assert np.all(found.load >= 0.0)
    assert found.load == pytest.approx(k * np.maximum(found.transmission_error - e, 0.0), abs=rounding)


def test_pairs_that_cannot_touch_carry_nothing():
    found = share_load(np.array([1e8, 1e8]), np.array([0.0, np.inf]), np.array([[10.0], [20.0]])[:, 0])
    assert found.load == pytest.approx(np.array([[10.0, 0.0], [20.0, 0.0]]), rel=1e-14)
    with pytest.raises(NumericalError, match="no tooth pair"):
        share_load([1e8], [np.inf], 1.0)


@given(
    k=st.lists(st.floats(0.3, 3.0), min_size=3, max_size=3),
    e=st.lists(st.floats(-1.0, 1.0), min_size=3, max_size=3),
    w=st.lists(st.floats(-0.1, 0.15), min_size=3, max_size=3),
    force=st.floats(0.0, 5.0),
)
def test_pairs_that_move_each_other(k, e, w, force):
    # What is asked of a contact, which has one solution: nobody pulls, nobody is through its mate.
    coupling = np.zeros((3, 3))
    coupling[np.triu_indices(3, 1)] = w
    coupling += coupling.T
    found = share_load([k], [e], [force], [coupling])
    load, matrix = found.load[0], coupling + np.diag(1.0 / np.array(k))
    left = found.transmission_error[0] - np.array(e) - matrix @ load
    assert load.sum() == pytest.approx(force, abs=1e-11)
    assert np.all(load >= 0.0)
    assert np.all(left <= 1e-11)
    assert np.abs(left * load).max() < 1e-11
    with pytest.raises(NumericalError, match="no tooth pair"):
        share_load([k], [[np.inf] * 3], [force], [coupling + 0.01])


def test_a_coupling_too_small_to_matter_changes_nothing():
    k, e = np.array([[1.0, 2.0, 0.5, 0.0]]), np.array([[0.3, 0.0, np.inf, 0.1]])
    alone, nearly = (share_load(k, e, [2.0], w) for w in (None, np.full((1, 4, 4), 1e-300)))
    assert nearly.load == pytest.approx(alone.load, rel=1e-14)
    assert nearly.transmission_error == pytest.approx(alone.transmission_error, rel=1e-14)
