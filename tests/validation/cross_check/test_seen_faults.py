"""Does the cross-check see a wrong number or formula in the lumped model that unit tests alone would catch?

Each fault is put into ``lumped`` at run time. At fidelity "linear" both models solve the same equations, so
any number that the multibody model works out for itself must differ beyond the tolerance of integration.
"""

import contextlib
import sys
from dataclasses import replace

import numpy as np
import pytest

import lumped
from lumped import PathFunction
from lumped.friction.base import ContactPath
from lumped.model.equations import structure
from lumped.path_of_contact.friction import contact_path
from lumped.quasi_static.contacts import mesh_elements
from lumped.quasi_static.tooth_error import error_function
from lumped.schema.bodies import solid_disc
from lumped.schema.pair import GearPair
from validation.cross_check.comparison import crosscheck

SLOW = lumped.load_gear_pair("fzg_c").with_(
    mesh__stiffness={"model": "parabolic"},
    bearings__pinion__loa_stiffness=2e8,
    bearings__gear__oloa_damping_ratio=0.08,
)
RELIEVED = SLOW.with_(
    mesh__relief="static", pinion__tip_relief={"shape": "parabolic", "amount": 20.0, "start_roll_angle": 30.0}
)
LAWS = {
    name: SLOW.with_(friction__law=name)
    for name in ("coulomb", "benedict_kelley", "xu_kahraman", "smoothed_coulomb", "composite")
}
#: Law V with its first threshold inside the path of contact, so that the film decides.
THRESHOLD = LAWS["composite"].with_(friction__thresholds=[0.55, 4.0, 10.0])


def scaled(function, factor):
    return lambda *args, **kwargs: factor * function(*args, **kwargs)


def element(name, factor):
    """Element law of the lumped model times a factor."""

    def wrong(pair):
        found = mesh_elements(pair)
        return replace(found, **{name: getattr(found, name).scaled(factor)})

    return "lumped.model.mesh_cycle", "mesh_elements", wrong


def equations(**changes):
    """Data of the equations of motion, changed."""

    def wrong(pair, as_printed=()):
        found = structure(pair, as_printed)
        return replace(found, **{name: change(getattr(found, name)) for name, change in changes.items()})

    return "lumped.model.periodic_system", "structure", wrong


def contact(**changes):
    """Data of the nominal contact that the friction laws read, changed."""

    def wrong(pair):
        found = contact_path(pair)
        return replace(found, **{name: change(getattr(found, name)) for name, change in changes.items()})

    return "lumped.path_of_contact.friction", "contact_path", wrong


def kinematics(name, factor):
    return ContactPath, name, scaled(getattr(ContactPath, name), factor)


def relief(shift):
    def wrong(pair):
        found = error_function(pair)
        breaks = found.breaks.copy()
        breaks[1:-1] += shift
        return PathFunction(breaks, found.coefficients, breaks[1:-1])

    return "lumped.quasi_static.prescribed", "error_function", wrong


def disc(factor):
    return "lumped.schema.bodies", "solid_disc", lambda *a: tuple(factor * value for value in solid_disc(*a))


def tips(more):
    true = GearPair._tip_radius
    return GearPair, "_tip_radius", lambda pair, gear: true(pair, gear) + more


FAULTS = {
    "friction 1 % high": (LAWS["coulomb"], element("friction", 1.01)),
    "damping 1 % high": (LAWS["coulomb"], element("damping", 1.01)),
    "law II: Pa s for mPa s": (LAWS["benedict_kelley"], contact(viscosity=lambda x: 1e-3 * x)),
    "law II: sliding in mm/s": (LAWS["benedict_kelley"], kinematics("sliding_velocity", 1e3)),
    "law II: roughness 5 % high": (LAWS["benedict_kelley"], contact(roughness=lambda x: 1.05 * x)),
    "law III: radius in mm": (LAWS["xu_kahraman"], kinematics("radius", 1e3)),
    "law III: rolling velocity doubled": (LAWS["xu_kahraman"], kinematics("entraining_velocity", 2.0)),
    "law III: modulus of one body": (LAWS["xu_kahraman"], contact(effective_modulus=lambda x: 0.5 * x)),
    "law III: unit load over both widths": (LAWS["xu_kahraman"], contact(unit_load=lambda x: 0.5 * x)),
    "law IV: mean by other bounds": (
        LAWS["smoothed_coulomb"],
        ("lumped.friction.benedict_kelley", "mean_coefficient", lambda *a: 0.07),
    ),
    "law V: film velocity halved": (THRESHOLD, kinematics("film_thickness", 0.5**0.69)),
    "masses 1 % high": (LAWS["coulomb"], disc(1.01)),
    "bearing directions swapped": (LAWS["coulomb"], equations(damping=lambda d: d[[0, 1, 4, 5, 2, 3]])),
    "lever of friction": (
        LAWS["coulomb"],
        equations(friction_arm=lambda a: a * np.array([[1.0, 1.02]] + 5 * [[1.0, 1.0]])),
    ),
    "relief starts late": (RELIEVED, relief(2e-4)),
    "relief amount 5 % low": (RELIEVED, element("error", 0.95)),
    "tip radius": (LAWS["coulomb"], tips(5e-5)),
}


@pytest.mark.parametrize("name", ["coulomb", "composite", "relieved", "threshold"])
def test_without_a_fault_every_quantity_agrees(name):
    pair = {"relieved": RELIEVED, "threshold": THRESHOLD}.get(name) or LAWS[name]
    found = crosscheck(pair, cycles=6, samples_per_cycle=32, fidelities=("linear",))
    assert all(a.within for a in found.agreements), found.worst("linear")


@pytest.mark.parametrize("name", FAULTS)
def test_a_fault_in_the_lumped_model_is_seen(name, monkeypatch):
    """A model without a motion is no confirmation either."""
    pair, (place, attribute, wrong) = FAULTS[name]
    monkeypatch.setattr(sys.modules[place] if isinstance(place, str) else place, attribute, wrong)
    # No function keeps what it found for the sound model: the pair is one of its own.
    pair = pair.with_(operating__pinion_torque=135.0 + 1e-3 * (1 + list(FAULTS).index(name)))
    with contextlib.suppress(lumped.NumericalError):
        worst = crosscheck(pair, cycles=6, samples_per_cycle=32, fidelities=("linear",)).worst("linear")
        assert worst.difference > 100.0 * worst.limit
