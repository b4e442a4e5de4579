"""What in a REXS file contradicts the rest: values that other values give are compared with them.

A contradiction does not end the import: the draft is written and its doubtful lines are marked, because only
the user can know which of two values is wrong.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from itertools import combinations

from lumped.errors import ParameterError
from lumped.fields.units import to_stated
from lumped.schema.pair import GearPair, leaf_paths
from validation.exchange.rexs.gears import flanks_of, gear_data_of
from validation.exchange.rexs.model import Component
from validation.exchange.rexs.said import Reading, Said
from validation.exchange.rexs.vocabulary import derived_number

_RACK = ("basic_rack.module", "basic_rack.pressure_angle")
_TEETH = ("pinion.teeth", "gear.teeth")
_SHIFTS = ("pinion.profile_shift", "gear.profile_shift")
_WIDTHS = ("pinion.face_width", "gear.face_width")
_TIPS = ("pinion.tip_diameter", "gear.tip_diameter")
_CENTRE = ("centre_distance", "mesh.backlash")
#: Groups of fields that the others give, so that a pair can be drafted without them.
_DERIVED = (_CENTRE, _TIPS[:1], _TIPS[1:])
#: Relative difference that rounded output explains. The contact ratio also depends on chamfers and on which
#: of its tolerances a tip diameter is taken at.
_ROUNDED, _CONTACT_RATIO = 1e-3, 0.03
#: Backlash [modules] beyond which the centre distance hardly can be meant: ten times DIN 3967 at module 2.
_MOST_BACKLASH = 0.25
#: Change of the tip circle's radius against the basic profile [modules]: tip shortening takes less.
_TIP_CHANGE = 0.25


def without_contradiction(said: Said, validated: Callable[[], GearPair]) -> GearPair:
    """Validate; where that fails and the file's derived values are why, draft without them.

    Parameters
    ----------
    said : what the file says; derived values that the rest contradicts are replaced, marked and noted
    validated : validates what ``said`` has

    Raises
    ------
    ParameterError : the pair is refused with and without its derived values
    """
    try:
        return validated()
    except ParameterError as error:
        refused = error
    named = [p.field for p in refused.problems]
    groups = [tuple(p for p in group if p in said.values) for group in _DERIVED]
    groups = sorted(filter(None, groups), key=lambda group: not set(group) & set(named))
    for count in range(1, len(groups) + 1):
        for chosen in combinations(groups, count):
            left_out = {path: said.values.pop(path) for group in chosen for path in group}
            try:
                pair = validated()
            except ParameterError:
                said.values |= left_out
                continue
            for path, value in left_out.items():
                _replaced(said, path, value, pair)
            return validated()
    raise refused


def _replaced(said: Said, path: str, given: float, pair: GearPair) -> None:
    """Put what the other values give in the place of a value of the file."""
    g = pair.geometry
    others = {
        "centre_distance": g.centre_distance,
        "mesh.backlash": pair.mesh.backlash,
        "pinion.tip_diameter": 2.0 * g.tip_radius_pinion,
        "gear.tip_diameter": 2.0 * g.tip_radius_gear,
    }
    where = said.sources[path]
    said.put(path, derived_number(others[path], "mm"), "assumed")
    text = f"{where} has {given:g} mm, with which the other values give no pair of gears"
    said.doubt([path], f"{text}; {said.values[path]:g} mm stands in")


def find_doubts(said: Said, stage: Component, gears: dict[str, Component], pair: GearPair) -> None:
    """Mark the lines of a valid pair that other values of the file contradict.

    Parameters
    ----------
    said : what the file says; gets sources and notes
    stage : component of the stage
    gears : "pinion" and "gear" -> component
    pair : the valid pair
    """
    lines = leaf_paths(pair)
    for reading, expected, tolerance, unit, paths in _compared(said, stage, gears, pair):
        if reading is None:
            continue
        given = abs(reading.si)  # some programs give ratios and diameters a sign
        if not math.isclose(given, expected, rel_tol=tolerance, abs_tol=tolerance if unit == "1" else 0.0):
            of = "" if unit == "1" else f" {unit}"
            has, gives = (f"{to_stated(value, unit):.6g}{of}" for value in (given, expected))
            marked = [path for path in paths if path in lines]
            said.doubt(marked, f"{reading.where} is {has}, the other values give {gives}")
    _doubt_backlash(said, pair)
    _doubt_tips(said, gears, pair)
    if said.model.of_type("flank_geometry"):
        marked = [path for path in (*_SHIFTS, _RACK[1]) if path in lines]
        said.doubt(marked, "flank_geometry, where REXS before 1.3 has these, is not read")


def _compared(
    said: Said, stage: Component, gears: dict[str, Component], pair: GearPair
) -> Iterator[tuple[Reading | None, float, float, str, tuple[str, ...]]]:
    """What the file says, what the pair has, tolerance, unit, and the fields that one of both is from."""
    g = pair.geometry
    teeth = sorted((pair.pinion.teeth, pair.gear.teeth))
    shifts = abs(pair.pinion.profile_shift + pair.gear.profile_shift)
    meshing = (*_CENTRE[:1], *_TIPS, "basic_rack.addendum_coefficient")

    def of(attribute: str, component: Component = stage) -> Reading | None:
        return said.number(component, attribute)

    yield of("radial_contact_ratio"), g.contact_ratio, _CONTACT_RATIO, "1", meshing
    yield of("overlap_contact_ratio"), 0.0, _ROUNDED, "1", _WIDTHS
    ratio = of("gear_ratio")
    if ratio is not None and 0.0 < abs(ratio.si) < 1.0:
        ratio = Reading(1.0 / ratio.si, ratio.where)
    yield ratio, teeth[1] / teeth[0], _ROUNDED, "1", _TEETH
    yield of("sum_of_addendum_modification_coefficients"), shifts, _ROUNDED, "1", _SHIFTS
    yield of("normal_base_pitch"), g.base_pitch, _ROUNDED, "mm", _RACK
    angle = g.operating_pressure_angle
    for which, component in gears.items():
        reference, base, pitch = (
            2.0 * getattr(g, f"{kind}_radius_{which}") for kind in ("reference", "base", "operating")
        )
        for name in ("reference_circle_diameter", "reference_diameter_cylindrical_gear"):
            yield of(name, component), reference, _ROUNDED, "mm", (_RACK[0], f"{which}.teeth")
        for name in ("base_circle_diameter", "base_diameter"):
            yield of(name, component), base, _ROUNDED, "mm", (*_RACK, f"{which}.teeth")
        for data in gear_data_of(said, stage, component):
            yield of("pitch_diameter", data), pitch, _ROUNDED, "mm", _CENTRE[:1]
            name = "operating_pressure_angle_in_the_transverse_section"
            yield of(name, data), angle, _ROUNDED, "deg", (*_CENTRE[:1], _RACK[1])


def _doubt_backlash(said: Said, pair: GearPair) -> None:
    """Mark a centre distance that leaves more backlash than gears have."""
    backlash, most = pair.geometry.normal_backlash, _MOST_BACKLASH * pair.basic_rack.module
    if max(backlash, pair.mesh.backlash) > most and "centre_distance" in said.values:
        text = f"the normal backlash is {1e3 * backlash:.3g} mm, more than {_MOST_BACKLASH:g} modules"
        said.doubt([path for path in _CENTRE if path in said.values], text)


def _doubt_tips(said: Said, gears: dict[str, Component], pair: GearPair) -> None:
    """Mark a tip diameter far from that of the basic profile, where the file has one."""
    module, g = pair.basic_rack.module, pair.geometry
    for which, component in gears.items():
        gear, path = getattr(pair, which), f"{which}.tip_diameter"
        profiles = [
            said.number(flank, "addendum_coefficient_basic_profile")
            for _, flank in flanks_of(said, component)
        ]
        if path not in said.values or not profiles or profiles[0] is None:
            continue
        reference, tip = (getattr(g, f"{kind}_radius_{which}") for kind in ("reference", "tip"))
        expected = reference + module * (gear.profile_shift + profiles[0].si)
        if abs(tip - expected) > _TIP_CHANGE * module:
            text = f"{2e3 * tip:.6g} mm, the basic profile and its shift give {2e3 * expected:.6g} mm"
            said.doubt([path], text)
