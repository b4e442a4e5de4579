"""Does a field that `fields_read` leaves out change no number, and does every law read what it says?

Numbers are compared bit by bit: what is not read takes no part in any sum.
"""

import warnings
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

import floquet
import lumped
import multibody
from lumped import LawRangeWarning, ParameterError
from lumped.friction import registry
from lumped.friction.base import ContactPath, FrictionSettings
from lumped.friction.registry import LAWS
from lumped.path_of_contact import friction_path_function, pair_stiffness
from lumped.schema import fields_read as translation
from lumped.schema.assumed import within
from lumped.schema.changes import fields_of
from lumped.schema.fields_read import fields_read
from lumped.schema.friction import FRICTION_FIELDS
from lumped.schema.pair import leaf_paths
from lumped.stiffness.base import TOOTH_FORM
from tests.unlike_pairs import UNLIKE, unlike_pair
from validation.prediction.motion import predicted

#: FZG gears have tip diameters and no relief; 28/28 has a composite roughness and relief.
PAIRS = {name: unlike_pair(name) for name in UNLIKE} | {
    name: lumped.load_gear_pair(name) for name in ("fzg_c", "nasa_28_28")
}
pytestmark = pytest.mark.filterwarnings("ignore::lumped.errors.LawRangeWarning")


#: A stiffness of the whole mesh; contact and relief, which the files know, are left to it.
WHOLE = {
    "mesh.stiffness": [3e8, 3.3e8, 3.4e8, 3.1e8, 2.7e8, 2.6e8, 2.8e8, 3e8],
    "mesh.contact": None, "mesh.relief": None,
}  # fmt: skip


def unread(pair: lumped.GearPair) -> list[str]:
    """Fields with a value that the pair does not read."""
    return sorted(leaf_paths(pair).keys() - fields_read(pair) - {"name", "description"})


def moved(pair: lumped.GearPair, fields: list[str]) -> lumped.GearPair:
    """The pair with other values of fields."""
    values = leaf_paths(pair)
    changes = {}
    for path in fields:
        value = values[path]
        _, _, name = path.rpartition(".")
        if isinstance(value, list):
            changes[path] = [1.02 * one for one in value]
        elif pair.mesh.stiffness.whole_mesh and path in ("mesh.contact", "mesh.relief"):
            continue  # it has no other value
        elif name == "shape":
            changes[path] = {"linear": "parabolic", "parabolic": "linear"}[value]
        elif name == "relief":
            changes[path] = {"static": "ignored", "ignored": "static"}[value]
        elif isinstance(value, int):
            changes[path] = {220: 150, 150: 100, 100: 68}.get(value, 220)
        else:
            changes[path] = {
                "bore": 1.1 * value + 0.5,
                "poisson_ratio": 0.9 * value,
                "backlash": value + 0.02,
            }.get(name, 0.97 * value)
    return pair.with_(changes)


def numbers(pair: lumped.GearPair) -> dict[str, object]:
    """What page 1 has, bit by bit: the motion with its numbers and losses, modes, stability."""
    prediction = predicted(pair)
    cycle = {
        name: prediction.cycle[name].to_numpy().tobytes()
        for name in ("dte", "normal_load", "bearing_force_y_g")
    }
    like = pair.healthy
    return {
        **prediction.numbers,
        **prediction.losses,
        **cycle,
        "orders": prediction.bearing_orders.tobytes(),
        "modes": np.asarray(lumped.natural_frequencies(like, supports="springs")).tobytes(),
        "multipliers": floquet.gear_pair_multipliers(like, supports="springs").multipliers.tobytes(),
    }


@cache
def _with_law(name: str, law: str) -> lumped.GearPair:
    return PAIRS[name].with_(law=law)


