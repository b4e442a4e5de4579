"""A gear pair from a stage of a REXS file."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from lumped.errors import FieldProblem, ParameterError, shown
from lumped.fields.units import to_stated
from lumped.schema.files import load_gear_pair
from lumped.schema.pair import GearPair, leaf_paths
from validation.exchange.rexs.contradictions import warn_of_contradictions, without_contradiction
from validation.exchange.rexs.draft import ASSUMED, Draft, completed
from validation.exchange.rexs.encodings import read_rexs
from validation.exchange.rexs.gears import read_gears, read_reliefs
from validation.exchange.rexs.operation import (
    driving_first,
    read_backlash,
    read_lubricant,
    read_operating_point,
)
from validation.exchange.rexs.shafts import read_shafts
from validation.exchange.rexs.stages import Stage, chosen, gears_of
from validation.exchange.rexs.vocabulary import VERSIONS

#: Assumptions that say more than the word.
_BECAUSE = {
    "operating.pinion_torque": "assumed: tangential load over face width and module of 20 N/mm^2",
    "operating.pinion_speed": "assumed: a round number",
}


def gear_pair_from_rexs(path: str | Path, stage: int | None = None) -> tuple[dict[str, Any], tuple[str, ...]]:
    """Read one cylindrical spur stage of a REXS file as parameters of spurcheck.

    Parameters
    ----------
    path : XML (.rexs), JSON (.rexsj) or ZIP (.rexsz, .zip)
    stage : number of the stage as ``rexs_stages`` lists them, 1 the first; may be left out where only one
        can be modelled

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
    picked, notes = chosen(model, stage)
    draft = Draft(model, notes=notes)
    component = model.components[picked.component_id]
    pinion, gear = driving_first(draft, component, gears_of(model, component))
    gears = {"pinion": pinion, "gear": gear}

    def validated() -> GearPair:
        return _validated(draft, picked)

    def check_problems() -> None:
        if draft.problems:
            raise ParameterError(draft.problems, model.file)

    read_gears(draft, pinion, gear)
    draft.take("centre_distance", draft.number(component, "center_distance"))
    read_lubricant(draft, component)
    read_operating_point(draft, component, pinion, gear)
    check_problems()
    read_backlash(draft, component, without_contradiction(draft, validated))
    pair = without_contradiction(draft, validated)
    warn_of_contradictions(draft, component, gears, pair)
    read_reliefs(draft, component, gears, pair.geometry)
    read_shafts(draft, gears, validated)
    check_problems()
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


def _validated(draft: Draft, stage: Stage) -> GearPair:
    """Validate; a refused value is reported with its place in the file."""
    model = draft.model
    name = (stage.name.strip() or Path(model.file).stem)[:80]
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
    for path, what, option in (
        ("operating.pinion_speed", f"{to_stated(pair.operating.pinion_speed, 'rpm'):g} rpm", "--speed"),
        ("operating.pinion_torque", f"{pair.operating.pinion_torque:g} N m", "--torque"),
    ):
        if path in assumed:
            text = f"{path} is not in the file: {what} is assumed"
            draft.note(f"{text}; give your own, for example with {option}")
    if assumed:
        draft.note("assumed, not known: " + ", ".join(assumed))
    for which in ("pinion", "gear"):
        if f"{which}.inertia" not in sources and f"{which}.mass" in sources:
            text = f"{which}.inertia: REXS has none of a gear; it is that of a solid disc, not of its mass"
            draft.note(text)
    if pair.pinion.tip_relief or pair.gear.tip_relief:
        draft.note("reliefs are read but mesh.relief decides whether the dynamics use them")
