"""Are the built-in pairs the ones they are named after, and does every value say where it is from?"""

import math
import tomllib

import pytest

from lumped import geometry, load_gear_pair, preset_names
from lumped.schema.files import preset_text
from lumped.schema.pair import leaf_paths

NAMES = preset_names()
#: Rounded as printed on the model page.
CONTACT_RATIO = {"nasa_28_28": (1.6380, 4), "nasa_art_25_31": (1.46, 2), "fzg_c": (1.463, 3)}


@pytest.mark.parametrize("name", NAMES)
def test_every_value_has_a_source_or_is_assumed(name):
    pair = load_gear_pair(name)
    sources = dict(pair.sources)
    missing = []
    for path in leaf_paths(pair):
        parents = [path.rsplit(".", n)[0] for n in range(path.count(".") + 1)]
        if path in ("name", "description") or any(p in sources for p in parents):
            continue
        if path not in pair.assumed:
            missing.append(path)
    assert missing == []
    assert all(text.strip() for text in sources.values())


@pytest.mark.parametrize("name", NAMES)
def test_every_source_belongs_to_a_value(name):
    pair = load_gear_pair(name)
    paths = [*leaf_paths(pair), "operating.brake_torque"]
    for source in dict(pair.sources):
        assert any(path == source or path.startswith(f"{source}.") for path in paths), source


@pytest.mark.parametrize("name", NAMES)
def test_every_entry_of_assumed_holds(name):
    """A value that is edited in the file, and not in its table, would be known without a word."""
    written = tomllib.loads(preset_text(name))["assumed"]
    assert {path: load_gear_pair(name).assumed.get(path) for path in written} == {
        path: tuple(value) if isinstance(value, list) else value for path, value in written.items()
    }
    assert not any("assum" in text for text in dict(load_gear_pair(name).sources).values())


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
    values = leaf_paths(pair)
    assert {path: values[path] for path in PUBLISHED[name]} == PUBLISHED[name]
    g = geometry(pair)
    if name == "fzg_c":
        assert (g.tip_radius_pinion, g.tip_radius_gear) == (41.318e-3, 59.272e-3)
    elif name.startswith("kahraman"):
        assert g.base_radius_pinion == pytest.approx(70.477e-3, abs=5.1e-7)
