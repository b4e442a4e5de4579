"""Tooth system of a REXS stage: teeth, module, angles, profile shifts, tips and the tool.

``PLACES`` lists the places of every quantity in the published databases of REXS 1.0 to 2.0.0. The import
reads a quantity from these places, and a refusal prints them. A quantity in the file is never assumed.
"""

from __future__ import annotations

from typing import NamedTuple

from lumped.errors import ParameterError, shown
from lumped.gear_geometry.profile_shift import resolved_shifts, shared
from validation.exchange.rexs.draft import Draft, Reading
from validation.exchange.rexs.model import FLANKS, Component

_FLANK, _OLD_FLANK = FLANKS


class Place(NamedTuple):
    """One place of a quantity: type of the component, attribute, and REXS versions with this attribute."""

    component: str
    attribute: str
    versions: str


def _of_flanks(attribute: str, old: str) -> tuple[Place, Place]:
    """Return the places of a flank attribute. REXS 1.3 renamed the flank. ``old``: versions before 1.3."""
    return Place(_OLD_FLANK, attribute, old), Place(_FLANK, attribute, "1.3 to 2.0.0")


#: Quantity -> its places; the first attribute that the file has is read.
PLACES: dict[str, tuple[Place, ...]] = {
    "teeth": (Place("cylindrical_gear", "number_of_teeth", "1.0 to 2.0.0"),),
    "face_width": (Place("cylindrical_gear", "face_width", "1.0 to 2.0.0"),),
    "module": (
        Place("cylindrical_gear", "normal_module", "1.0 to 2.0.0"),
        Place("cylindrical_gear", "transverse_module", "1.2 to 2.0.0"),
    ),
    "helix_angle": (Place("cylindrical_gear", "helix_angle_reference_diameter", "1.0 to 2.0.0"),),
    "pressure_angle": (
        *_of_flanks("normal_pressure_angle", "1.0 to 1.2"),
        *_of_flanks("pressure_angle_in_the_transverse_section", "1.1 and 1.2"),
    ),
    "profile_shift": (
        *_of_flanks("addendum_modification_coefficient", "1.0 to 1.2"),
        *_of_flanks("addendum_modification", "1.2"),
    ),
    "profile_shift_sum": (
        Place("cylindrical_stage", "sum_of_addendum_modification_coefficients", "1.0 to 2.0.0"),
    ),
    "centre_distance": (Place("cylindrical_stage", "center_distance", "1.0 to 2.0.0"),),
    "tip_diameter": (Place("cylindrical_gear", "tip_diameter", "1.0 to 2.0.0"),),
    "tip_limits": (
        Place("cylindrical_gear", "minimum_tip_diameter", "1.5 to 2.0.0"),
        Place("cylindrical_gear", "maximum_tip_diameter", "1.5 to 2.0.0"),
    ),
    "addendum": (Place("cylindrical_gear", "addendum_basic_profile", "1.2 to 1.7"),),
    "addendum_coefficient": _of_flanks("addendum_coefficient_basic_profile", "1.0 to 1.2"),
}
#: Attributes of the tool: a factor of the module, or else a length.
_TOOL = {
    "dedendum": ("addendum_coefficient_reference_profile", "addendum_reference_profile"),
    "fillet_radius": (
        "tip_radius_factor",
        "tip_corner_radius_factor_reference_profile",
        "tip_radius",
    ),
}
_LENGTHS = ("addendum_modification", "addendum_reference_profile", "tip_radius")
_TIPS = ("addendum", "tip_diameter", "tip_alteration")
_SYMMETRIC = "The flanks of a tooth differ; only symmetric teeth can be modelled."
_MESH = "Flanks that mesh have one pressure angle, and only symmetric teeth can be modelled."


def read_tooth_system(draft: Draft, stage: Component, gears: dict[str, Component]) -> None:
    """Read the tooth system of "pinion" and "gear". A quantity that the file does not have is a problem."""
    both = tuple(gears.values())
    for gear_name, gear in gears.items():
        _read_teeth(draft, gear_name, gear)
        draft.take(f"{gear_name}.face_width", _read(draft, "face_width", gear))
        _need(draft, f"{gear_name}.face_width", "face_width", gear)
    module = _common(draft, "module", both, "Gears that mesh have one module.")
    angle = _common(draft, "pressure_angle", both, _MESH)
    for quantity, reading in (("module", module), ("pressure_angle", angle)):
        draft.take(f"basic_rack.{quantity}", reading)
        _need(draft, f"basic_rack.{quantity}", quantity, *both)
    if not any(_read(draft, "helix_angle", gear) for gear in both):
        _refuse_helix(draft, both)
    draft.take("centre_distance", _read(draft, "centre_distance", stage))
    _read_shifts(draft, stage, gears)
    _read_tips(draft, gears)
    _read_tool(draft, gears)


