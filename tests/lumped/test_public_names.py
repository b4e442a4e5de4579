"""Do functions that are called through their package raise typed errors, and survive pickling?"""

import pickle

import numpy as np
import pytest

import floquet
import lumped
import validation
from floquet.engine.second_order import from_second_order
from lumped.errors import NumericalError


def singular(time):
    """A stiffness of a user that fails in linear algebra."""
    return np.linalg.inv(np.zeros((2, 2)))


def test_an_error_of_linear_algebra_is_a_numerical_error():
    with pytest.raises(NumericalError, match="The computation failed: Singular matrix"):
        floquet.from_second_order(np.eye(2), np.zeros((2, 2)), singular, period=1.0)
    with pytest.raises(np.linalg.LinAlgError):  # inside the packages, errors pass as they are
        from_second_order(np.eye(2), np.zeros((2, 2)), singular, period=1.0)


@pytest.mark.parametrize("function", [lumped.geometry, floquet.monodromy, validation.predict])
def test_a_worker_process_finds_a_public_function(function):
    assert pickle.loads(pickle.dumps(function)) is function


def test_a_name_that_does_not_exist_is_an_attribute_error():
    with pytest.raises(AttributeError, match="no_such_name"):
        lumped.no_such_name  # noqa: B018
