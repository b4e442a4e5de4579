"""spurcheck export: gear pairs and results for other programs."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer

from validation.commands import options as opt
from validation.commands.terminal import guarded, stderr

if TYPE_CHECKING:
    from lumped import GearPair

Form = Literal["elastic", "mesh"]


@guarded
def export(
    source: Annotated[
        str,
        typer.Argument(metavar="PAIR|RESULT", help="Gear pair (preset or TOML), or a result file (.nc)."),
    ],
    output: Annotated[
        Path,
        opt.output(
            "Of a pair: .rexs, .rexsj or .rexsz (REXS as XML, JSON, zipped), .mat or .npz (linear "
            "model). Of a result: .csv, .mat or .nc. The suffix chooses."
        ),
    ],
    rexs_version: Annotated[
        str | None, typer.Option("--rexs-version", metavar="VERSION", help="1.4 to 1.7; default 1.7.")
    ] = None,
    form: Annotated[
        Form | None,
        typer.Option(help="States of the linear model: all 10, or the 6 that feed back; default relative."),
    ] = None,
    speed: opt.Speed = None,
    torque: opt.Torque = None,
    law: opt.Law = None,
    settings: opt.Settings = None,
    force: opt.Force = False,
) -> None:
    """Write a gear pair or a result for another program.

    REXS is what FVA-Workbench, KISSsoft, MASTA, Romax and Bearinx exchange gear units in; 'spurcheck init
    --from-rexs' reads it. The linear model is the pair averaged over a mesh cycle: matrices A, B, C, D from
    the torques to the transmission error and the displacements, for MATLAB (.mat) and for python-control or
    SciPy (.npz). A result is any .nc file that spurcheck wrote.

    [bold]Examples[/bold]

    spurcheck export nasa_28_28 -o pair.rexs

    spurcheck export nasa_28_28 --speed 4000 -o averaged.mat

    spurcheck export study-sweep/results.nc -o study.csv
    """
    from lumped.errors import refuse

    pair_options = {
        "--rexs-version": rexs_version,
        "--form": form,
        "--speed": speed,
        "--torque": torque,
        "--law": law,
        "--set": settings,
    }
    if source.lower().endswith(".nc"):
        given = [name for name, value in pair_options.items() if value is not None]
        if given:
            raise refuse(given[0], "with a result file", "a gear pair", "Leave it out.")
        _export_result(source, output, force=force)
    else:
        pair = opt.gear_pair(source, speed, torque, law, settings)
        _export_pair(pair, output, rexs_version, form, force=force)
    stderr().print(f"wrote {output}")


def _export_pair(
    pair: GearPair, output: Path, rexs_version: str | None, form: Form | None, *, force: bool
) -> None:
    from lumped.errors import refuse
    from validation.exchange import write_rexs, write_state_space
    from validation.exchange.linear_model import STATE_SPACE_SUFFIXES
    from validation.exchange.rexs.container import FORMS
    from validation.exchange.rexs.vocabulary import WRITTEN
    from validation.files.output import check_file

    if output.suffix.lower() in STATE_SPACE_SUFFIXES:
        if rexs_version is not None:
            raise refuse("--rexs-version", f"with {output.suffix}", "a REXS file", "Leave it out.")
        write_state_space(pair, output, form or "elastic", force=force)
        return
    if not output.name.lower().endswith(tuple(FORMS)):
        allowed = "a name ending in " + ", ".join([*FORMS, *STATE_SPACE_SUFFIXES])
        raise refuse("output", output, allowed, "The suffix chooses the format.")
    if form is not None:
        raise refuse("--form", "with a REXS file", "a linear model", "Leave it out.")
    path = check_file(output, (output.suffix.lower(),), force=force)
    write_rexs(pair, path, rexs_version or WRITTEN[-1])


def _export_result(source: str, output: Path, *, force: bool) -> None:
    from validation.exchange.results import one_table, read_netcdf, write_results
    from validation.files.output import DATA_SUFFIXES, check_file

    check_file(output, DATA_SUFFIXES, force=force)
    result = read_netcdf(source)
    if output.suffix.lower() == ".csv":
        result, left_out = one_table(result)
        if left_out:
            names = ", ".join(left_out)
            stderr().print(f"left out, for they have other axes: {names}; .mat and .nc hold everything")
    write_results(result, output, force=force)
