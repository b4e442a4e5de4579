"""Small REXS models written by hand, and a way to save them."""

import json
import zipfile

import pytest

import lumped

#: A 20/30 spur stage, module 2 mm, by hand after the specification; braces are filled in by tests.
XML = """<?xml version="1.0" encoding="UTF-8"?>
<model version="{version}" applicationId="by hand" applicationVersion="1" date="2024-01-01T00:00:00+00:00">
  <relations>
    <relation id="1" type="assembly"><ref id="1" role="assembly"/><ref id="10" role="part"/></relation>
    <relation id="2" type="stage">
      <ref id="10" role="stage"/><ref id="21" role="gear_1"/><ref id="22" role="gear_2"/>
    </relation>
    <relation id="3" type="assembly"><ref id="31" role="assembly"/><ref id="21" role="part"/></relation>
    <relation id="4" type="assembly"><ref id="32" role="assembly"/><ref id="22" role="part"/></relation>
    <relation id="5" type="assembly"><ref id="31" role="assembly"/><ref id="33" role="part"/></relation>
    <relation id="6" type="flank">
      <ref id="21" role="gear"/><ref id="41" role="left"/><ref id="42" role="right"/>
    </relation>
    <relation id="7" type="flank">
      <ref id="22" role="gear"/><ref id="43" role="left"/><ref id="44" role="right"/>
    </relation>
    <relation id="8" type="reference"><ref id="21" role="origin"/><ref id="50" role="referenced"/></relation>
    <relation id="9" type="reference"><ref id="22" role="origin"/><ref id="50" role="referenced"/></relation>
    {relations}
  </relations>
  <components>
    <component id="1" type="gear_unit" name="test rig"/>
    <component id="10" type="cylindrical_stage" name="first stage">
      <attribute id="center_distance" unit="mm">50.2</attribute>
      {stage}
    </component>
    <component id="21" type="cylindrical_gear" name="pinion">
      <attribute id="number_of_teeth" unit="none">20</attribute>
      <attribute id="normal_module" unit="mm">2</attribute>
      <attribute id="helix_angle_reference_diameter" unit="deg">{helix}</attribute>
      <attribute id="face_width" unit="mm">15</attribute>
      <attribute id="tip_diameter" unit="mm">44.2</attribute>
      {gear_1}
    </component>
    <component id="22" type="cylindrical_gear" name="wheel">
      <attribute id="number_of_teeth" unit="none">30</attribute>
      <attribute id="normal_module" unit="mm">2</attribute>
      <attribute id="helix_angle_reference_diameter" unit="deg">{helix}</attribute>
      <attribute id="face_width" unit="mm">14</attribute>
      <attribute id="inner_diameter" unit="mm">12</attribute>
      {gear_2}
    </component>
    <component id="31" type="shaft">
      <attribute id="rotational_speed" unit="1 / min">-1500</attribute>
    </component>
    <component id="32" type="shaft"/>
    <component id="33" type="external_load">
      <attribute id="torque_around_u_axis" unit="N m">-42.5</attribute>
    </component>
    <component id="41" type="cylindrical_gear_flank">{flank_1}</component>
    <component id="42" type="cylindrical_gear_flank">{flank_1}</component>
    <component id="43" type="cylindrical_gear_flank">{flank_2}</component>
    <component id="44" type="cylindrical_gear_flank">{flank_2}</component>
    <component id="50" type="material">
      <attribute id="elastic_modulus" unit="{modulus_unit}">210000</attribute>
      <attribute id="poisson_ratio" unit="none">0.29</attribute>
      <attribute id="density" unit="kg / dm^3">7.8</attribute>
    </component>
    {components}
  </components>
  {spectrum}
</model>
"""
_FLANK = (
    '<attribute id="normal_pressure_angle" unit="deg">20</attribute>'
    '<attribute id="addendum_modification_coefficient" unit="none">{shift}</attribute>'
)
DEFAULTS = {
    "version": "1.4", "helix": "0", "relations": "", "stage": "", "gear_1": "", "gear_2": "",
    "flank_1": _FLANK.format(shift="0.1"), "flank_2": _FLANK.format(shift="0"), "modulus_unit": "N / mm^2",
    "components": "", "spectrum": "",
}  # fmt: skip


@pytest.fixture
def xml():
    """Function: the hand-written model with some parts replaced."""
    return lambda **parts: XML.format(**(DEFAULTS | parts))


@pytest.fixture
def save(tmp_path):
    """Function: save text or bytes under a name, or as the only member of an archive."""

    def saved(content, name="model.rexs", member=None):
        data = content if isinstance(content, bytes) else content.encode()
        path = tmp_path / name
        if member is None:
            path.write_bytes(data)
        else:
            with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
                archive.writestr(member, data)
        return path

    return saved


@pytest.fixture
def json_model():
    """The same 20/30 stage in the JSON form, by hand, as a mapping to change."""

    def component(number, kind, *attributes):
        return {"id": number, "type": kind, "name": "", "attributes": list(attributes)}

    def number(key, unit, value, kind="floating_point"):
        return {"id": key, "unit": unit, kind: value}

    def relation(key, kind, **roles):
        refs = [{"id": i, "role": role, "hint": "ignored"} for role, i in roles.items()]
        return {"id": key, "type": kind, "refs": refs}

    def gear(key, teeth, width):
        return component(
            key,
            "cylindrical_gear",
            number("number_of_teeth", "none", teeth, "integer"),
            number("normal_module", "mm", 2.0),
            number("helix_angle_reference_diameter", "deg", 0.0),
            number("face_width", "mm", width),
        )

    model = {
        "version": "1.5",
        "applicationId": "by hand",
        "applicationVersion": "1",
        "date": "2024-01-01T00:00:00+00:00",
        "relations": [relation(1, "stage", stage=10, gear_1=21, gear_2=22), relation(2, "stage_gear_data",
         stage=10, gear=22, stage_gear_data=61), relation(3, "assembly", assembly=32, part=22),
         relation(4, "flank", gear=21, left=41), relation(5, "flank", gear=22, left=41)],
        "components": [component(10, "cylindrical_stage", number("center_distance", "mm", 50.0)), gear(21,
         20, 15.0), gear(22, 30, 14.0), component(32, "shaft"), component(41,
         "cylindrical_gear_flank", number("normal_pressure_angle", "deg", 20.0),
         number("addendum_modification_coefficient", "none", 0.0)),
         component(61, "cylindrical_stage_gear_data",
         {"id": "is_driving_gear", "unit": "none", "boolean": True}, number("torque", "N m", -12.0))],
        "load_spectrum": {"id": 1, "load_cases": [{"id": 7, "components": [{"id": 32,
         "attributes": [number("rotational_speed", "1 / min", 900.0)]}]}]},
    }  # fmt: skip
    return {"model": model}


@pytest.fixture
def save_json(save):
    """Function: save a mapping as a JSON file."""
    return lambda model, name="model.rexsj": save(json.dumps(model), name)


@pytest.fixture(params=lumped.preset_names())
def preset(request):
    return lumped.load_gear_pair(request.param)
