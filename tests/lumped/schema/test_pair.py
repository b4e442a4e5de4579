"""Does the schema give one value to one input: units, alternatives, defaults, variations?"""

import copy
import math
import tomllib

import pytest

from lumped import GearPair, ParameterError, json_schema, load_gear_pair, preset_names
from lumped.fields.refusals import models_in
from lumped.fields.units import UNITS
from lumped.schema.files import preset_text
from lumped.schema.pair import leaf_paths, stated_unit


def test_pair_is_frozen_and_hashable(nasa):
    with pytest.raises(ParameterError):
        nasa.name = "other"
    with pytest.raises(ParameterError):
        nasa.pinion.teeth = 30
    again = load_gear_pair("nasa_28_28").with_(mesh__contact="prescribed", mesh__relief="ignored")
    assert again == nasa
    assert hash(again) == hash(nasa)
    assert len({nasa, again, nasa.with_(mesh__damping_ratio=0.06)}) == 2


def test_a_pair_shows_itself_in_a_line(nasa):
    line = "<GearPair nasa_28_28: 28/28 teeth, module 3.175 mm, face widths 6.35/6.35 mm, 4875 rpm, 56.5 N m"
    assert repr(nasa) == str(nasa) == f"{line}, friction xu_kahraman>"


@pytest.mark.parametrize("name", preset_names())
def test_a_notebook_shows_every_field_with_its_unit(name):
    pair = load_gear_pair(name).with_(name="a<b", operating__pinion_speed=1450)
    text = pair._repr_html_()
    assert "a&lt;b" in text
    assert "a<b" not in text
    assert "<td>operating.pinion_speed</td><td>1450.0</td><td>rpm</td>" in text
    assert text.count("<tr>") == len(leaf_paths(pair))


def test_the_same_pair_from_name_file_and_mapping(nasa, tmp_path):
    path = tmp_path / "pair.toml"
    path.write_text(nasa.to_toml(), encoding="utf-8")
    assert load_gear_pair(path) == load_gear_pair(str(path)) == load_gear_pair(nasa.to_mapping()) == nasa
    assert load_gear_pair(nasa) is nasa
    assert "shafts" not in nasa.to_toml()


def test_a_diametral_pitch_is_a_division(nasa):
    assert nasa.with_(basic_rack__module="25.4/8 mm").basic_rack == nasa.basic_rack


def test_an_alternative_drops_the_source_of_what_it_replaces(nasa):
    law = {"kinematic_viscosity_40": 32, "kinematic_viscosity_100": 5.4, "temperature": 60}
    varied = nasa.with_(lubricant__viscosity_law=law)
    assert varied.lubricant.viscosity is None
    assert "lubricant.viscosity" not in dict(varied.sources)
    assert dict(varied.sources)["lubricant.viscosity_law"] == "varied by the user"
    back = varied.with_(lubricant__viscosity="10 cP")
    assert back.lubricant == nasa.lubricant


