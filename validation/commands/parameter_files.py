"""spurcheck presets, init, schema: parameter files to start from."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated

import typer

from validation.commands import options as opt
from validation.commands.terminal import guarded, note, stderr, stdout, table


@guarded
def presets(
    name: Annotated[str | None, typer.Argument(help="Show this preset as a parameter file.")] = None,
) -> None:
    """List the built-in gear pairs, or show one of them with all values, units and sources.

    [bold]Examples[/bold]

    spurcheck presets

    spurcheck presets nasa_28_28
    """
    from lumped import load_gear_pair, preset_names
    from lumped.schema.files import preset_text

    if name is not None:
        typer.echo(preset_text(name), nl=False)
        return
    shown = table("", "preset", ">teeth", ">contact ratio", "what it is")
    shown.columns[0].no_wrap = True
    for known in preset_names():
        pair = load_gear_pair(known)
        teeth = f"{pair.pinion.teeth}/{pair.gear.teeth}"
        shown.add_row(known, teeth, f"{pair.geometry.contact_ratio:.3f}", pair.description)
    stdout().print(shown)


@guarded
def init(
    preset: Annotated[str, typer.Argument(help="Preset to start from.")] = opt.DEFAULT_PAIR,
    output: Annotated[
        Path | None, opt.output("File to write; default PRESET.toml (or FILE.toml) here. '-' prints it.")
    ] = None,
    from_rexs: Annotated[
        Path | None,
        typer.Option("--from-rexs", metavar="FILE", help="Start from a spur stage of a REXS file instead."),
    ] = None,
    stage: Annotated[
        int | None, typer.Option("--stage", metavar="N", help="Stage of the REXS file: 1 is the first.")
    ] = None,
    force: opt.Force = False,
) -> None:
    """Write a commented parameter file to edit.

    Every value has its unit beside it, and its source at the end of the file. A bare number means that unit;
    text may carry any unit of the same kind, such as "200 lbf*in".

    REXS is what FVA-Workbench, KISSsoft, MASTA, Romax and Bearinx exchange gear units in. What such a file
    does not say is marked as assumed.

    [bold]Examples[/bold]

    spurcheck init

    spurcheck init nasa_28_28 -o my_pair.toml

    spurcheck init --from-rexs gearbox.rexs --stage 2 -o my_pair.toml
    """
    from lumped.schema.files import preset_text
    from validation.files.output import check_file, write_text

    text, name = preset_text(preset), preset
    if from_rexs is not None or stage is not None:
        text, name = _text_from_rexs(from_rexs, stage)
    if output is not None and str(output) == "-":
        typer.echo(text, nl=False)
        return
    path = check_file(output or Path(f"{name}.toml"), (".toml",), force=force)
    write_text(path, text)
    stderr().print(f"wrote {path}; next: spurcheck report {path} -o report")


def _text_from_rexs(path: Path | None, stage: int | None) -> tuple[str, str]:
    """Parameter file of a stage of a REXS file, and a name for it; notes of the import go to stderr."""
    from lumped.errors import refuse
    from validation.exchange import gear_pair_from_rexs, parameter_text

    if path is None:
        raise refuse("--stage", stage, "a stage of the file of --from-rexs", "Give --from-rexs FILE too.")
    mapping, notes = gear_pair_from_rexs(path, stage)
    for text in notes:
        note(text)
    return parameter_text(mapping, notes), path.name.split(".")[0] or "rexs"


@guarded
def schema(
    output: Annotated[Path | None, opt.output("File to write (.json); default: print it.")] = None,
    force: opt.Force = False,
) -> None:
    """Print the JSON Schema of parameter files: every field with its unit, range and meaning.

    Editors use it to complete and check a parameter file while it is written.

    [bold]Example[/bold]

    spurcheck schema -o spurcheck.schema.json
    """
    from lumped import json_schema
    from validation.files.output import check_file, write_text

    text = json.dumps(json_schema(), indent=2, ensure_ascii=False) + "\n"
    if output is None:
        typer.echo(text, nl=False)
        return
    write_text(check_file(output, (".json",), force=force), text)
    stderr().print(f"wrote {output}")
