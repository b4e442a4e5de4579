"""A gear pair from a stage of a REXS file."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

from lumped.arguments import whole_number
from lumped.errors import FieldProblem, ParameterError, refuse, shown
from lumped.fields.units import to_stated
from lumped.gear_geometry.geometry import theoretical_backlash
from lumped.schema.changes import by_fields
from lumped.schema.files import load_gear_pair
from lumped.schema.pair import GearPair, leaf_paths
from validation.exchange.new_pair_file import GIVEN, completed, marked, stand_in_stiffness
from validation.exchange.rexs.draft import Draft, Reading
from validation.exchange.rexs.encodings import read_rexs
from validation.exchange.rexs.gears import read_gears, read_reliefs
from validation.exchange.rexs.model import VERSIONS, Component, RexsModel, broken
from validation.exchange.rexs.remarks import note_what_is_assumed
from validation.exchange.rexs.tooth_system import read_tooth_system

_GEARS_OF_PAIR = ("pinion", "gear")
#: Starts of the paths of fields that the file has, too. Values of the user for these fields are used while
#: the file is read. Other values of the user are set afterwards.
_READ_WITH = ("basic_rack.", "centre_distance", "pinion.", "gear.", "lubricant.")
_GEARS = ("cylindrical_gear", "ring_gear", "bevel_gear", "worm_gear", "worm_wheel")
#: A smaller helix angle is zero but for rounding [deg].
_NO_HELIX = 1e-9
#: Field of the viscosity law -> attribute of the oil.
_VISCOSITY_LAW = {
    "kinematic_viscosity_40": "viscosity_at_40_degree_celsius",
    "kinematic_viscosity_100": "viscosity_at_100_degree_celsius",
    "density": "density_at_15_degree_celsius",
}


class _Stage(NamedTuple):
    """A stage of the file.

    ``reason``: why the stage cannot be modelled: kind of the stage, "; ", explanation. Empty: no reason.
    """

    number: int
    component: Component
    gears: list[Component]
    reason: str

    def __str__(self) -> str:
        teeth = "/".join(str(z) for gear in self.gears if (z := _teeth(gear))) or "teeth not given"
        name = self.component.name or self.component.type
        return f"{self.number}: {name} ({teeth}){self.reason and f' - {self.reason}'}"


def gear_pair_from_rexs(
    path: str | Path, stage: int | None = None, changes: Mapping[str, Any] | None = None
) -> tuple[dict[str, Any], tuple[str, ...]]:
    """Read one cylindrical spur stage of a REXS file as parameters of spurcheck.

    Parameters
    ----------
    path : XML (.rexs), JSON (.rexsj) or ZIP (.rexsz, .zip)
    stage : number of the stage in the order of the file, from 1; may be left out if only one stage can be
        modelled. If several can be modelled, the refusal lists the stages
    changes : values that the file does not have, or values to replace, by the names and paths of
        ``pair.with_``: ``{"pinion.tip_diameter": 63.4, "speed": 1450}``

    Returns
    -------
    mapping : nested parameters in file units, valid for ``load_gear_pair``. ``sources`` names component and
        attribute for every value of the file. ``assumed`` lists all other values
    notes : choices, omissions and assumptions, in words

    Raises
    ------
    ParameterError : a hostile or broken file; a stage that is helical, internal, planetary, bevel or worm;
        several stages and no number; a value that decides the geometry and is nowhere in the file: the
        refusal names component, attribute and versions; a value that is refused, or contradicts the others

    Examples
    --------
    >>> from validation.exchange import write_rexs
    >>> import lumped, pathlib, tempfile
    >>> file = pathlib.Path(tempfile.mkdtemp()) / "pair.rexs"
    >>> _ = write_rexs(lumped.load_gear_pair("fzg_c"), file)
    >>> mapping, notes = gear_pair_from_rexs(file)
    >>> mapping["pinion"]["teeth"]
    16
    """
    model = read_rexs(path)
    chosen, notes = _chosen(model, stage)
    values_of_user = by_fields(changes or {})
    with_file = {path: value for path, value in values_of_user.items() if path.startswith(_READ_WITH)}
    draft = Draft(model, with_file, notes=notes)
    component = chosen.component
    gears = dict(zip(_GEARS_OF_PAIR, _driving_first(draft, component, chosen.gears), strict=True))
    read_gears(draft, gears)
    read_tooth_system(draft, component, gears)
    _read_lubricant(draft, component)
    _read_operating_point(draft, component, *gears.values())
    _read_backlash(draft, component, _validated(draft, chosen))
    read_reliefs(draft, component, gears, _validated(draft, chosen).geometry)
    pair = _validated(draft, chosen)
    pair = pair.with_({"mesh.stiffness": {"model": stand_in_stiffness(pair)}})
    values = leaf_paths(pair)
    pair = marked(pair, {path: source for path, source in draft.sources.items() if path in values})
    if set_afterwards := {path: value for path, value in values_of_user.items() if path not in with_file}:
        pair = pair.with_(set_afterwards)
        sources = dict(pair.sources) | dict.fromkeys(set_afterwards, GIVEN)
        pair = load_gear_pair(pair.to_mapping() | {"sources": sources})
    note_what_is_assumed(draft, pair, gears)
    if model.version not in VERSIONS:
        checked_versions = f"versions {', '.join(VERSIONS)} were checked"
        draft.note(f"the file is of REXS version {shown(model.version) or '(not given)'}; {checked_versions}")
    return pair.to_mapping(), tuple(draft.notes)


def _chosen(model: RexsModel, number: int | None) -> tuple[_Stage, list[str]]:
    """Return the stage to import, and notes about the choice."""
    # A planetary stage is listed only if the file does not have its cylindrical stages.
    components = [
        c
        for c in model.components.values()
        if c.type.endswith("_stage")
        and not model.related(c, "assembly", "assembly", "part", "cylindrical_stage")
    ]
    stages = []
    for count, component in enumerate(components, 1):
        roles = ("gear_1", "gear_2")
        gears = [g for role in roles for g in model.related(component, "stage", "stage", role, *_GEARS)]
        stages.append(_Stage(count, component, gears, _reason(model, component, gears)))
    if not stages:
        raise broken(model.file, "it has no gear stage")
    if number is not None:
        stages = [stages[whole_number("stage", number, 1, len(stages)) - 1]]
    listed = "; ".join(map(str, stages))
    usable = [stage for stage in stages if not stage.reason]
    if len(usable) > 1:
        raise refuse("stage", "not given", f"one of {listed}", "Choose a stage by its number.")
    if not usable:
        wanted = "a cylindrical stage of two external spur gears"
        parts = [(f"stage {stage.number}", stage.reason.partition("; ")) for stage in stages]
        problems = [
            FieldProblem(a, kind, wanted, f"{why[0].upper()}{why[1:]}.") for a, (kind, _, why) in parts
        ]
        raise ParameterError(problems, model.file)
    notes = [] if len(stages) == 1 else [f"stage {usable[0].number} is the only spur stage of: {listed}"]
    return usable[0], notes


def _teeth(gear: Component) -> int:
    """Return the number of teeth. 0: the file has no number."""
    try:
        return int(str(gear.attributes["number_of_teeth"].value))
    except (KeyError, ValueError):
        return 0


def _reason(model: RexsModel, stage: Component, gears: list[Component]) -> str:
    """Return the reason why a stage cannot be modelled. Empty: the stage can be modelled."""
    if stage.type != "cylindrical_stage":
        return f"a {shown(stage.type.replace('_', ' '))}; only cylindrical spur stages can be modelled"
    if model.related(stage, "assembly", "part", "assembly", "planetary_stage"):
        return "a mesh of a planetary stage; the planets share the load, one pair alone cannot stand for it"
    if any(gear.type == "ring_gear" or _teeth(gear) < 0 for gear in gears):
        return "a stage with an internal gear; the model is of two external gears"
    if len(gears) != 2 or any(gear.type != "cylindrical_gear" for gear in gears):
        kinds = " and ".join(shown(gear.type.replace("_", " ")) for gear in gears) or "no gear"
        return f"a stage of {kinds}; its 'stage' relation has to name two cylindrical gears"
    for gear in gears:
        helix = Draft(model).number(gear, "helix_angle_reference_diameter")
        angle = 0.0 if helix is None else to_stated(helix.si, "deg")
        if abs(angle) > _NO_HELIX:
            return (
                f"a helical stage, helix angle {angle:g} deg in {gear.label}; the plane model has neither "
                "axial forces nor contact lines that run across the face width"
            )
    return ""


def _validated(draft: Draft, stage: _Stage) -> GearPair:
    """Return the validated pair of the draft. A refused value is reported with its place in the file."""
    model = draft.model
    if draft.problems:
        raise ParameterError(draft.problems, model.file)
    name = (stage.component.name.strip() or Path(model.file).stem)[:80]
    written = f", written by {model.application[:200]}" if model.application else ""
    description = f"stage {stage.number} of {model.file}{written}, REXS {shown(model.version)}"
    try:
        return load_gear_pair({"name": name, "description": description} | completed(draft.values))
    except ParameterError as error:
        places = {path: f" ({where})" for path, where in draft.sources.items()}
        problems = [replace(p, value=p.value + places.get(p.field, "")) for p in error.problems]
        raise ParameterError(problems, model.file) from None


def _driving_first(draft: Draft, stage: Component, gears: list[Component]) -> tuple[Component, Component]:
    """Return the driving and the driven gear. If the file does not state which gear drives, gear_1 drives."""
    flags = [
        [(draft.text(d, "is_driving_gear") or "").lower() for d in draft.model.gear_data(stage, g)]
        for g in gears
    ]
    first, second = ("true" if {"true", "1"} & set(f) else "false" if f and f[0] else "" for f in flags)
    if second == "true" and first != "true":
        return gears[1], gears[0]
    if first != "true" and second != "false":
        draft.note(f"the file does not say which gear drives: gear_1, {gears[0].label}, is taken (assumed)")
    return gears[0], gears[1]


def _read_backlash(draft: Draft, stage: Component, pair: GearPair) -> None:
    """Read the normal backlash, without the share that the centre distance causes.

    ``pair``: pair with the centre distance of the file and with teeth of full thickness.
    """
    low, high = (draft.number(stage, f"{end}_normal_backlash") for end in ("minimum", "maximum"))
    if low is None or high is None:
        return
    share = theoretical_backlash(*pair.wheels, pair.geometry.operating_pressure_angle)
    remark = "" if "centre_distance" not in draft.values else ", without the share of the centre distance"
    # A difference of lengths of about 100 mm, in fifteen digits.
    thinning = round(to_stated(0.5 * (low.si + high.si) - share, "mm"), 12)
    draft.put("mesh.backlash", max(thinning, 0.0), f"{low.where} and maximum, their mean{remark}")


def _read_lubricant(draft: Draft, stage: Component) -> None:
    """Read the oil of the stage or of the casing. If both have no oil, a single oil of the file is read."""
    model = draft.model
    places = [stage, *model.of_type("gear_casing")]
    oils = [oil for place in places for oil in model.referenced(place, "lubricant")]
    oils = oils or (only if len(only := model.of_type("lubricant")) == 1 else [])
    law = "lubricant.viscosity_law"
    if any(path in draft.given for path in ("lubricant.viscosity", f"{law}.iso_vg")):
        if f"{law}.iso_vg" in draft.given:
            draft.take(f"{law}.temperature", draft.first(places, "temperature_lubricant"))
        return
    if not oils:
        return
    v40, v100, density = (draft.number(oils[0], attribute) for attribute in _VISCOSITY_LAW.values())
    viscosity = draft.first(places, "operating_viscosity")
    if v40 is not None and v100 is not None:
        draft.take_all(law, oils[0], _VISCOSITY_LAW)
        draft.take(f"{law}.temperature", draft.first(places, "temperature_lubricant"))
    elif viscosity is not None and density is not None:
        where = f"{viscosity.where} times the density at 15 degC"
        draft.take("lubricant.viscosity", Reading(viscosity.si * density.si, where))


def _read_operating_point(draft: Draft, stage: Component, *gears: Component) -> None:
    """Read speed and torque of the driving gear (the first gear), or else of the first load case."""
    (pinion, shafts), (gear, others) = ((g, draft.model.neighbours(g, "shaft")) for g in gears)
    speed = draft.first((pinion, *shafts), "rotational_speed")
    if speed is None:
        other = draft.first((gear, *others), "rotational_speed")
        teeth = [draft.values.get(f"{gear_name}.teeth", 0) for gear_name in _GEARS_OF_PAIR]
        if other is not None and teeth[0] > 0:
            speed = Reading(other.si * teeth[1] / teeth[0], f"{other.where}, times the gear ratio")
    torque = draft.first(draft.model.gear_data(stage, pinion), "torque") or _external(draft, shafts, speed)
    for path, reading in (("operating.pinion_speed", speed), ("operating.pinion_torque", torque)):
        if reading is not None:
            draft.take(path, Reading(abs(reading.si), reading.where))
    if (cases := len(draft.model.load_cases)) > 1:
        draft.note(f"the file has {cases} load cases; where they matter the first is used")


def _external(draft: Draft, shafts: list[Component], speed: Reading | None) -> Reading | None:
    """Return the torque of the single external load on the shafts of a gear.

    None: the shafts carry several gears, so that the torque of the load is not the torque of the gear.
    """
    model = draft.model
    if len({g.id for s in shafts for g in model.neighbours(s, "cylindrical_gear")}) != 1:
        return None
    loads = [load for s in shafts for load in model.neighbours(s, "external_load")]
    torques, powers = (
        [r for load in loads if (r := draft.first([load], attribute)) is not None and r.si]
        for attribute in ("torque_around_u_axis", "power")
    )
    if len(torques) == 1:
        return torques[0]
    if not torques and len(powers) == 1 and speed is not None and speed.si:
        return Reading(powers[0].si / speed.si, f"{powers[0].where} over the speed")
    return None
