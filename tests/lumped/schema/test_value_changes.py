"""Do other values in fields that a pair has give the pair, or the refusal, of its whole plain data?"""

import math
from unittest import mock

import numpy as np
import pytest

from lumped import GearPair, ParameterError, load_gear_pair
from lumped.fields.units import Quantity
from lumped.schema import pair as pair_module
from lumped.schema.pair import field_at, field_values
from lumped.schema.value_changes import value_changes
from tests.unlike_pairs import UNLIKE, unlike_pair
from validation.prediction.inputs import SEED_FIELDS, uncertain_inputs
from validation.prediction.uncertainty import varied

#: Reliefs with a start of each kind, rolling bearings, an oil by its grade, a law that has a coefficient.
MORE = {
    "pinion.tip_relief": {"amount": 17, "start_diameter": 92.71},
    "gear.tip_relief": {"amount": 12, "length": 3.13},
    "bearings.pinion": {"type": "roller", "number": 13, "size": 9.1},
    "lubricant.viscosity_law": {"iso_vg": 220, "temperature": 60},
    "friction.law": "coulomb",
    "friction.coefficient": 0.05,
}
NAMES = (*UNLIKE, "nasa_28_28 with more sections")


def pair_named(name: str) -> GearPair:
    if name in UNLIKE:
        return unlike_pair(name)
    preset, _, more = name.partition(" ")
    return load_gear_pair(preset).with_(MORE if more else {"name": preset})


def outcome(pair: GearPair, changes: dict) -> object:
    """All that a changed pair holds or has computed, or the problems of its refusal."""
    try:
        changed = pair.with_(changes)
    except ParameterError as error:
        return [(one.field, one.value, one.allowed, one.action) for one in error.problems]
    derived = changed.geometry, changed.wheels, changed.profile_shifts, changed.tip_alteration
    # The next change must not find a difference either.
    next_pair = changed.with_({"pinion.bore": 1.5, "operating.pinion_torque": 31.7})
    return changed, changed.to_toml(), dict(changed.assumed), derived, next_pair.to_toml()


def by_whole_data(pair: GearPair, changes: dict) -> object:
    with mock.patch.object(pair_module, "value_changes", return_value=None):
        return outcome(pair, changes)


def number_fields(pair: GearPair) -> dict[str, tuple[float, Quantity]]:
    """Field with a number -> the number in file units, and how the field is read."""
    result = {}
    for path, value in field_values(pair).items():
        markers = [one for one in field_at(path).metadata if type(one) is Quantity]
        if markers and isinstance(value, (int, float)) and not isinstance(value, bool):
            result[path] = float(value), markers[0]
    return result


def near(value: float) -> float:
    """A value beside the present one."""
    return 1.0009 * value + (value == 0.0) * 1e-3


def around(marker: Quantity) -> list[float]:
    """Values on both sides of each end of the range of a field."""
    values = []
    for bound in (marker.above, marker.at_least, marker.below, marker.at_most):
        if bound is not None:
            step = max(1e-9 * abs(bound), 1e-12)
            values += [bound - step, bound, bound + step]
    return values


@pytest.mark.parametrize("name", NAMES)
def test_one_value_gives_the_pair_of_the_whole_data(name):
    pair = pair_named(name)
    read_as_a_whole = set()
    for path, (value, _) in number_fields(pair).items():
        changes = {path: near(value)}
        wanted = by_whole_data(pair, changes)
        assert outcome(pair, changes) == wanted, changes
        if value_changes(pair, changes) is None and isinstance(wanted, tuple):
            read_as_a_whole.add(path)
    assert {
        path for path in read_as_a_whole if not path.startswith(("basic_rack.", "mesh.stiffness."))
    } == set()


@pytest.mark.parametrize("name", ["nasa_28_28 with more sections", "contact_ratio_2_3_on_shafts"])
def test_both_sides_of_each_range_are_those_of_the_whole_data(name):
    pair = pair_named(name)
    taken = []
    for path, (_, marker) in number_fields(pair).items():
        if name in UNLIKE and not path.startswith("shafts."):
            continue  # as of the other pair
        for value in around(marker):
            wanted = by_whole_data(pair, {path: value})
            assert outcome(pair, {path: value}) == wanted, (path, value)
            taken.append(isinstance(wanted, tuple))
    assert min(sum(taken), len(taken) - sum(taken)) > 20