def differences(pair: lumped.GearPair) -> list[str]:
    """Numbers that a change of everything that the pair does not read changes."""
    one = numbers(pair)
    other = numbers(moved(pair, unread(pair)))
    return [key for key in one if one[key] != other[key]]


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("name", PAIRS)
def test_a_field_that_is_not_read_changes_no_number(name, law):
    try:
        pair = _with_law(name, law)
        predicted(pair)
    except ParameterError:
        pytest.skip("the pair cannot have this law")
    assert len(unread(pair)) > 0
    assert differences(pair) == []


@pytest.mark.parametrize("changes", [
    {"friction.law": "coulomb", "friction.coefficient": 0.05},
    {"mesh.stiffness": {"model": "rectangular", "pair_stiffness": 3e8}},
    {"mesh.stiffness": {"model": "parabolic", "peak": 4e8, "end_ratio": 0.6}},
    WHOLE,
    WHOLE | {"gear.deviations": {"tolerance_class": 6}},
    {"pinion.mass": 0.9, "pinion.inertia": 4e-4, "gear.mass": 2.1, "gear.inertia": 3e-3},
    {"gear.deviations": {"tolerance_class": 6}},
    {"pinion.faults": [{"kind": "crack", "tooth": 2, "depth": 0.6}]},
    {"mesh.contact": "prescribed", "mesh.relief": "ignored"},
    {"lubricant.viscosity_law": {"iso_vg": 150, "temperature": 65}, "friction.law": "none"},
], ids=lambda changes: next(iter(changes)))  # fmt: skip
def test_values_that_take_the_place_of_others_leave_those_unread(changes):
    for name in ("rack_25_degrees_always_pushing", "larger_gear_drives_contact_lost"):
        pair = PAIRS[name].with_(changes)
        assert differences(pair) == []


def test_a_stiffness_of_the_whole_mesh_has_contact_and_profile_in_it():
    pair = PAIRS["heavily_relieved_under_load"].healthy
    profile = {"mesh.contact", "mesh.relief", "pinion.tip_relief.amount"}
    assert profile <= fields_read(pair)
    whole_mesh = pair.with_(WHOLE)
    assert profile <= {*unread(whole_mesh)}
    assert differences(whole_mesh) == []


def test_a_gear_on_a_shaft_is_a_body_of_its_material():
    """The rim turns against the bore, whatever the stiffness of the teeth is."""
    bodies = {"pinion.mass": 4.1, "pinion.inertia": 6e-3, "gear.mass": 9.3, "gear.inertia": 5e-2}
    model = {"model": "rectangular", "pair_stiffness": 3e8}
    pair = PAIRS["contact_ratio_2_3_on_shafts"].with_(
        bodies | {"mesh.stiffness": model, "friction.law": "none"}
    )
    assert {"gear.poisson_ratio", "pinion.bore"} <= fields_read(pair)
    assert "gear.density" in unread(pair)
    assert differences(pair) == []


def test_a_law_of_the_user_reads_its_table_alone():
    pair = PAIRS["fzg_c"].with_(law=lambda xi: 0.03 + 2.0 * xi, stiffness=lambda xi: 2e8 + 1e9 * xi)
    unread_fields = unread(pair)
    assert {"lubricant.viscosity", "friction.maximum", "pinion.roughness"} < {*unread_fields}
    assert "friction.table.coefficient" in fields_read(pair)
    assert "friction.table.coefficient" not in fields_read(pair.with_(law="coulomb"))
    assert differences(pair) == []


@pytest.mark.parametrize("name", ["rack_25_degrees_always_pushing", "larger_gear_drives_contact_lost"])
def test_the_second_model_reads_no_more(name):
    """Where contact is lost the backs of its teeth may strike, after the backlash."""
    pair = PAIRS[name]
    read = fields_read(pair, contact_lost=True)
    assert read - fields_read(pair) == {"mesh.backlash"}
    other = moved(pair, [path for path in unread(pair) if path not in read])
    one, two = (multibody.simulate(p, cycles=2) for p in (pair, other))
    for variable in ("dte", "normal_load", "x_p", "friction_force"):
        assert one[variable].to_numpy().tobytes() == two[variable].to_numpy().tobytes()


