"""Is the fastest rate of a machine an eigenvalue of its equations? The steps of an integration rest on it."""

import math

import numpy as np
import pytest
from scipy.linalg import eigvals

from lumped.model.equations import structure
from lumped.model.mesh_cycle import MeshCycle
from lumped.model.periodic_system import LTVSystem
from lumped.quasi_static.contacts import contact_of
from multibody.contact.kinematics import LINEAR
from multibody.contact.machine import Machine, machine
from multibody.contact.records import LINEAR_BLOCKS, opened_table
from tests.unlike_pairs import UNLIKE, unlike_pair

SHAFTS = "contact_ratio_2_3_on_shafts"
#: ``Machine.rates`` reads the stiffness at both ends and in the middle of each polynomial of the law. Between
#: these places the law may be larger by less than this share.
BETWEEN_PLACES = 5e-4
#: Places at which the test reads the law over the path of contact.
PLACES = 4001


def mesh_stiffness(pair):
    """Stiffness of the mesh [N/m]: of every pair that may touch at once the largest of the lumped law."""
    geometry = pair.geometry
    law = MeshCycle(geometry, contact_of(pair).elements(pair)).elements.stiffness
    largest = float(np.abs(law(np.linspace(*law.interval, PLACES)[1:-1])).max())
    return (math.floor(geometry.contact_ratio) + 1) * largest


def fastest_on_springs(pair):
    """Frequency of the fastest mode [rad/s] of the lumped masses, bearings and unit loads."""
    lumped = structure(pair)
    stiffness = np.diag(lumped.stiffness) - mesh_stiffness(pair) * np.outer(lumped.normal, lumped.deflection)
    return math.sqrt(np.abs(eigvals(stiffness / lumped.mass[:, None])).max())


def fastest_on_shafts(pair):
    """Largest modulus of an eigenvalue [rad/s] of the lumped matrix on shafts, with its dampers."""
    system = LTVSystem.of(pair, "elastic", supports="shafts")
    gears = structure(pair)
    size = len(system.coordinates)
    matrix = system.constant.copy()
    by_unit_load = system.reduction @ (gears.normal / gears.mass)
    matrix[size:, :size] += mesh_stiffness(pair) * np.outer(by_unit_load, system.deflection)
    return float(np.abs(np.linalg.eigvals(matrix)).max())


@pytest.mark.parametrize("name", UNLIKE)
def test_on_springs_the_fastest_mode_is_that_of_the_lumped_matrices(name):
    pair = unlike_pair(name).healthy
    rates = machine(pair, LINEAR, "springs").rates
    assert rates.natural == pytest.approx(fastest_on_springs(pair), rel=BETWEEN_PLACES)
    assert rates.damped == rates.natural


def test_on_shafts_the_fastest_rate_is_that_of_the_lumped_matrix():
    pair = unlike_pair(SHAFTS)
    rates = machine(pair, LINEAR, "shafts").rates
    assert rates.damped == pytest.approx(fastest_on_shafts(pair), rel=BETWEEN_PLACES)


def test_bisection_of_all_six_laws_as_one_table_is_seen(monkeypatch):
    """A loaded linear mesh has six laws. One table of all is not sorted, so bisection reads another law.

    Coefficients stand behind both ends of a piece, highest power first, and are padded with zeros before.
    """

    def all_laws(numbers):
        names = ("stiffness", *LINEAR_BLOCKS)
        laws = [opened_table(numbers.packed, numbers.record.blocks[name]) for name in names]
        columns = max(law.shape[1] for law in laws)
        return np.vstack([np.insert(law, [2] * (columns - law.shape[1]), 0.0, axis=1) for law in laws])

    monkeypatch.setattr(Machine, "stiffness_table", property(all_laws))
    pair = unlike_pair(SHAFTS)
    rates = machine(pair, LINEAR, "springs").rates
    assert rates.natural < 0.9 * fastest_on_springs(pair)
