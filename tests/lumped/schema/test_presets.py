"""Are the built-in pairs the ones they are named after, and does every value say where it is from?"""

import math

import pytest

from lumped import GearPair, bodies, geometry, load_gear_pair, preset_names
from lumped.schema.pair import leaf_paths

NAMES = preset_names()
#: Rounded as printed on the model page.
CONTACT_RATIO = {"nasa_28_28": (1.6380, 4), "nasa_art_25_31": (1.46, 2), "fzg_c": (1.463, 3)}


def test_the_pairs_of_the_paper_and_of_the_classic_experiments_are_there():
    assert {"fzg_c", "kahraman_blankenship_50_50", "nasa_28_28", "nasa_art_25_31"} < set(NAMES)


@pytest.mark.parametrize("name", NAMES)
def test_every_value_has_a_source_or_is_a_default(name):
    pair = load_gear_pair(name)
    sources = dict(pair.sources)
    bare = _with_defaults_only(pair)
    missing = []
    for path, value in leaf_paths(pair).items():
        parents = [path.rsplit(".", n)[0] for n in range(path.count(".") + 1)]
        if path in ("name", "description") or any(p in sources for p in parents):
            continue
        if bare.get(path) != value:
            missing.append(path)
    assert missing == []
    assert all(text.strip() for text in sources.values())


@pytest.mark.parametrize("name", NAMES)
def test_every_source_belongs_to_a_value(name):
    pair = load_gear_pair(name)
    paths = [*leaf_paths(pair), "operating.brake_torque"]
    for source in dict(pair.sources):
        assert any(path == source or path.startswith(f"{source}.") for path in paths), source


def _with_defaults_only(pair):
    """Schema defaults of the optional fields, by leaf path: the same pair with only required fields set."""
    from pydantic import BaseModel

    found = {}

    def walk(model, prefix):
        for name, info in type(model).model_fields.items():
            value = getattr(model, name)
            if isinstance(value, BaseModel):
                walk(value, f"{prefix}{name}.")
            elif not info.is_required() and value == info.default:
                found[f"{prefix}{name}"] = leaf_paths(pair).get(f"{prefix}{name}")

    walk(pair, "")
    assert isinstance(pair, GearPair)
    return found


@pytest.mark.parametrize("name", NAMES)
def test_nothing_warns_and_nothing_is_thin(name):
    pair = load_gear_pair(name)
    g, b = geometry(pair), bodies(pair)
    assert 1.0 < g.contact_ratio < 3.0
    assert g.normal_backlash > 0.0
    assert min(b.mass_pinion, b.mass_gear, b.inertia_pinion, b.inertia_gear) > 0.0


def test_one_pair_hides_nothing_behind_a_symmetry():
    """Unequal gears, four unlike bearings, two or three pairs of teeth in contact."""
    pair = load_gear_pair("high_contact_ratio_29_47")
    assert 2.0 < geometry(pair).contact_ratio < 3.0
    assert math.gcd(pair.pinion.teeth, pair.gear.teeth) == 1
    bearings = (pair.bearings.pinion, pair.bearings.gear)
    for unlike in (
        [value for b in bearings for value in (b.loa_stiffness, b.oloa_stiffness)],
        [value for b in bearings for value in (b.loa_damping_ratio, b.oloa_damping_ratio)],
        [pair.pinion.profile_shift, pair.gear.profile_shift],
        [pair.pinion.roughness, pair.gear.roughness],
        [pair.pinion.bore, pair.gear.bore],
    ):
        assert len(set(unlike)) == len(unlike)


@pytest.mark.parametrize(("name", "expected"), CONTACT_RATIO.items())
def test_contact_ratios_of_the_model_page(name, expected):
    value, digits = expected
    assert geometry(load_gear_pair(name)).contact_ratio == pytest.approx(value, abs=0.51 * 10**-digits)


def test_kahraman_blankenship_base_radius():
    g = geometry(load_gear_pair("kahraman_blankenship_50_50"))
    assert g.base_radius_pinion * 1e3 == pytest.approx(70.477, abs=5.1e-4)  # printed to 1 um
    assert g.base_radius_gear == g.base_radius_pinion


def test_fzg_c_tip_radii_and_centre():
    pair = load_gear_pair("fzg_c")
    g = geometry(pair)
    assert (pair.pinion.teeth, pair.gear.teeth, pair.basic_rack.module) == (16, 24, 4.5e-3)
    assert (g.tip_radius_pinion, g.tip_radius_gear) == (41.318e-3, 59.272e-3)
    assert (pair.pinion.profile_shift, pair.gear.profile_shift) == (0.1817, 0.1715)
    assert g.centre_distance == 91.5e-3
    # Operating pressure angle of FZG C from a cos(alpha_w) = (r_1 + r_2) cos(alpha): 22.44 deg.
    assert math.degrees(g.operating_pressure_angle) == pytest.approx(
        math.degrees(math.acos(90.0 * math.cos(math.radians(20)) / 91.5)), rel=1e-14
    )


def test_nasa_art_is_the_25_deg_pair():
    pair = load_gear_pair("nasa_art_25_31")
    assert (pair.pinion.teeth, pair.gear.teeth) == (25, 31)
    assert pair.basic_rack.module == 3.175e-3  # diametral pitch 8
    assert math.degrees(pair.basic_rack.pressure_angle) == pytest.approx(25.0, rel=1e-15)
    assert pair.pinion.face_width == 31.75e-3


def test_nasa_28_28_is_the_default_of_the_paper():
    pair = load_gear_pair("nasa_28_28")
    assert (pair.pinion.teeth, pair.gear.teeth, pair.basic_rack.module) == (28, 28, 3.175e-3)
    assert pair.pinion.face_width == pair.gear.face_width == 6.35e-3
    relief = pair.pinion.tip_relief
    assert (relief.shape, relief.amount) == ("linear", 23e-6)
    assert math.degrees(relief.start_roll_angle) == pytest.approx(24.0, rel=1e-15)