@pytest.mark.parametrize("missing", ["viscosity", "roughness", "effective_modulus"])
def test_a_law_that_hides_what_it_reads_is_seen(monkeypatch, missing):
    law = LAWS["xu_kahraman"]
    wrong = replace(law, reads=law.reads - {missing})
    monkeypatch.setattr(translation, "law_of", lambda settings: wrong)
    assert differences(PAIRS["rack_25_degrees_always_pushing"].with_(law="xu_kahraman")) != []


def _laws_of(pair: lumped.GearPair) -> bytes:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", LawRangeWarning)
        law = friction_path_function(pair, warn=False)
    return law.coefficients.tobytes() + law.breaks.tobytes()


#: Oils that are thin to thick at any temperature, and that are cold or warm.
OILS = (
    *({"lubricant.viscosity": value, "lubricant.viscosity_law": None} for value in (3.0, 12.0, 60.0, 400.0)),
    *(
        {"lubricant.viscosity": None, "lubricant.viscosity_law": {"iso_vg": 100, "temperature": celsius}}
        for celsius in (20.0, 80.0)
    ),
)


@pytest.mark.parametrize(("law", "name"), [
    (law.name, name) for law in LAWS.values() for name in sorted(law.reads)
])  # fmt: skip
def test_a_law_reads_nothing_in_vain(law, name):
    """At least one pair, in thin or thick, cold or warm oil, has another mu with another value.

    Parameters that are 0, and so without effect, are 0.005 here.
    """
    for pair in PAIRS.values():
        without_effect = {
            path: 0.005
            for path, value in leaf_paths(pair).items()
            if path.startswith("friction.") and isinstance(value, float) and value == 0.0
        }
        for oil in OILS:
            changes = {"friction.law": law} | oil | without_effect
            changes |= {"friction.coefficient": 0.06} if name == "coefficient" else {}
            changes |= {"friction.composite_roughness": 0.5} if name == "composite_roughness" else {}
            varied = pair.with_(changes)
            paths = {path for field in FRICTION_FIELDS[name] for path in fields_of(field)}
            fields = {leaf for leaf in leaf_paths(varied) if any(within(leaf, path) for path in paths)}
            if name == "composite_roughness":
                fields = {"friction.composite_roughness"}
            try:
                if _laws_of(varied) != _laws_of(moved(varied, sorted(fields))):
                    return
            except ParameterError:  # law II has no rough flanks, III no oil as thin
                continue
    pytest.fail(f"no pair has another mu of {law} with another {name}")


def test_every_name_of_the_contact_and_the_settings_has_its_fields():
    """Those of places, speeds and load are read by every pair."""
    always = {
        "L_XA",
        "L_XP",
        "L_XD",
        "L_XY",
        "omega_pinion",
        "omega_gear",
        "pitch_line_velocity",
        "unit_load",
        "edge_pinion",
        "edge_gear",
        "law_two_mean",
        "friction_factor",  # of the fields of each factor, see tests/lumped/friction/test_factors.py
    }
    names = {*ContactPath.__dataclass_fields__} - always | {*FrictionSettings.__annotations__} - {"law"}
    assert names == {*FRICTION_FIELDS}
    assert all(law.reads is not None and law.reads <= names for law in registry.LAWS.values())


@pytest.mark.parametrize("model", [
    {"model": "rectangular"}, {"model": "parabolic"}, {"model": "energy"}, {"model": "finite_elements"},
], ids=lambda model: model["model"])  # fmt: skip
def test_a_stiffness_model_reads_what_it_says(model):
    pair = PAIRS["larger_gear_drives_contact_lost"].with_({"mesh.stiffness": model})
    coefficients = pair_stiffness(pair).coefficients.tobytes()
    for field in sorted(TOOTH_FORM):
        for one in fields_of(field):
            other = moved(pair, [one])
            assert (pair_stiffness(other).coefficients.tobytes() != coefficients) == (
                field in pair.mesh.stiffness.reads
            ), one
