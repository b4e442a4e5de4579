"""Warnings about a REXS file that contradicts itself: values that other values give are compared with them.

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
from validation.exchange.rexs.draft import ASSUMED, Draft, Reading
from validation.exchange.rexs.gears import flanks_of, gear_data_of
from validation.exchange.rexs.model import Component
from validation.exchange.rexs.vocabulary import derived_number

_RACK = ("basic_rack.module", "basic_rack.pressure_angle")
_SHIFTS = ("pinion.profile_shift", "gear.profile_shift")
_TIPS = ("pinion.tip_diameter", "gear.tip_diameter")
_CENTRE, _BACKLASH = "centre_distance", "mesh.backlash"
#: Relative difference that rounded output explains. The contact ratio also depends on chamfers and on which
#: of its tolerances a tip diameter is taken at.
_ROUNDED, _CONTACT_RATIO = 1e-3, 0.03
#: Backlash [modules] beyond which the centre distance hardly can be meant: ten times DIN 3967 at module 2.
_MOST_BACKLASH = 0.25
#: Change of the tip circle's radius against the basic profile [modules]: tip shortening takes less.
_TIP_CHANGE = 0.25


def without_contradiction(draft: Draft, validated: Callable[[], GearPair]) -> GearPair:
    """Validate; where that fails and values that the others give are why, put these in their place.

    Raises
    ------
    ParameterError : the pair is refused with and without its derived values
    """
    try:
        return validated()
    except ParameterError as error:
        refused = error
    named = {p.field for p in refused.problems}
    derived = [path for path in (_CENTRE, _BACKLASH, *_TIPS) if path in draft.values]
    derived.sort(key=lambda path: path not in named)
    for count in range(1, len(derived) + 1):
        for paths in combinations(derived, count):
            left_out = {path: draft.values.pop(path) for path in paths}
            try:
                pair = validated()
            except ParameterError:
                draft.values |= left_out
                continue
            g = pair.geometry
            others = {_CENTRE: g.centre_distance, _BACKLASH: pair.mesh.backlash}
            others |= {_TIPS[0]: 2.0 * g.tip_radius_pinion, _TIPS[1]: 2.0 * g.tip_radius_gear}
            for path, value in left_out.items():
                text = f"{draft.sources[path]} has {value:g} mm, with which the other values give no pair"
                draft.put(path, derived_number(others[path], "mm"), ASSUMED)
                draft.warn([path], f"{text} of gears; {draft.values[path]:g} mm stands in")
            return validated()
    raise refused


def warn_of_contradictions(
    draft: Draft, stage: Component, gears: dict[str, Component], pair: GearPair
) -> None:
    """Mark the lines of a valid pair that other values of the file contradict."""
    lines = leaf_paths(pair)
    for reading, expected, tolerance, unit, paths in _compared(draft, stage, gears, pair):
        if reading is None:
            continue
        value = abs(reading.si)  # some programs give ratios and diameters a sign
        if not math.isclose(value, expected, rel_tol=tolerance, abs_tol=tolerance if unit == "1" else 0.0):
            has, gives = (f"{to_stated(x, unit):.6g} {unit}".removesuffix(" 1") for x in (value, expected))
            marked = [path for path in paths if path in lines]
            draft.warn(marked, f"{reading.where} is {has}, the other values give {gives}")
    g, module = pair.geometry, pair.basic_rack.module
    if max(g.normal_backlash, pair.mesh.backlash) > _MOST_BACKLASH * module and _CENTRE in draft.values:
        text = f"the normal backlash is {1e3 * g.normal_backlash:.3g} mm, more than {_MOST_BACKLASH} modules"
        draft.warn([path for path in (_CENTRE, _BACKLASH) if path in draft.values], text)
    for which, component in gears.items():
        flanks = flanks_of(draft, component).values()
        profiles = [draft.number(flank, "addendum_coefficient_basic_profile") for flank in flanks]
        path, tip = f"{which}.tip_diameter", getattr(g, f"tip_radius_{which}")
        if path not in draft.values or not profiles or profiles[0] is None:
            continue
        addendum = module * (getattr(pair, which).profile_shift + profiles[0].si)
        expected = getattr(g, f"reference_radius_{which}") + addendum
        if abs(tip - expected) > _TIP_CHANGE * module:
            text = f"{2e3 * tip:.6g} mm, the basic profile and its shift give {2e3 * expected:.6g} mm"
            draft.warn([path], text)
    if draft.model.of_type("flank_geometry"):
        marked = [path for path in (*_SHIFTS, _RACK[1]) if path in lines]
        draft.warn(marked, "flank_geometry, where REXS before 1.3 has these, is not read")


def _compared(
    draft: Draft, stage: Component, gears: dict[str, Component], pair: GearPair
) -> Iterator[tuple[Reading | None, float, float, str, tuple[str, ...]]]:
    """What the file says, what the pair has, tolerance, unit, and the fields that one of both is from."""
    g, of = pair.geometry, draft.number
    teeth = sorted((pair.pinion.teeth, pair.gear.teeth))
    shifts = abs(pair.pinion.profile_shift + pair.gear.profile_shift)
    meshing = (_CENTRE, *_TIPS, "basic_rack.addendum_coefficient")
    widths = ("pinion.face_width", "gear.face_width")
    yield of(stage, "radial_contact_ratio"), g.contact_ratio, _CONTACT_RATIO, "1", meshing
    yield of(stage, "overlap_contact_ratio"), 0.0, _ROUNDED, "1", widths
    ratio = of(stage, "gear_ratio")
    if ratio is not None and 0.0 < abs(ratio.si) < 1.0:
        ratio = Reading(1.0 / ratio.si, ratio.where)
    yield ratio, teeth[1] / teeth[0], _ROUNDED, "1", ("pinion.teeth", "gear.teeth")
    yield of(stage, "sum_of_addendum_modification_coefficients"), shifts, _ROUNDED, "1", _SHIFTS
    yield of(stage, "normal_base_pitch"), g.base_pitch, _ROUNDED, "mm", _RACK
    for which, gear in gears.items():
        circles = (getattr(g, f"{kind}_radius_{which}") for kind in ("reference", "base", "operating"))
        reference, base, pitch = (2.0 * radius for radius in circles)
        for name in ("reference_circle_diameter", "reference_diameter_cylindrical_gear"):
            yield of(gear, name), reference, _ROUNDED, "mm", (_RACK[0], f"{which}.teeth")
        for name in ("base_circle_diameter", "base_diameter"):
            yield of(gear, name), base, _ROUNDED, "mm", (*_RACK, f"{which}.teeth")
        for data in gear_data_of(draft, stage, gear):
            yield of(data, "pitch_diameter"), pitch, _ROUNDED, "mm", (_CENTRE,)
            angle = of(data, "operating_pressure_angle_in_the_transverse_section")
            yield angle, g.operating_pressure_angle, _ROUNDED, "deg", (_CENTRE, _RACK[1])
