"""Are the built-in pairs the ones they are named after, and does every value say where it is from?"""

import math

import pytest

from lumped import GearPair, geometry, load_gear_pair, preset_names
from lumped.schema.pair import leaf_paths

NAMES = preset_names()
#: Rounded as printed on the model page.
CONTACT_RATIO = {"nasa_28_28": (1.6380, 4), "nasa_art_25_31": (1.46, 2), "fzg_c": (1.463, 3)}


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


#: What the pairs are named after, in the units of a file; the base radius as printed, to 1 um.
PUBLISHED = {
    "nasa_28_28": {
        "pinion.teeth": 28, "gear.teeth": 28, "basic_rack.module": 3.175, "pinion.face_width": 6.35,
        "pinion.tip_relief.amount": 23.0, "pinion.tip_relief.start_roll_angle": 24.0,
    },
    "nasa_art_25_31": {
        "pinion.teeth": 25, "gear.teeth": 31, "basic_rack.module": 3.175, "basic_rack.pressure_angle": 25.0,
        "pinion.face_width": 31.75,
    },
    "fzg_c": {
        "pinion.teeth": 16, "gear.teeth": 24, "basic_rack.module": 4.5, "centre_distance": 91.5,
        "pinion.profile_shift": 0.1817, "gear.profile_shift": 0.1715,
    },
    "kahraman_blankenship_50_50": {"pinion.teeth": 50, "gear.teeth": 50},
}  # fmt: skip


@pytest.mark.parametrize("name", PUBLISHED)
def test_published_data(name):
    pair = load_gear_pair(name)
    found = leaf_paths(pair)
    assert {path: found[path] for path in PUBLISHED[name]} == PUBLISHED[name]
    g = geometry(pair)
    if name == "fzg_c":
        assert (g.tip_radius_pinion, g.tip_radius_gear) == (41.318e-3, 59.272e-3)
    elif name.startswith("kahraman"):
        assert g.base_radius_pinion == pytest.approx(70.477e-3, abs=5.1e-7)
