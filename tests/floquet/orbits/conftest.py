"""Systems with unilateral contacts that have closed solutions, or hard events."""

import numpy as np
import pytest

from floquet.orbits.system import Contact, ContactSystem


@pytest.fixture
def bouncer():
    """A mass that gravity presses on an undamped spring without clearance: z'' = g - k z where z > 0."""

    def make(gravity=9.0, stiffness=400.0, damping=0.0):
        return ContactSystem(
            stiffness=[[0.0]], damping=[[0.0]], force=[gravity],
            contacts=(Contact([1.0], [-1.0], stiffness, damping),), phases=[0.0, 1.0], output=[1.0],
        )  # fmt: skip

    return make


@pytest.fixture
def meissner():
    """A Meissner oscillator that may bounce: k jumps between 1 + e and 1 - e in the middle of the period."""

    def make(e=0.4, damping=0.1, force=1.0):
        return ContactSystem(
            stiffness=[[0.0]], damping=[[0.0]], force=[force],
            contacts=(Contact([1.0], [-1.0], [[1.0 + e], [1.0 - e]], damping),), phases=[0.0, 0.5, 1.0],
            output=[1.0],
        )  # fmt: skip

    return make


@pytest.fixture
def gearlike():
    """Two masses, two contacts with clearances and polynomial coefficients, and a row that gathers."""
    k = np.array([[3.0, 1.0, -0.5], [2.5, -1.0, 0.3]])
    return ContactSystem(
        stiffness=[[0.6, -0.1], [-0.1, 0.9], [0.2, 0.0]],
        damping=[[0.03, 0.0], [0.0, 0.04], [0.0, 0.01]],
        force=[0.3, -0.1, 0.2],
        contacts=(
            Contact(
                [1.0, -1.0], np.array([[[-1.0, 0.1], [0.8, 0.05], [0.3, 0.0]]] * 2), k, 0.2, [[0.0, 0.1]] * 2
            ),
            Contact(
                [1.0, -1.0],
                [-0.9, 0.7, -0.2],
                0.5 * k,
                0.1,
                [[0.05, 0.0], [0.05, -0.2]],
                present=[False, True],
            ),
        ),
        phases=[0.0, 0.45, 1.0],
        output=[1.0, -1.0],
        parameter_force=[0.1, 0.0, -1.0],
    )
