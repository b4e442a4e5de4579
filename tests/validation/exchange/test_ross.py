"""Are rotors of ROSS taken as they are, and joined as ROSS itself joins them?"""

from __future__ import annotations

import importlib.util
from pathlib import Path

import numpy as np
import pytest
from numpy.polynomial.legendre import leggauss
from scipy.linalg import block_diag

from floquet.gear.rotors import _deflection
from lumped.errors import ParameterError
from lumped.model.mesh_cycle import mesh_cycle
from validation.exchange import ross_rotor

EXAMPLE = Path(__file__).resolve().parents[3] / "examples" / "25_gears_on_rotors.py"


@pytest.fixture(scope="module")
def example():
    spec = importlib.util.spec_from_file_location(EXAMPLE.stem, EXAMPLE)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_what_is_no_rotor_of_ross_is_refused():
    with pytest.raises(ParameterError, match=r"ross\.Rotor"):
        ross_rotor(object(), 2, 1000.0)


@pytest.mark.filterwarnings("ignore")
def test_the_mesh_is_that_of_ross_and_the_stored_rotor_its_own(example):
    ross = pytest.importorskip("ross", reason="the extra 'ross' is not installed")
    rotor = example.ross_shaft()
    with np.load(EXAMPLE.with_name("25_rotor.npz")) as file:
        for name, own in (("M", rotor.M()), ("C", rotor.C(0.0)), ("K", rotor.K(0.0)), ("G", rotor.G())):
            np.testing.assert_allclose(file[name], own, rtol=1e-12, atol=1e-12 * np.abs(own).max())

    joined = ross.MultiRotor(
        rotor, rotor, coupled_nodes=(2, 2), gear_mesh_stiffness=1.0, orientation_angle=0.7
    )
    pinion, gear = ross_rotor(rotor, 2, 3000.0), ross_rotor(rotor, 2, -3000.0)
    np.testing.assert_allclose(block_diag(pinion.C, gear.C) - block_diag(rotor.C(0.0), rotor.C(0.0)),
                               100.0 * np.pi * joined.G(), atol=1e-12)  # fmt: skip
    v = _deflection(mesh_cycle(example.PAIR), pinion, gear, 0.7)
    # ROSS counts the driven gear's rotation in its own sense.
    v[len(pinion.M) + gear.station[2]] *= -1.0
    mesh = joined.K(0.0) - block_diag(rotor.K(0.0), rotor.K(0.0))
    # Of the difference of large numbers 1e-16 of their size is left.
    np.testing.assert_allclose(mesh, np.outer(v, v), atol=1e-15 * np.abs(rotor.K(0.0)).max())
    with pytest.raises(ParameterError, match="node"):
        ross_rotor(rotor, 7, 1000.0)


def test_the_mode_of_the_tongue_is_that_of_ross(example):
    # Ninth mode of ross.MultiRotor (2.3.0) of both shafts without damping, with the mean mesh stiffness.
    system = example.on_shafts(19000.0)
    x, weights = leggauss(8)
    start, width = system.edges[:-1, None], np.diff(system.edges)[:, None]
    A = system.evaluate((start + 0.5 * width * (x + 1.0)).ravel())
    mean = np.tensordot((0.5 * width * weights).ravel() / system.period, A, axes=1)
    frequencies = np.sqrt(np.sort(np.linalg.eigvals(-mean[9:, :9]).real)) / (2.0 * np.pi)
    assert frequencies[8] == pytest.approx(4544.12869547, rel=1e-7)
