"""A gear pair from a stage of a REXS file."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from lumped.errors import FieldProblem, ParameterError, shown
from lumped.fields.units import to_stated
from lumped.schema.files import load_gear_pair
from lumped.schema.pair import GearPair
from validation.exchange.rexs.assumptions import ASSUMED, completed, with_sources
from validation.exchange.rexs.container import read_rexs
from validation.exchange.rexs.doubts import find_doubts, without_contradiction
from validation.exchange.rexs.gears import read_gears
from validation.exchange.rexs.model import RexsModel
from validation.exchange.rexs.operation import driving_first, read_operating_point, read_stage
from validation.exchange.rexs.record import recorded, restored
from validation.exchange.rexs.relief import read_reliefs
from validation.exchange.rexs.said import Said
from validation.exchange.rexs.shafts import read_shafts
from validation.exchange.rexs.stages import Stage, chosen, gears_of
from validation.exchange.rexs.vocabulary import VERSIONS


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
    pair, said = _standard(model, picked)
    said.notes[:0] = notes
    record = recorded(model, picked)
    if record is not None:
        # The record's own export tells which values of the file are still those of the record.
        reference, _ = _standard(*_exported(record, model))
        pair = restored(said, pair, reference, record)
    if model.version not in VERSIONS:
        known = f"versions {', '.join(VERSIONS)} were checked"
        said.note(f"the file is of REXS version {shown(model.version) or '(not given)'}; {known}")
    _note_assumptions(said, pair)
    return pair.to_mapping(), tuple(said.notes)


def _exported(record: GearPair, model: RexsModel) -> tuple[RexsModel, Stage]:
    from validation.exchange.rexs.exporting import rexs_model

    exported = rexs_model(record, file=model.file)
    return exported, chosen(exported, None)[0]


def _standard(model: RexsModel, picked: Stage) -> tuple[GearPair, Said]:
    """Read what REXS itself has attributes for, and assume the rest."""
    said = Said(model)
    stage = model.components[picked.component_id]
    pinion, gear = driving_first(said, stage, gears_of(model, stage))
    read_gears(said, pinion, gear)
    read_stage(said, stage, pinion, gear)
    read_operating_point(said, stage, pinion, gear)
    if said.problems:
        raise ParameterError(said.problems, model.file)
    pair = without_contradiction(said, lambda: _validated(said, picked))
    find_doubts(said, stage, {"pinion": pinion, "gear": gear}, pair)
    read_reliefs(said, stage, {"pinion": pinion, "gear": gear}, pair.geometry)
    read_shafts(said, pinion, gear, lambda: _validated(said, picked))
    if said.problems:
        raise ParameterError(said.problems, model.file)
    return with_sources(_validated(said, picked), said), said


def _validated(said: Said, stage: Stage) -> GearPair:
    """Validate; a refused value is reported with its place in the file."""
    model = said.model
    name = (stage.name.strip() or Path(model.file).stem)[:80]
    written = f", written by {model.application[:200]}" if model.application else ""
    description = f"stage {stage.number} of {model.file}{written}, REXS {shown(model.version)}"
    try:
        return load_gear_pair({"name": name, "description": description} | completed(said.values))
    except ParameterError as error:
        known = said.sources
        problems = [
            FieldProblem(
                p.field, f"{p.value} ({known[p.field]})" if p.field in known else p.value, p.allowed, p.action
            )
            for p in error.problems
        ]
        raise ParameterError(problems, model.file) from None


def _note_assumptions(said: Said, pair: GearPair) -> None:
    assumed = [path for path, source in pair.sources if source.startswith(ASSUMED)]
    for path, what, option in (
        ("operating.pinion_speed", f"{to_stated(pair.operating.pinion_speed, 'rpm'):g} rpm", "--speed"),
        ("operating.pinion_torque", f"{pair.operating.pinion_torque:g} N m", "--torque"),
    ):
        if path in assumed:
            said.note(
                f"{path} is not in the file: {what} is assumed; give your own, for example with {option}"
            )
    if assumed:
        said.note("assumed, not known: " + ", ".join(assumed))
    for which in ("pinion", "gear"):
        sources = dict(pair.sources)
        if f"{which}.inertia" not in sources and f"{which}.mass" in sources:
            said.note(
                f"{which}.inertia: REXS has none of a gear; it is that of a solid disc, not of its mass"
            )
    if pair.pinion.tip_relief or pair.gear.tip_relief:
        said.note("reliefs are read but mesh.relief decides whether the dynamics use them")
