"""Are shafts and bearings of a REXS file read whole, or left out with the reason?"""

import pytest

import lumped
from validation.exchange import gear_pair_from_rexs


def _component(number, kind, **attributes):
    units = {"radial_stiffness": "N / m", "bending_stiffness": "N mm / rad"}
    text = "".join(
        f'<attribute id="{key}" unit="{units.get(key, "mm")}">{value}</attribute>'
        for key, value in attributes.items()
    )
    return f'<component id="{number}" type="{kind}">{text}</component>'


def _section(number, begin, length, diameter, bore=0):
    outer = {"outer_diameter_begin": diameter, "outer_diameter_end": diameter}
    inner = {"inner_diameter_begin": bore, "inner_diameter_end": bore}
    return _component(number, "shaft_section", u_coordinate_on_shaft=begin, length=length, **outer, **inner)


def _bearing(number, at, stiffness):
    places = {"u_coordinate_on_shaft_inner_side": at, "u_coordinate_on_shaft_outer_side": at + 7}
    kind = "rolling_bearing_with_catalog_geometry"
    return _component(number, kind, **places, radial_stiffness=stiffness, bending_stiffness=5000)


def _relation(number, kind, **roles):
    refs = "".join(f'<ref id="{i}" role="{role}"/>' for role, i in roles.items())
    return f'<relation id="{number}" type="{kind}">{refs}</relation>'


@pytest.fixture
def with_shafts(xml):
    """The hand-written stage on two shafts; the sections stand in the file in no order."""
    components = [_component(80, "gear_casing")]
    relations = [_relation(200, "reference", origin=31, referenced=50)]
    for shaft, base in ((31, 100), (32, 110)):
        components += [_section(base, 40, 60, 24, 6), _section(base + 1, 0, 40, 20)]
        components += [_bearing(base + 2, 10, 2e8), _bearing(base + 3, 90, 3e8)]
        relations += [_relation(base + i, "assembly", assembly=shaft, part=base + i) for i in (0, 1)]
        relations += [
            _relation(base + i, "side", assembly=base + i, inner_part=shaft, outer_part=80) for i in (2, 3)
        ]
    place = '<attribute id="u_coordinate_on_shaft" unit="mm">50</attribute>'
    parts = {"components": "".join(components), "relations": "".join(relations)}
    return xml(gear_1=place, gear_2=place, **parts)


def test_shafts_are_read_with_sections_in_order_and_bearings_at_their_places(with_shafts, save):
    mapping, notes = gear_pair_from_rexs(save(with_shafts))
    shafts, sources = mapping["shafts"], mapping["sources"]
    assert not any("left out" in note for note in notes)
    assert [(s["length"], s["diameter"], s["bore"]) for s in shafts["pinion"]["segments"]] == [
        (40.0, 20.0, 0.0),
        (60.0, 24.0, 6.0),
    ]
    # The face begins at the u-coordinate, and is 15 and 14 mm wide.
    assert (shafts["pinion"]["gear_position"], shafts["gear"]["gear_position"]) == (57.5, 57.0)
    bearing = shafts["gear"]["bearings"][1]
    assert (bearing["position"], bearing["loa_stiffness"], bearing["oloa_stiffness"]) == (90.0, 3e8, 3e8)
    assert bearing["tilt_stiffness"] == 5.0
    assert (shafts["pinion"]["youngs_modulus"], shafts["gear"]["youngs_modulus"]) == (210.0, 206.0)
    place = "REXS model.rexs rolling_bearing_with_catalog_geometry 113/radial_stiffness"
    assert sources["shafts.gear.bearings.1.loa_stiffness"] == place
    assert sources["shafts.gear.youngs_modulus"] == "assumed"
    assert sources["shafts.damping_ratio"].startswith("assumed")
    lumped.load_gear_pair(mapping)


@pytest.mark.parametrize(("there", "instead", "reason"), [
    ('"radial_stiffness" unit="N / m">300000000.0', '"custom_c">1', "geometry 103 states no radial_stiff"),
    ('"radial_stiffness" unit="N / m">300000000.0', '"radial_stiffness" unit="N / m">1e23', "1e+23 N/m"),
    ('"outer_diameter_end" unit="mm">24', '"outer_diameter_end" unit="mm">23', "shaft_section 100 is con"),
    ('"length" unit="mm">40', '"length" unit="mm">39', "shaft_section 100 does not begin"),
    ('id="103" role="assembly"', 'id="80" role="assembly"', "shaft 31 has fewer than two bearings"),
    ('id="111" role="part"', 'id="21" role="part"', "cylindrical_gear 21 is on no shaft, or on several"),
    ('"u_coordinate_on_shaft" unit="mm">50', '"custom_u">1', "cylindrical_gear 21 states no u_coord"),
])  # fmt: skip
def test_shafts_that_are_not_whole_are_left_out_with_the_reason(with_shafts, save, there, instead, reason):
    assert there in with_shafts
    mapping, notes = gear_pair_from_rexs(save(with_shafts.replace(there, instead, 1)))
    (note,) = [note for note in notes if note.startswith("shafts of the file are left out: ")]
    assert reason in note
    assert "shafts" not in mapping
    assert not any("shafts" in path for path in mapping["sources"])