@pytest.mark.parametrize(
    "changes",
    [
        # The other profile shift follows from the distance: it is no longer assumed.
        {"centre_distance": 88.95, "pinion.profile_shift": 0.004},
        {"pinion.profile_shift": 0.02, "gear.profile_shift": -0.02},
        {"pinion.tip_alteration": 0.01, "pinion.youngs_modulus": 201.0, "friction.law": "iso_14179"},
        {"operating.pinion_speed": "1234 rpm", "operating.pinion_torque": "31.7 N*m"},
        {"operating.pinion_speed": 1e-308},  # a mesh period that is no number
        {"operating.pinion_speed": 1e-322},  # the speed in rad/s is 0, or nearly so
        {"pinion.addendum": 3.1, "pinion.tip_diameter": 95.1},
        {"pinion.mass": 1e-6, "gear.bore": 90.0},
    ],
)
def test_several_values_give_the_pair_of_the_whole_data(changes):
    free = dict.fromkeys(("centre_distance", "pinion.profile_shift", "gear.profile_shift"))
    pair = load_gear_pair("nasa_28_28").with_(free)
    assert outcome(pair, changes) == by_whole_data(pair, changes)


@pytest.mark.parametrize("name", NAMES)
def test_samples_of_all_inputs_are_those_of_the_whole_data(name):
    """At both ends of every input alone, and at points between the ends of all inputs together."""
    pair = pair_named(name)
    inputs = [one for one in uncertain_inputs(pair) if one.field not in SEED_FIELDS]
    ends = [{one: share} for one in inputs for share in (0.0, 1.0)]
    rng = np.random.default_rng(5)
    for shares in [*ends, *(dict(zip(inputs, rng.random(len(inputs)), strict=True)) for _ in range(8))]:
        fields = {}
        for one, share in shares.items():
            fields |= one.changes(float(share))
        if fields.get("mesh.stiffness") == {"model": pair.mesh.stiffness.model}:
            del fields["mesh.stiffness"]
        numbers = {path: value for path, value in fields.items() if path != "mesh.stiffness"}
        assert value_changes(pair, numbers) is not None
        wanted = by_whole_data(pair, fields) if fields else outcome(pair, {})
        if isinstance(wanted, list):
            with pytest.raises(ParameterError):
                varied(pair, [(one, float(share)) for one, share in shares.items()])
            continue
        sampled = varied(pair, [(one, float(share)) for one, share in shares.items()])
        assert (sampled, sampled.to_toml(), dict(sampled.assumed)) == wanted[:3]


@pytest.mark.parametrize(
    "changes",
    [
        {"basic_rack.pressure_angle": 25.0},  # another default of the fillet
        {"pinion.tip_diameter": 92.0},  # an alternative of the tip alteration
        {"lubricant.viscosity_law": {"iso_vg": 100, "temperature": 40}},
        {"bearings.pinion.number": 12},  # rolling bearings in place of springs
        {"mesh.stiffness.ramp_length": 0.2},
        {"operating.pinion_power": 9.0},  # decides the torque
        {"pinion.teeth": 29, "centre_distance": None},
        {"friction.law": "Xu-Kahraman"},  # another spelling
        {"name": "another"},
        {"mesh.backlash": None},
    ],
)
def test_what_changes_more_than_values_is_read_as_a_whole(changes):
    pair = load_gear_pair("nasa_28_28").with_({"pinion.tip_alteration": 0.01})
    assert value_changes(pair, changes) is None
    assert outcome(pair, changes) == by_whole_data(pair, changes)


def test_a_value_that_the_pair_has_already_becomes_known_once():
    pair = load_gear_pair("nasa_28_28")
    field = "mesh.damping_ratio"
    assert field in pair.assumed
    known = pair.with_({field: float(pair.mesh.damping_ratio)})
    assert field not in known.assumed
    assert dict(known.sources)[field] == "varied by the user"
    assert known == by_whole_data(pair, {field: float(pair.mesh.damping_ratio)})[0]
    again = load_gear_pair(known.to_mapping() | {"sources": dict(known.sources) | {field: "measured"}})
    assert dict(again.with_({field: float(pair.mesh.damping_ratio)}).sources)[field] == "measured"


def test_a_change_of_the_tips_moves_the_geometry_and_one_of_the_oil_does_not():
    pair = load_gear_pair("nasa_28_28")
    assert pair.with_({"lubricant.viscosity": 7.0}).geometry is pair.geometry
    shorter = pair.with_({"pinion.tip_alteration": -0.05})
    # The path of contact ends at the tip circle: sqrt(r_a^2 - r_b^2) from the tangent point.
    radius = pair.geometry.tip_radius_pinion - 0.05e-3
    end = math.sqrt(radius**2 - pair.geometry.base_radius_pinion**2)
    path_end = shorter.geometry.L_XD
    assert path_end == pytest.approx(end, rel=1e-12)