class TestVariations:
    def test_forms_of_naming_a_field_agree(self, nasa):
        expected = nasa.with_(operating__pinion_speed=2000)
        assert nasa.with_({"operating.pinion_speed": 2000}) == expected
        assert nasa.with_(operating__pinion_speed="2000 rpm") == expected
        assert expected.operating.pinion_speed == pytest.approx(2000 * math.pi / 30, rel=1e-15)
        section = nasa.to_mapping()["operating"] | {"pinion_speed": 2000}
        assert nasa.with_(operating=section).operating == expected.operating

    def test_the_callers_dict_is_untouched(self, nasa):
        mesh = {"damping_ratio": 0.1, "stiffness": {"model": "rectangular"}}
        varied = nasa.with_({"mesh": mesh, "mesh.damping_ratio": 0.2})
        assert varied.mesh.damping_ratio == 0.2
        assert mesh["damping_ratio"] == 0.1

    def test_only_the_named_field_changes(self, nasa):
        varied = nasa.with_(bearings__gear__loa_stiffness=2e8)
        assert varied.bearings.gear.loa_stiffness == 2e8
        data = varied.to_mapping()
        expected = nasa.to_mapping()
        del data["sources"], expected["sources"]
        expected["bearings"]["gear"]["loa_stiffness"] = 2e8
        del expected["assumed"]["bearings.gear.loa_stiffness"]
        assert data == expected

    def test_none_restores_the_default(self, nasa):
        assert nasa.with_(centre_distance=None).centre_distance is None
        assert nasa.with_(pinion__tip_relief=None).pinion.tip_relief is None
        assert nasa.with_(friction__maximum=0.1).with_(friction__maximum=None).friction.maximum == 0.2

    def test_several_variations_name_their_source(self, nasa):
        sources = dict(nasa.with_(mesh__damping_ratio=0.1).sources)
        assert sources["mesh.damping_ratio"] == "varied by the user"
        assert sources["pinion.teeth"] == dict(nasa.sources)["pinion.teeth"]

    @pytest.mark.parametrize("value", [None, 3])
    @pytest.mark.parametrize(("path", "near"), [
        ("operating.pinon_speed", "pinion_speed"),
        ("pinion.tip_reief", "tip_relief"),
        ("frictin.law", "friction"),
        ("pinion.tip_relief.amont", "amount"),
    ])  # fmt: skip
    def test_an_unknown_path_suggests_the_nearest(self, nasa, path, near, value):
        with pytest.raises(ParameterError, match=f"Did you mean '{near}'"):
            nasa.with_({path: value})

    def test_a_list_of_tables_changes_by_the_number_of_its_entry(self, nasa, shaft_tables):
        pair = nasa.with_(shafts=shaft_tables)
        changes = {"shafts.pinion.bearings.1.position": "6 inch", "shafts.gear.segments.0": {"length": 160}}
        changes["shafts.gear.segments.0"] |= {"diameter": 40}
        varied = pair.with_(changes)
        assert varied.shafts.pinion.bearings[1].position == 0.1524
        assert varied.shafts.pinion.bearings[1].loa_stiffness == 3e8
        assert varied.shafts.gear.length == 0.16
        assert leaf_paths(varied)["shafts.pinion.bearings.1.position"] == 152.4
        assert dict(varied.sources)["shafts.pinion.bearings.1.position"] == "varied by the user"
        reordered = varied.with_({"shafts.pinion.bearings": pair.shafts.pinion.bearings[::-1]})
        assert reordered.shafts.pinion.bearings == pair.shafts.pinion.bearings[::-1]
        assert "shafts.pinion.bearings.1.position" not in dict(reordered.sources)
        for path in ("segments.1.length", "segments.one.length", "segments.0.length.x", "segments.1"):
            with pytest.raises(ParameterError, match="unknown key"):
                pair.with_({f"shafts.gear.{path}": 20})
        with pytest.raises(ParameterError, match="without this entry"):
            pair.with_({"shafts.gear.segments.0": None})

    def test_a_path_through_a_value_is_refused(self, nasa):
        for path in ("name.length", "pinion.teeth.number"):
            with pytest.raises(ParameterError, match="unknown key"):
                nasa.with_({path: 3})

    def test_a_variation_is_validated_like_a_file(self, nasa):
        with pytest.raises(ParameterError, match=r"operating.pinion_speed = -5 rpm: allowed > 0 rpm"):
            nasa.with_(operating__pinion_speed=-5)
        with pytest.raises(ParameterError, match=r"about 88\.9 mm for these shifts"):
            nasa.with_(centre_distance=93.0)


@pytest.fixture(scope="module")
def schema():
    return json_schema()


