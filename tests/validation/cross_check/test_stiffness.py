"""Does the cross-check see a wrong stiffness, softening or coupling, and does it confirm right ones?"""

import random
from dataclasses import replace

import numpy as np
import pytest

from lumped import ParameterError, load_gear_pair, preset_names
from lumped.path_of_contact import pair_stiffness
from lumped.stiffness import finite_elements
from multibody.elasticity import pair as second_values
from tests.evidence.faults.fault import FAULTS
from tests.evidence.faults.rewriting import applied
from tests.unlike_pairs import UNLIKE, unlike_pair
from validation.cross_check import stiffness
from validation.cross_check.comparison import crosscheck
from validation.cross_check.stiffness import stiffness_agreement
from validation.cross_check.verdict import Verdict

#: Every form of the stiffness models. A number of a model is also given in the file once.
MODELS = {
    "rectangular": {"model": "rectangular"},
    "rectangular, given": {"model": "rectangular", "pair_stiffness": 3.1e8},
    "parabolic": {"model": "parabolic"},
    "parabolic, ramps": {"model": "parabolic", "peak": 2.7e8, "end_ratio": 0.4, "ramp_length": 0.5},
    "energy": {"model": "energy"},
    "energy, linear contact": {"model": "energy", "hertz": "linear"},
    "energy, scaled": {"model": "energy", "scale": "iso6336", "ramp_length": 0.4},
    "finite elements": {"model": "finite_elements"},
    "finite elements, wide": {"model": "finite_elements", "plane": "strain"},
}


def every_pair():
    """All presets and all unlike pairs."""
    return [load_gear_pair(name) for name in preset_names()] + [unlike_pair(name) for name in UNLIKE]


def with_model(pair, model):
    return pair.with_({"mesh.contact": "prescribed", "mesh.stiffness": MODELS[model]})


def beyond(pair):
    """Quantities beyond their limits."""
    return {one.quantity for one in stiffness_agreement(pair) if not one.within}


@pytest.mark.parametrize("model", MODELS)
def test_the_stiffness_of_presets_and_unlike_pairs_is_confirmed(model):
    for pair in every_pair():
        assert beyond(with_model(pair, model)) == set(), pair.name
        assert beyond(with_model(pair, model).with_({"mesh.stiffness_factor": 0.8})) == set(), pair.name


def random_pairs(count, seed):
    """New pairs of unlike teeth, rack, shifts, widths, materials, bores and loads."""
    rng = random.Random(seed)
    base = unlike_pair("unlike_teeth_finite_elements").healthy
    made = 0
    while made < count:
        module = rng.choice([1.0, 2.0, 5.0])
        fields = {
            f"{gear}.{name}": None
            for gear in ("pinion", "gear")
            for name in ("tip_relief", "root_relief", "tip_diameter", "addendum", "tip_alteration")
        }
        fields |= {"centre_distance": None, "basic_rack.module": module}
        fields |= {
            "basic_rack.pressure_angle": rng.choice([17.5, 20.0, 22.5, 25.0]),
            "basic_rack.dedendum_coefficient": rng.choice([1.2, 1.25, 1.4]),
        }
        for gear, teeth in (("pinion", rng.randint(13, 50)), ("gear", rng.randint(14, 120))):
            fields |= {
                f"{gear}.teeth": teeth,
                f"{gear}.profile_shift": rng.uniform(-0.2, 0.6),
                f"{gear}.face_width": module * rng.uniform(4.0, 12.0),
                f"{gear}.youngs_modulus": rng.choice([206.0, 172.0, 110.0]),
                f"{gear}.poisson_ratio": rng.uniform(0.25, 0.35),
                f"{gear}.bore": module * (teeth - 3.0) / rng.uniform(2.2, 6.0),
            }
        width = min(fields["pinion.face_width"], fields["gear.face_width"])
        load = rng.uniform(20.0, 400.0)  # N/mm
        fields["operating.pinion_torque"] = load * width * module * fields["pinion.teeth"] / 2e3
        try:
            pair = base.with_(fields)
        except ParameterError:
            continue
        made += 1
        yield pair


@pytest.mark.parametrize("model", ["energy", "finite elements", "parabolic"])
def test_the_stiffness_of_thirty_random_pairs_is_confirmed(model):
    for pair in random_pairs(30, "stiffness"):
        assert beyond(with_model(pair, model)) == set(), pair.to_toml()


@pytest.mark.parametrize("kind", ["pair", "total"])
@pytest.mark.parametrize("ramp", [0.0, 0.4])
def test_a_table_is_confirmed_at_its_points(kind, ramp, monkeypatch):
    for pair in every_pair():
        g = pair.geometry
        points = np.linspace(-0.03, g.contact_ratio + 0.03, 31) if kind == "pair" else np.arange(17) / 17.0
        samples = 3e8 * (1.0 + 0.2 * np.cos(2.0 * np.pi * points) + 0.1 * np.sin(4.0 * np.pi * points))
        table = {
            "model": "table",
            "kind": kind,
            "axis": "phase",
            "points": tuple(points),
            "stiffness": tuple(samples),
            "ramp_length": ramp,
        }
        fields = {"mesh.contact": "prescribed", "mesh.relief": "ignored", "mesh.stiffness": table}
        tabulated = pair.with_(fields)
        assert beyond(tabulated) == set(), pair.name
        # The curve of another table, with one value a hundredth larger, misses a point of this one.
        samples[9] *= 1.01
        other = pair.with_(fields | {"mesh.stiffness": table | {"stiffness": tuple(samples)}})
        with monkeypatch.context() as wrong:
            wrong.setattr(stiffness, "pair_stiffness", lambda pair, other=other: pair_stiffness(other))
            assert beyond(tabulated) == {"stiffness"}, pair.name


