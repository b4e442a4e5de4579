"""Does a field of any preset, read and written back, leave the pair as it is? One test over all fields."""

import copy
import math
import pickle
import tomllib

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from lumped import ParameterError, load_gear_pair, preset_names
from lumped.fields.section import Section
from lumped.fields.units import UNITS, SIValue
from lumped.labelling import parameters_hash
from lumped.schema.pair import leaf_paths

#: Sections that no preset has, so that their fields are tried too.
FAULTS = [
    [{"kind": "crack", "tooth": 4, "depth": 0.7, "angle": 71.3}, {"kind": "spall", "tooth": 1,
     "start_roll_angle": 18.3, "end_roll_angle": 21.7, "width": 2.3}],
    [{"kind": "spall", "tooth": 2, "start_roll_angle": 18.3, "end_roll_angle": 21.7, "width": 3.1,
     "pit_depth": 33.3}],
    [{"kind": "chip", "tooth": 28, "roll_angle": 27.3}],
]  # fmt: skip
ROLLERS = {"type": "roller", "number": 13, "size": 9.1, "contact_angle": 12.3, "stiffness_factor": 0.71}
STARTS = ({"start_roll_angle": 28.3}, {"start_diameter": 92.71}, {"length": 3.13})
ROOTS = ({"start_roll_angle": 13}, {"start_diameter": "3.41 inch"}, {"length": 1.77})
MORE = {
    "mesh.stiffness": [
        {"model": "energy", "ramp_length": 0.3},
        {"model": "parabolic", "peak": 8e7, "end_ratio": 0.6, "ramp_length": 0.2},
        {"model": "rectangular", "pair_stiffness": "90 N/um"},
        {"model": "table", "axis": "phase", "points": [0, 0.5, 1, 1.7], "stiffness": [4e7, 5e7, 5e7, 4e7]},
    ],
    "lubricant.viscosity_law": [
        {"iso_vg": 220, "temperature": 60},
        {"kinematic_viscosity_40": 220, "kinematic_viscosity_100": 19, "temperature": "140 degF"},
    ],
    **{f"{gear}.tip_relief": [{"amount": 17, **start} for start in STARTS] for gear in ("pinion", "gear")},
    **{f"{gear}.root_relief": [{"amount": 3.3, **start} for start in ROOTS] for gear in ("pinion", "gear")},
    **{
        gear: [
            {"teeth": 28, "face_width": 6.1, "roughness": 0.7, "tip_diameter": 95.1, "bore": 31.3},
            {"teeth": 28, "face_width": 6.1, "roughness": 1, "addendum": 3.1, "mass": 0.31, "inertia": 3e-4},
        ]
        for gear in ("pinion", "gear")
    },
    "operating.brake_torque": [56.3],
    "bearings.pinion": [ROLLERS],
    "bearings.gear": [ROLLERS | {"type": "ball", "number": 7}],
    "operating.torque_ripple": [[{"shaft": "gear", "order": 2, "amplitude": 2.1, "phase": 33.3}]],
    "mesh.first_teeth": [[3, 5]],
    **{f"{gear}.mounting": [{"eccentricity": 12.3, "phase": 31.7}] for gear in ("pinion", "gear")},
    **{
        f"{gear}.deviations": [
            {"tolerance_class": 6, "seed": 3},
            {"index": [0.1 * j for j in range(28)], "counted": "against", "first_order": "steps"},
            {"index": ["1 um", *[0.3] * 27], "profile_slope": [1.1] * 28, "tip_relief": [2.3] * 28},
        ]
        for gear in ("pinion", "gear")
    },
    **{f"{gear}.faults": FAULTS for gear in ("pinion", "gear")},
    "friction": [{"law": "V", "coefficient": 0.07, "composite_roughness": 0.77, "sharpness": 33.3}],
}  # fmt: skip
PAIRS = [load_gear_pair(name) for name in preset_names()]
NASA = load_gear_pair("nasa_28_28")
PAIRS += [NASA.with_({path: value}) for path, values in MORE.items() for value in values]
PAIRS.append(NASA.with_({"pinion.tip_alteration": -0.2, "gear.tip_alteration": -0.1}))
PAIRS.append(NASA.with_(law=lambda sliding_velocity: 0.01 * sliding_velocity))


@pytest.fixture(scope="module")
def shafted(shaft_tables):
    return NASA.with_(shafts=shaft_tables)


@pytest.fixture(scope="module")
def known_fields(shafted):
    """Of every pair, its fields with what they read as."""
    return [dict(fields(pair)) for pair in (*PAIRS, shafted)]


def fields(section, prefix=""):
    for name in type(section).model_fields:
        value = getattr(section, name)
        yield f"{prefix}{name}", value
        if isinstance(value, Section):
            yield from fields(value, f"{prefix}{name}.")
        elif isinstance(value, tuple):
            for number, entry in enumerate(value):
                if isinstance(entry, Section):
                    yield from fields(entry, f"{prefix}{name}.{number}.")