class TestJsonSchema:
    def test_every_quantity_carries_its_unit(self, quantity_field, schema):
        path, quantity = quantity_field
        node = schema
        for part in path.split("."):
            if part.isdigit():
                node = node["items"]
                continue
            node = next(n["properties"][part] for n in _alternatives(node, schema) if part in n["properties"])
        assert node["unit"] == quantity.unit
        assert node["si_unit"] == UNITS[quantity.unit].si
        number, text = node["anyOf"]
        assert (number["type"], text["type"]) == ("number", "string")
        assert number.get("exclusiveMinimum") == quantity.above
        assert number.get("minimum") == quantity.at_least
        assert number.get("exclusiveMaximum") == quantity.below
        assert number.get("maximum") == quantity.at_most

    def test_shafts_conform(self, nasa, shaft_tables, schema):
        pair = nasa.with_(shafts=shaft_tables)
        assert _violations(pair.to_mapping(), schema, schema) == []
        wrong = copy.deepcopy(shaft_tables)
        del wrong["gear"]["bearings"][0]["position"]
        assert _violations({"shafts": wrong}, {"properties": schema["properties"]}, schema)

    @pytest.mark.parametrize("name", ["nasa_28_28", "nasa_art_25_31", "kahraman_blankenship_50_50", "fzg_c"])
    def test_presets_conform(self, name, schema):
        # As written in the file, and as written back by the schema.
        for data in (tomllib.loads(preset_text(name)), load_gear_pair(name).to_mapping()):
            assert _violations(data, schema, schema) == []

    def test_a_default_written_out_changes_nothing(self, schema):
        silent, written = (tomllib.loads(preset_text("nasa_28_28")) for _ in range(2))
        count = 0
        for key, reference in schema["properties"].items():
            for section in _alternatives(reference, schema):
                for name, field in section["properties"].items():
                    if isinstance(silent.get(key), dict) and "default" in field:
                        assert _violations(field["default"], field, schema) == []
                        silent[key].pop(name, None)
                        written[key][name] = field["default"]
                        count += 1
        assert count > 20
        assert leaf_paths(load_gear_pair(written)) == leaf_paths(load_gear_pair(silent))
        rack = schema["$defs"]["BasicRack"]["properties"]
        assert rack["pressure_angle"]["default"] == 20.0
        assert "default" not in schema["properties"]["centre_distance"]

    def test_the_check_itself_can_fail(self, edited, schema):
        for path, value in [("pinion.teeth", "many"), ("pinion.teth", 3), ("pinion.face_width", ...)]:
            assert _violations(edited(path, value), schema, schema)


def test_stated_unit_of_a_field():
    assert stated_unit("operating.pinion_speed") == "rpm"
    assert stated_unit("pinion.tip_relief.amount") == "um"
    assert stated_unit("mesh.stiffness.pair_stiffness") == "N/m"
    assert stated_unit("name") is None
    with pytest.raises(ParameterError, match="Did you mean 'pinion_speed'"):
        stated_unit("operating.pinion_sped")


def test_every_field_is_described():
    def models(model, seen):
        seen.add(model)
        for info in model.model_fields.values():
            for inner in models_in(info.annotation):
                if inner not in seen:
                    models(inner, seen)
        return seen

    for model in models(GearPair, set()):
        assert model.__doc__
        for name, info in model.model_fields.items():
            # A section is described by its own docstring, the tag of a union by the member's.
            if name != "model" and not models_in(info.annotation):
                assert info.description, f"{model.__name__}.{name}"


def _alternatives(node, root):
    """Object schemas that a node may stand for, through references and unions."""
    if "$ref" in node:
        yield from _alternatives(root["$defs"][node["$ref"].rsplit("/", 1)[1]], root)
    for key in ("anyOf", "oneOf", "allOf"):
        for inner in node.get(key, ()):
            yield from _alternatives(inner, root)
    if "properties" in node:
        yield node