#: Fault of the catalogue -> model on which it acts, and the quantity that is beyond its limit.
WRONG = {
    "iso_rack_sign": ("parabolic", "stiffness"),
    "iso_correction": ("rectangular", "stiffness"),
    "iso_coefficient": ("rectangular", "stiffness"),
    "iso_width": ("rectangular", "stiffness"),
    "iso_mean": ("energy, scaled", "stiffness"),
    "parabola_ends": ("parabolic", "stiffness"),
    "stiffness_5_percent": ("energy", "stiffness"),
    "softening_twice": ("energy", "softening"),
    "softening_gone": ("energy", "softening"),
    "neighbours_gone": ("energy", "neighbours"),
    "neighbours_twice": ("energy", "neighbours"),
    "foundation_gone": ("energy", "stiffness"),
    "bending": ("energy", "stiffness"),
    "energy_width": ("energy", "stiffness"),
    "energy_one_modulus": ("energy", "stiffness"),
    "energy_mirrored": ("energy", "stiffness"),
    "factor_ignored": ("energy", "stiffness"),
    "elastic_neighbours_gone": ("finite elements", "neighbours"),
    "elastic_one_modulus": ("finite elements", "stiffness"),
}
#: What a pair needs for a fault to act on it.
NEEDED = {
    "iso_width": {"pinion.face_width": 11.0, "gear.face_width": 13.0},
    "energy_width": {"pinion.face_width": 11.0, "gear.face_width": 13.0},
    "energy_one_modulus": {"gear.youngs_modulus": 172.0, "pinion.youngs_modulus": 206.0},
    "elastic_one_modulus": {"gear.youngs_modulus": 110.0, "pinion.youngs_modulus": 206.0},
    "factor_ignored": {"mesh.stiffness_factor": 0.9},
}
#: Three presets and three unlike pairs, all of unlike gears.
UNLIKE_GEARS = ("fzg_c", "nasa_art_25_31", "high_contact_ratio_29_47")
OTHERS = (
    "larger_gear_drives_contact_lost",
    "contact_ratio_1_1_large_shifts",
    "rack_25_degrees_always_pushing",
)


@pytest.mark.parametrize("key", WRONG)
def test_a_wrong_stiffness_is_seen(key):
    model, quantity = WRONG[key]
    named = [load_gear_pair(name) for name in UNLIKE_GEARS] + [unlike_pair(name) for name in OTHERS]
    pairs = [with_model(pair, model).with_(NEEDED.get(key, {})) for pair in named]
    if key == "iso_rack_sign":  # the factor of the standard's rack is 1 with either sign
        pairs = [pair for pair in pairs if pair.basic_rack.dedendum_coefficient != 1.2]
    assert all(beyond(pair) == set() for pair in pairs)
    with applied(FAULTS[key]):
        # What the model computes with the fault stays with the pair that was made for it.
        seen = {pair.name: beyond(load_gear_pair(pair.to_mapping())) for pair in pairs}
    missed = [name for name, quantities in seen.items() if quantity not in quantities]
    if key == "elastic_neighbours_gone":  # few teeth: the coupling of free gears is smaller than its limit
        assert missed in ([], ["fzg_c"])
    else:
        assert missed == []


@pytest.mark.parametrize("name", [*UNLIKE_GEARS, "nasa_28_28"])
def test_finite_elements_without_the_gear_body_are_seen(name, monkeypatch):
    pair = with_model(load_gear_pair(name), "finite elements")
    elastic = second_values.elastic_pair(pair)
    with_body = finite_elements.self_compliance

    def without_body(pair, teeth, xi):
        gears = ((elastic.pinion, xi), (elastic.gear, elastic.circles.tangent - xi))
        bodies = sum(second_values._foot_motion(gear, 0, length, length) for gear, length in gears)
        return with_body(pair, teeth, xi) - bodies / elastic.face_width

    monkeypatch.setattr(finite_elements, "self_compliance", without_body)
    assert "stiffness" in beyond(pair)


def test_a_path_that_is_run_through_backwards_is_seen_by_the_shape(monkeypatch):
    """Of finite elements the size has a wide limit; the shape tells a mirrored path of unlike gears."""
    forwards = finite_elements.self_compliance
    pair = with_model(unlike_pair("contact_ratio_1_1_large_shifts"), "finite elements")
    g = pair.geometry
    monkeypatch.setattr(
        finite_elements,
        "self_compliance",
        lambda pair, teeth, xi: forwards(pair, teeth, g.L_XA + g.L_XD - xi),
    )
    assert beyond(pair) & {"shape", "stiffness"}


def test_a_wrong_stiffness_fails_the_cross_check_and_its_words_name_it():
    pair = load_gear_pair("nasa_art_25_31").with_({"mesh.relief": "ignored"})
    with applied(FAULTS["stiffness_5_percent"]):
        check = crosscheck(pair, cycles=6, samples_per_cycle=32, variant=False)
    assert check.verdict is Verdict.FAILS
    assert [one.check for one in check.failures] == ["elasticity: stiffness"]


def test_a_difference_that_is_not_a_number_is_beyond_its_limit():
    agreement = stiffness_agreement(load_gear_pair("nasa_28_28"))[0]
    assert agreement.within
    assert not replace(agreement, difference=np.nan).within
