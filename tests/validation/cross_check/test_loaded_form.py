"""Does the cross-check judge loaded contact: what it predicts meets the exact contact, and faults do not?"""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

import lumped
import multibody
from lumped.quasi_static import loaded_contact
from lumped.quasi_static.loaded import StaticMesh
from validation.cross_check import loaded_motion
from validation.cross_check.comparison import crosscheck
from validation.cross_check.effective_elements import Lines
from validation.cross_check.finite_motion import finite_motion

EQUAL = lumped.load_gear_pair("nasa_28_28").with_(
    mesh__stiffness={"model": "energy"}, mesh__contact="loaded", mesh__relief="ignored"
)
#: The corner of the gear's tip stands a seventh of a radian from the line of action; soft bearings.
UNEQUAL = lumped.load_gear_pair("fzg_c").with_(
    mesh__stiffness={"model": "energy"}, mesh__contact="loaded", operating__pinion_speed=1000
)
RELIEF = EQUAL.with_(mesh__relief="static")
QUICK = {"cycles": 6, "samples_per_cycle": 64}


EVERY = {"tip_contact", "rotation_phase", "moving_line", "path_work"}


@pytest.mark.parametrize(
    ("pair", "effects"),
    [
        (UNEQUAL, {"tip_contact"}),
        (UNEQUAL, EVERY),
        (EQUAL, EVERY),
    ],
    ids=["contact", "all", "all, equal"],
)
def test_the_exact_contact_is_met_from_the_lumped_model_alone(pair, effects):
    """Without friction; the motion is read at 4096 times a cycle and settles to some 1e-9 m.

    Without the forces of corners across the line of action, all of y would be left.
    """
    pair = pair.with_(friction__law="none")
    cycle = lumped.steady_state(pair, samples_per_cycle=128)
    predicted = finite_motion(pair, cycle, effects)
    run = multibody.steady_state(
        pair,
        samples_per_cycle=128,
        effects=effects | {"contact_law", "neighbours", "contact_loss"},
        rtol=1e-10,
    )
    swing = np.ptp(cycle["dte"].to_numpy())
    for name, least in (("dte", 5e-3), ("y_p", 3e-3)):
        change = run[name].to_numpy() - cycle[name].to_numpy()
        left = change - predicted.changes[name]
        assert np.abs(change).max() > least * swing, name
        assert np.abs(left).max() < 2e-3 * swing, name
        assert np.linalg.norm(left) < 0.03 * np.linalg.norm(change), name


@pytest.mark.parametrize(("relief", "most"), [("ignored", 0.02), ("static", 0.03)])
def test_the_loaded_form_meets_the_exact_contact(relief, most):
    """Over peak to peak at 2000 rpm: 0.011 and 0.015 measured; prescribed contact is off by 0.8 and 0.04."""
    pair = lumped.load_gear_pair("nasa_28_28").with_(
        {
            "mesh.stiffness": {"model": "energy"},
            "mesh.contact": "loaded",
            "mesh.relief": relief,
        }
    )
    pair = pair.with_(operating__pinion_speed=2000.0)
    exact, own = (
        model.steady_state(pair, samples_per_cycle=256)["dte"].to_numpy() for model in (multibody, lumped)
    )
    difference = (exact - exact.mean()) - (own - own.mean())
    assert np.abs(difference).max() < most * np.ptp(exact)


def test_the_damper_reads_the_slope_of_the_gap_at_its_place_and_not_beside_it():
    """Lines through the gap of a corner, b^2, have the slope of half a step further on."""
    nodes = np.linspace(0.0, 1.0, 9)
    lines = Lines.between((0.0, 1.0), np.empty(0), nodes, nodes)
    values = lines.inner**2
    slope = lines.bent_through(values, lines.inner.mean(axis=0) ** 2).slope
    np.testing.assert_allclose(slope(nodes[:-1]), 2.0 * nodes[:-1], atol=1e-14)
    np.testing.assert_allclose(lines.through(values).slope(nodes[:-1]), 2.0 * nodes[:-1] + 0.125)


@pytest.fixture(scope="module")
def equal():
    """The cross-check of the equal pair, with that of its twin."""
    return crosscheck(EQUAL, **QUICK)


@pytest.mark.parametrize("pair", [EQUAL, UNEQUAL, RELIEF], ids=["equal", "unequal", "relief"])
def test_a_sound_pair_is_confirmed(pair, equal):
    check = equal if pair is EQUAL else crosscheck(pair, **QUICK, twin=False)
    assert check.verdict == "confirmed", check.failures
    dte = next(a for a in check.of("exact") if a.quantity == "dte")
    # The prediction leaves a twentieth of its limit, so that a fault has no room.
    assert dte.remainder_l2 < 0.25 * dte.tolerance.limit


def test_the_twin_of_a_loaded_pair_is_checked_too(equal):
    assert equal.twin is not None
    assert equal.twin.pair.mesh.contact == "loaded"
    assert equal.twin.verdict == "confirmed", equal.failures


def test_the_brake_pays_for_every_loss_in_both_models(equal):
    exact = equal.powers["exact"]
    assert abs(exact["mesh_stiffness"]) < 1e-8 * exact["driving"]
    lost = exact["friction"] + exact["bearings"] + exact["mesh_damping"]
    assert exact["driving"] - exact["braking"] == pytest.approx(lost, rel=1e-5)


def _scaled(law, factor):
    return dataclasses.replace(law, coefficients=factor * law.coefficients)


def softer(m):
    true = loaded_contact.pair_stiffness
    m.setattr(loaded_contact, "pair_stiffness", lambda pair: _scaled(true(pair), 0.97))


def relief_halved(m):
    true = StaticMesh.relief
    m.setattr(StaticMesh, "relief", lambda self, place: 0.5 * true(self, place))


def corners_push_along_the_line_alone(m):
    true = loaded_motion.PushedSystem.forces

    def along(self, time):
        forces = true(self, time)
        forces[:, 4:] = 0.0
        return forces

    m.setattr(loaded_motion.PushedSystem, "forces", along)


#: Other faults of loaded contact are judged by the catalogue of `tests.evidence.faults`, group "contact".
FAULTS = {
    softer: EQUAL,
    relief_halved: RELIEF,
    corners_push_along_the_line_alone: UNEQUAL,
}


@pytest.mark.parametrize("fault", FAULTS, ids=lambda f: f.__name__)
def test_a_fault_in_the_loaded_form_is_not_confirmed(fault, monkeypatch):
    loaded_contact._loaded_contact.cache_clear()
    fault(monkeypatch)
    try:
        check = crosscheck(FAULTS[fault], **QUICK, twin=False)
    finally:
        loaded_contact._loaded_contact.cache_clear()
    assert check.verdict == "not confirmed"