def _violations(value, node, root):
    """What does not conform to the part of JSON Schema that is used: references, unions, objects, bounds."""
    node = root["$defs"][node["$ref"].rsplit("/", 1)[1]] if "$ref" in node else node
    unions = node.get("anyOf") or node.get("oneOf") or ()
    wrong = ["no alternative"] if unions and all(_violations(value, one, root) for one in unions) else []
    numbers = (int, float)
    kind = node.get("type")
    types = {"object": dict, "array": (list, tuple), "string": str, "null": type(None), None: object}
    if not isinstance(value, types.get(kind, numbers)) or (kind == "integer" and value % 1):
        return [f"{value!r} is no {kind}"]
    if value not in node.get("enum", [node.get("const", value)]):
        wrong.append(f"{value} is another choice")
    if kind in ("number", "integer"):
        low, high = node.get("minimum", -math.inf), node.get("maximum", math.inf)
        inner = node.get("exclusiveMinimum", -math.inf) < value < node.get("exclusiveMaximum", math.inf)
        wrong += [] if low <= value <= high and inner else [f"{value} out of bounds"]
    for entry in value if kind == "array" and isinstance(node.get("items"), dict) else ():
        wrong += _violations(entry, node["items"], root)
    if "properties" in node:
        wrong += [key for key in node.get("required", ()) if key not in value]
        strange = node.get("additionalProperties") is False
        for key, item in value.items():
            schema = node["properties"].get(key)
            wrong += _violations(item, schema, root) if schema else [key] * strange
    return wrong


def test_the_old_name_of_prescribed_contact_is_read_with_a_note(nasa):
    with pytest.warns(FutureWarning, match="'prescribed'"):
        pair = nasa.with_(mesh__contact="paper")
    assert pair.mesh.contact == "prescribed"


@pytest.mark.parametrize("model", ["rectangular", "parabolic", "energy", "finite_elements"])
@pytest.mark.parametrize("before", ["rectangular", "energy", "finite_elements"])
def test_one_change_names_another_stiffness_model(nasa, before, model):
    pair = load_gear_pair(nasa).with_({"mesh.stiffness": {"model": before}})
    changed = pair.with_({"mesh.stiffness.model": model})
    expected = pair.with_({"mesh.stiffness": {"model": model}})
    assert changed.mesh == expected.mesh
    changes = {"mesh.stiffness.scale": "iso6336", "mesh.stiffness.model": "energy"}
    assert pair.with_(changes).mesh.stiffness.scale == "iso6336"


RPM = math.pi / 30.0


@pytest.mark.parametrize("written", [
    "600..3000",
    "600 .. 3000 rpm",
    "10..50 Hz",
    "600 1/min..50 Hz",
    "6e2..3.0e3",
    [600, 3000],
    ("600 rpm", "50 Hz"),
    ["62.83185307179586 rad/s", 3000.0],
])  # fmt: skip
def test_as_people_write_it(nasa, written):
    pair = nasa.with_(operating__speed_range=written)
    low, high = pair.operating.speed_range
    assert (low, high) == pytest.approx((600.0 * RPM, 3000.0 * RPM), rel=1e-14)
    assert low.unit == high.unit == "rad/s"
    assert nasa.with_(operating__speed_range=pair.operating.speed_range) == pair
    assert load_gear_pair(pair.to_mapping()) == pair


@pytest.mark.parametrize(("written", "message"), [
    ("200", "two increasing values FROM..TO"),
    ("200..300..400", "two increasing values FROM..TO"),
    ("3000..200", "two increasing values FROM..TO"),
    ("3000..3000", "two increasing values FROM..TO"),
    ([1, 2, 3], "two increasing values FROM..TO"),
    (5, "two increasing values FROM..TO"),
    ("200..300000", "<= 200000 rpm"),
    ("0..300", "> 0 rpm"),
    ("200,5..300", "write '200.5'"),
    ("50..60 mm", "not a rotational speed"),
    ("..300", "has no number"),
])  # fmt: skip
def test_what_is_no_range_is_refused_by_name(nasa, written, message):
    with pytest.raises(ParameterError) as refusal:
        nasa.with_(operating__speed_range=written)
    assert "operating.speed_range" in str(refusal.value)
    assert message in str(refusal.value)