def _candidates(draft: Draft, component: Component) -> list[Component]:
    return [component, *draft.model.flanks(component).values()]


def _read(draft: Draft, quantity: str, component: Component, why: str = _SYMMETRIC) -> Reading | None:
    """Read a quantity of a gear or stage from the first place that has a value. Both flanks must agree."""
    parts = _candidates(draft, component)
    for attribute in dict.fromkeys(place.attribute for place in PLACES[quantity]):
        types = [place.component for place in PLACES[quantity] if place.attribute == attribute]
        readings = [draft.number(part, attribute) for part in parts if part.type in types]
        if any(readings):
            agreed = draft.agreed(readings, why)
            return _over_module(draft, agreed, component) if attribute in _LENGTHS else agreed
    return None


def _common(draft: Draft, quantity: str, gears: tuple[Component, ...], why: str) -> Reading | None:
    """Read a quantity that is equal for both gears. One gear may lack the value."""
    return draft.agreed((_read(draft, quantity, gear, why) for gear in gears), why)


def _over_module(draft: Draft, length: Reading | None, component: Component) -> Reading | None:
    """Divide a length by the module of the component, or else by the module of the pair."""
    module_of_component = draft.number(component, "normal_module")
    module = draft.si("basic_rack.module") if module_of_component is None else module_of_component.si
    if length is None or not module or module < 0.0:
        return None
    return Reading(length.si / module, f"{length.where} over the module")


def _need(draft: Draft, path: str, quantity: str, *components: Component, instead: str = "") -> None:
    """Add a problem if a quantity is missing. The problem names all places of the quantity.

    ``instead``: further places, in words.
    """
    if path in draft.values or _refused(draft, quantity, *components):
        return
    version = shown(draft.model.version) or "version not given"
    draft.problem(
        path,
        f"not in {draft.model.file}, REXS {version}",
        f"for {' or '.join(c.label for c in components)}: {places(quantity)}{instead}",
        "It decides the geometry, so nothing stands in for it. Export it from the program that wrote the "
        f"file, or give it: spurcheck init --from-rexs FILE --set {path}=VALUE.",
    )


def _refused(draft: Draft, quantity: str, *components: Component) -> bool:
    """Whether the value of a quantity in the file is a problem already."""
    attributes = [place.attribute for place in PLACES[quantity]]
    parts = [part for component in components for part in _candidates(draft, component)]
    wheres = {draft.where(part, attribute) for part in parts for attribute in attributes}
    return any(problem.field in wheres for problem in draft.problems)


def places(*quantities: str) -> str:
    """Return the places of some quantities as text: attributes, components and REXS versions."""
    table = [place for quantity in quantities for place in PLACES[quantity]]
    return ", or ".join(
        f"{attribute} of "
        + " or ".join(f"{p.component} (REXS {p.versions})" for p in table if p.attribute == attribute)
        for attribute in dict.fromkeys(place.attribute for place in table)
    )


def _read_teeth(draft: Draft, gear_name: str, gear: Component) -> None:
    teeth = _read(draft, "teeth", gear)
    if teeth is not None and teeth.si != int(teeth.si):
        draft.problem(teeth.where, f"{teeth.si:g}", "a whole number")
    elif teeth is not None:
        draft.put(f"{gear_name}.teeth", int(teeth.si), teeth.where)
    _need(draft, f"{gear_name}.teeth", "teeth", gear)


def _refuse_helix(draft: Draft, gears: tuple[Component, ...]) -> None:
    if not _refused(draft, "helix_angle", *gears):
        draft.problem(
            "helix angle",
            f"not in {draft.model.file}",
            f"0 in {places('helix_angle')}",
            "It decides whether these are spur gears. Export it from the program that wrote the file, or "
            "write the attribute into the file: 0 for a spur gear.",
        )


def _read_shifts(draft: Draft, stage: Component, gears: dict[str, Component]) -> None:
    """Read the profile shifts.

    A missing shift follows from the sum of the shifts. Without a sum, the pair computes the missing shift
    from the centre distance (DIN 3960). Without both, a missing shift is a problem.
    """
    for gear_name, gear in gears.items():
        draft.take(f"{gear_name}.profile_shift", _read(draft, "profile_shift", gear))
    paths = [f"{gear_name}.profile_shift" for gear_name in gears]
    missing = [path for path in paths if path not in draft.values]
    total = _read(draft, "profile_shift_sum", stage)
    if not missing or "basic_rack.module" not in draft.values:  # a length has no coefficient without it
        return
    if total is not None:
        _from_sum(draft, total, paths, missing)
    elif "centre_distance" not in draft.values:
        instead = f"; for {stage.label}: {places('profile_shift_sum', 'centre_distance')}"
        for path, gear in zip(paths, gears.values(), strict=True):
            _need(draft, path, "profile_shift", gear, instead=instead)


