"""A gear pair from a stage of a REXS file."""

from __future__ import annotations

from pathlib import Path
from typing import Any, NamedTuple

from lumped.arguments import whole_number
from lumped.errors import FieldProblem, ParameterError, refuse, shown
from lumped.fields.units import to_stated
from lumped.schema.files import load_gear_pair
from lumped.schema.pair import GearPair, leaf_paths
from validation.exchange.rexs.contradictions import warn_of_contradictions, without_contradiction
from validation.exchange.rexs.draft import ASSUMED, Draft, completed
from validation.exchange.rexs.encodings import read_rexs
from validation.exchange.rexs.gears import read_gears, read_reliefs
from validation.exchange.rexs.model import Component, RexsModel, broken
from validation.exchange.rexs.operation import (
    driving_first,
    read_backlash,
    read_lubricant,
    read_operating_point,
)
from validation.exchange.rexs.shafts import read_shafts
from validation.exchange.rexs.vocabulary import VERSIONS

_GEARS = ("cylindrical_gear", "ring_gear", "bevel_gear", "worm_gear", "worm_wheel")
#: Helix angles below this are what a program leaves of a zero [deg].
_NO_HELIX = 1e-9
#: Assumptions that say more than the word.
_BECAUSE = {
    "operating.pinion_torque": "assumed: tangential load over face width and module of 20 N/mm^2",
    "operating.pinion_speed": "assumed: a round number",
}


class _Stage(NamedTuple):
    """A stage; the reason why it cannot be modelled: what it is instead, and after "; " why that matters."""

    number: int
    component: Component
    gears: list[Component]
    reason: str

    def __str__(self) -> str:
        teeth = "/".join(str(z) for gear in self.gears if (z := _teeth(gear))) or "teeth not given"
        name = self.component.name or self.component.type
        return f"{self.number}: {name} ({teeth}){self.reason and f' - {self.reason}'}"


def gear_pair_from_rexs(path: str | Path, stage: int | None = None) -> tuple[dict[str, Any], tuple[str, ...]]:
    """Read one cylindrical spur stage of a REXS file as parameters of spurcheck.

    Parameters
    ----------
    path : XML (.rexs), JSON (.rexsj) or ZIP (.rexsz, .zip)
    stage : number of the stage in the order of the file, 1 the first; may be left out where only one can be
        modelled: otherwise the refusal lists them

    Returns
    -------
    mapping : nested parameters in file units, valid for ``load_gear_pair``; under ``sources`` every value has
        its component and attribute in the file, or "assumed" where the file says nothing; "doubtful" in it
        names what in the file contradicts the value
    notes : what was assumed, left out, chosen or is doubtful, in words

    Raises
    ------
    ParameterError : a hostile or broken file; a stage that is helical, internal, planetary, bevel or worm;
        several stages and no number; a value that is missing and cannot be assumed, or that is refused

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
    picked, notes = _chosen(model, stage)
    draft, component = Draft(model, notes=notes), picked.component
    pinion, gear = driving_first(draft, component, picked.gears)
    gears = {"pinion": pinion, "gear": gear}

    def validated() -> GearPair:
        if draft.problems:
            raise ParameterError(draft.problems, model.file)
        return _validated(draft, picked)

    read_gears(draft, pinion, gear)
    draft.take("centre_distance", draft.number(component, "center_distance"))
    read_lubricant(draft, component)
    read_operating_point(draft, component, pinion, gear)
    read_backlash(draft, component, without_contradiction(draft, validated))
    pair = without_contradiction(draft, validated)
    warn_of_contradictions(draft, component, gears, pair)
    read_reliefs(draft, component, gears, pair.geometry)
    read_shafts(draft, gears, validated)
    pair = validated()
    sources = {
        path: draft.sources.get(path) or _BECAUSE.get(path, ASSUMED)
        for path in sorted(leaf_paths(pair))
        if path not in ("name", "description")
    }
    if model.version not in VERSIONS:
        known = f"versions {', '.join(VERSIONS)} were checked"
        draft.note(f"the file is of REXS version {shown(model.version) or '(not given)'}; {known}")
    _note_assumptions(draft, pair, sources)
    return pair.to_mapping() | {"sources": sources}, tuple(draft.notes)


def _chosen(model: RexsModel, number: int | None) -> tuple[_Stage, list[str]]:
    """Return the stage to import, and notes about the choice."""
    # A planetary stage counts only where its parts are not in the file.
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
        problems = []
        for stage in stages:
            kind, _, why = stage.reason.partition("; ")
            action = f"{why[:1].upper()}{why[1:]}."
            problems.append(FieldProblem(f"stage {stage.number}", kind, wanted, action))
        raise ParameterError(problems, model.file)
    notes = [] if len(stages) == 1 else [f"stage {usable[0].number} is the only spur stage of: {listed}"]
    return usable[0], notes


def _teeth(gear: Component) -> int:
    """Number of teeth; 0 where the file has none."""
    try:
        return int(str(gear.attributes["number_of_teeth"].value))
    except (KeyError, ValueError):
        return 0


def _reason(model: RexsModel, stage: Component, gears: list[Component]) -> str:
    """Why a stage cannot be modelled."""
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
    """Validate; a refused value is reported with its place in the file."""
    model = draft.model
    name = (stage.component.name.strip() or Path(model.file).stem)[:80]
    written = f", written by {model.application[:200]}" if model.application else ""
    description = f"stage {stage.number} of {model.file}{written}, REXS {shown(model.version)}"
    try:
        return load_gear_pair({"name": name, "description": description} | completed(draft.values))
    except ParameterError as error:
        places = {path: f" ({where})" for path, where in draft.sources.items()}
        problems = [
            FieldProblem(p.field, p.value + places.get(p.field, ""), p.allowed, p.action)
            for p in error.problems
        ]
        raise ParameterError(problems, model.file) from None


def _note_assumptions(draft: Draft, pair: GearPair, sources: dict[str, str]) -> None:
    assumed = [path for path, source in sources.items() if source.startswith(ASSUMED)]
    speed = f"{to_stated(pair.operating.pinion_speed, 'rpm'):g} rpm"
    for key, what in (("speed", speed), ("torque", f"{pair.operating.pinion_torque:g} N m")):
        if f"operating.pinion_{key}" in assumed:
            text = f"operating.pinion_{key} is not in the file: {what} is assumed"
            draft.note(f"{text}; give your own, for example with --{key}")
    if assumed:
        draft.note("assumed, not known: " + ", ".join(assumed))
    for which in ("pinion", "gear"):
        if f"{which}.inertia" not in sources and f"{which}.mass" in sources:
            text = f"{which}.inertia: REXS has none of a gear; it is that of a solid disc, not of its mass"
            draft.note(text)
    if pair.pinion.tip_relief or pair.gear.tip_relief:
        draft.note("reliefs are read but mesh.relief decides whether the dynamics use them")
