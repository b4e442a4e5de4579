"""The parameter file of ``spurcheck init --from-rexs``."""

from __future__ import annotations

from pathlib import Path

from lumped.errors import refuse
from validation.commands.terminal import note as tell
from validation.exchange import gear_pair_from_rexs, parameter_text


def text_from_rexs(path: Path | None, stage: int | None) -> tuple[str, str]:
    """Return the parameter file of a REXS stage and a name for it; tell the notes of the import on stderr.

    Parameters
    ----------
    path : REXS file
    stage : number of the stage

    Raises
    ------
    ParameterError : a stage without a file, and everything that ``gear_pair_from_rexs`` refuses
    """
    if path is None:
        raise refuse("--stage", stage, "a stage of the file of --from-rexs", "Give --from-rexs FILE too.")
    mapping, notes = gear_pair_from_rexs(path, stage)
    for note in notes:
        tell(note)
    return parameter_text(mapping, notes), path.name.split(".")[0] or "rexs"