@pytest.mark.parametrize("pair", [*PAIRS, None], ids=lambda pair: pair.name if pair else "shafts")
def test_what_a_field_reads_as_can_be_written_back(pair, shafted):
    pair = pair or shafted
    values = dict(fields(pair))
    assert len(values) > 50
    for path, value in values.items():
        _, _, key = path.rpartition(".")
        if key != "model":  # the model of a section goes with its section
            assert leaf_paths(pair.with_({path: value})) == leaf_paths(pair), path
        if path.endswith("start_roll_angle") and path not in leaf_paths(pair):
            # A relief that a diameter or a length states: typing the angle states the same start by it.
            assert dict(fields(pair.with_({path: repr(value)})))[path] == value
        elif isinstance(value, SIValue):  # what is shown may be typed again
            assert (
                pair.with_({path: repr(value)}).to_toml().split("[sources]")[0]
                == (pair.to_toml().split("[sources]")[0])
            ), path
    assert leaf_paths(pair.with_(values)) == leaf_paths(pair)
    assert load_gear_pair(tomllib.loads(pair.to_toml())) == pair


def test_every_number_with_a_unit_shows_it(quantity_field, known_fields):
    path, quantity = quantity_field
    values = [values_of_pair[path] for values_of_pair in known_fields if path in values_of_pair]
    values = [value for value in values if value is not None and not isinstance(value, str)]
    assert values, "no pair of the test has this field"
    for value in values:
        if quantity.unit == "1":
            assert type(value) is float
        else:
            assert value.unit == UNITS[quantity.unit].si
            assert repr(value).endswith(f" {value.unit}")
            assert quantity.parse(value) == value


def test_a_value_of_another_kind_is_refused(nasa):
    with pytest.raises(ParameterError, match=r"56.5 N\*m is not a rotational speed"):
        nasa.with_(operating__pinion_speed=nasa.operating.pinion_torque)


@pytest.mark.parametrize("kind", [np.float64, np.float32, np.int64, int])
def test_numbers_of_numpy_are_numbers(nasa, kind):
    varied = nasa.with_(operating__pinion_speed=kind(3000), pinion__teeth=np.int64(28))
    assert varied.operating.pinion_speed == pytest.approx(100 * math.pi, rel=1e-15)


class TestValue:
    @pytest.mark.parametrize(("path", "unit", "number"), [
        ("operating.pinion_speed", "rpm", 4875.0),
        ("operating.pinion_speed", "Hz", 81.25),
        ("operating.pinion_speed", "1/min", 4875.0),
        ("pinion.face_width", "mm", 6.35),
        ("pinion.face_width", "inch", 0.25),
        ("gear.youngs_modulus", "N/mm2", 206e3),
        ("operating.pinion_torque", "in-lb", 56.5 / 0.0254 / 4.4482216152605),
    ])  # fmt: skip
    def test_in_another_unit(self, nasa, path, unit, number):
        assert dict(fields(nasa))[path].to(unit) == pytest.approx(number, rel=1e-14)

    def test_a_temperature(self):
        assert SIValue(333.15, "K").to("degF") == pytest.approx(140.0)
        assert SIValue(333.15, "K").to("degC") == pytest.approx(60.0)

    def test_another_kind_is_refused(self, nasa):
        for unit in ("mm", "Nm", "parsnips", ""):
            with pytest.raises(ParameterError, match="a unit that rad/s converts to"):
                nasa.operating.pinion_speed.to(unit)

    def test_a_formula_gives_a_bare_number(self, nasa):
        speed = nasa.operating.pinion_speed
        for result in (1.1 * speed, speed / 2, -speed, speed + speed, np.float64(2) * speed):
            assert not isinstance(result, SIValue)

    def test_it_is_copied_and_sent_with_its_unit(self, nasa):
        speed = nasa.operating.pinion_speed
        for again in (copy.deepcopy(speed), pickle.loads(pickle.dumps(speed))):
            assert (repr(again), again.unit) == (repr(speed), "rad/s")
        assert f"{speed}" == str(float(speed))


# Control characters but for tab and line ends are refused.
readable = st.characters(exclude_categories=("Cc", "Cs")) | st.sampled_from("\t\n\r")


@settings(max_examples=40)
@given(text=st.text(readable, max_size=200))
def test_any_text_survives(text):
    pair = load_gear_pair("nasa_28_28").with_(description=text, sources={"mesh": text})
    assert load_gear_pair(tomllib.loads(pair.to_toml())) == pair


def test_a_different_pair_has_a_different_hash(nasa):
    assert parameters_hash(nasa) != parameters_hash(nasa.with_(mesh__damping_ratio=0.0500000001))