def _from_sum(draft: Draft, total: Reading, paths: list[str], missing: list[str]) -> None:
    """Take missing shifts from the sum of the coefficients. Two missing shifts share the sum by a rule."""
    if len(missing) == 1:
        (other,) = set(paths) - set(missing)
        if (known_shift := draft.si(other)) is not None:
            draft.take(missing[0], Reading(total.si - known_shift, f"{total.where}, less {other}"))
        return
    if (teeth := _teeth(draft)) is not None:
        values = shared(total.si, teeth)
        draft.values |= dict(zip(paths, values, strict=True))  # without a source: assumed
        draft.note(
            f"profile shifts are not in the file: their sum {total.si:.4f} is in {total.where}; how the "
            f"gears share it is assumed, {values[0]:.4f} and {values[1]:.4f}: give one, --set "
            "pinion.profile_shift=VALUE"
        )


def _teeth(draft: Draft) -> tuple[int, int] | None:
    """Return the numbers of teeth of pinion and gear. None: a value is missing or not a positive integer."""
    first, second = (draft.values.get(f"{gear_name}.teeth") for gear_name in ("pinion", "gear"))
    if isinstance(first, int) and isinstance(second, int) and min(first, second) > 0:
        return first, second
    return None


def _read_tips(draft: Draft, gears: dict[str, Component]) -> None:
    """Read tip diameters, else the mean of their limits, else addenda, else the addendum coefficient."""
    coefficients = {
        gear_name: _read(draft, "addendum_coefficient", gear) for gear_name, gear in gears.items()
    }
    for gear_name, gear in gears.items():
        if any(f"{gear_name}.{name}" in draft.given for name in _TIPS):
            continue
        limits = [draft.number(gear, place.attribute) for place in PLACES["tip_limits"]]
        if (tip := _read(draft, "tip_diameter", gear)) is not None:
            draft.take(f"{gear_name}.tip_diameter", tip)
        elif (mean := _mean(limits)) is not None:
            draft.take(f"{gear_name}.tip_diameter", mean)
        else:
            draft.take(f"{gear_name}.addendum", _read(draft, "addendum", gear))
    gears_without_tip = [w for w in gears if not any(f"{w}.{name}" in draft.values for name in _TIPS)]
    present = [one for one in coefficients.values() if one is not None]
    used = [one for gear_name in gears_without_tip if (one := coefficients[gear_name]) is not None] or present
    if len(gears_without_tip) == len(gears) and len({one.si for one in used}) > 1:
        draft.agreed(used, "Give a tip diameter: --set pinion.tip_diameter=VALUE, and of the gear.")
    elif used:
        draft.take("basic_rack.addendum_coefficient", used[0])


def _mean(limits: list[Reading | None]) -> Reading | None:
    """Return the mean of the least and the largest value. None: the file lacks one of both."""
    ends = [one for one in limits if one is not None]
    if len(ends) != 2:
        return None
    return Reading(0.5 * (ends[0].si + ends[1].si), f"{ends[0].where} and its maximum, their mean")


def _read_tool(draft: Draft, gears: dict[str, Component]) -> None:
    """Read the tool, whose tip cuts the root. Without a tool, the dedendum follows from root diameters."""
    for name, attributes in _TOOL.items():
        readings = []
        for gear in gears.values():
            for tool in draft.model.tools(gear):
                readings_by_attribute = ((a, draft.number(tool, a)) for a in attributes)
                reading = next(((a, one) for a, one in readings_by_attribute if one is not None), None)
                if reading is not None:
                    attribute, length = reading
                    is_length = attribute in _LENGTHS
                    readings.append(_over_module(draft, length, tool) if is_length else length)
        if name == "dedendum" and not readings:
            readings = _dedenda(draft, gears)
        draft.take_first(f"basic_rack.{name}_coefficient", readings)


def _dedenda(draft: Draft, gears: dict[str, Component]) -> list[Reading | None]:
    """Return h_fP* of both gears from the root diameters, by d_f = m (z + 2 x - 2 h_fP*).

    A missing profile shift x follows from the centre distance.
    """
    module = draft.si("basic_rack.module")
    angle = draft.si("basic_rack.pressure_angle")
    teeth = _teeth(draft)
    if not module or not angle or teeth is None:
        return []
    stated_shifts = draft.si("pinion.profile_shift"), draft.si("gear.profile_shift")
    try:
        shifts = resolved_shifts(stated_shifts, teeth, module, angle, draft.si("centre_distance"))
    except ParameterError:  # the pair refuses them, with their places
        return []
    readings = []
    for gear, z, shift in zip(gears.values(), teeth, shifts, strict=True):
        if (root := draft.number(gear, "root_diameter")) is not None:
            value = 0.5 * (z + 2.0 * shift - root.si / module)
            readings.append(Reading(value, f"{root.where}, by d_f = m (z + 2 x - 2 h_fP*)"))
    return [*readings]
