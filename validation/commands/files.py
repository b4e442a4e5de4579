"""spurcheck presets, init, export: parameter files to start from, and files for other programs."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path
from typing import Annotated

import typer

from validation.commands import options as opt
from validation.commands.terminal import guarded, note, show, stderr


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
    pairs = {name: load_gear_pair(name) for name in preset_names()}
    rows = (
        (name, f"{p.pinion.teeth}/{p.gear.teeth}", f"{p.geometry.contact_ratio:.3f}", p.description)
        for name, p in pairs.items()
    )
    show("", "preset | >teeth | >contact ratio | what it is", rows)


@guarded
def init(
    preset: Annotated[str, typer.Argument(help="Preset to start from.")] = opt.DEFAULT_PAIR,
    output: Annotated[
        Path | None, opt.output("File to write; default PRESET.toml (or FILE.toml) here. '-' prints it.")
    ] = None,
    from_rexs: Path | None = None,
    stage: int | None = None,
    teeth: str | None = None,
    module: str | None = None,
    face_width: str | None = None,
    speed: opt.Speed = None,
    torque: opt.Torque = None,
    oil: str | None = None,
    law: opt.Law = None,
    settings: opt.Settings = None,
    force: opt.Force = False,
) -> None:
    """Write a commented parameter file to edit.

    A comment states the unit of every value. A number without a unit is in this unit. A text may carry any
    unit of the same kind, such as "200 lbf*in". The end of the file lists sources and assumed values.

    FVA-Workbench, KISSsoft, MASTA, Romax and Bearinx exchange gear units as REXS files. Values that a REXS
    file lacks are assumed and marked. Values that decide the geometry are never assumed: use --set.

    [bold]Examples[/bold]
    spurcheck init
    spurcheck init nasa_28_28 -o my_pair.toml
    spurcheck init --from-rexs gearbox.rexs --stage 2 -o my_pair.toml
    spurcheck init --teeth 19/41 --module 2.5 --face-width 20 --speed 1450 --torque 80 --oil vg220
    spurcheck init --teeth 13/41 --module 2.5 --face-width 20 --speed 1450 --torque 80
    --set pinion.profile_shift=0.4 --set 'bearings.stiffness=300 N/um'

    Parameters
    ----------
    from_rexs FILE : Start from a spur stage of a REXS file instead.
    stage N : Stage of the REXS file: 1 is the first.
    teeth PINION/GEAR : Start from your own pair instead: 19/41.
    module : With --teeth: module, mm.
    face_width : With --teeth: face width of both gears, mm.
    oil : With --teeth: ISO viscosity grade, "ISO VG 220" or vg220.
    """
    from lumped.errors import ParameterError, refuse
    from lumped.schema.changes import fields_of
    from lumped.schema.files import load_gear_pair, preset_names, preset_text
    from validation.exchange import gear_pair_from_rexs, parameter_text
    from validation.exchange.drawing_table import drawing_rows
    from validation.exchange.new_pair_file import new_pair_text
    from validation.files.output import check_file, write_text

    sizes = {"module": module, "face_width": face_width, "speed": speed, "torque": torque}
    fields_by_option = {f"--{name.replace('_', '-')}": (name, value) for name, value in sizes.items()}
    fields_by_option |= {"--oil": ("oil", oil), "--law": ("law", law)}
    fields_by_option |= {f"--set {path}": (path, value) for path, value in opt.set_fields(settings).items()}
    if preset not in preset_names() and (Path(preset).exists() or preset.endswith(".toml")):
        advice = "This is a file already: edit it, or copy it."
        action = advice if Path(preset).exists() else f"To write this file: spurcheck init -o {preset}."
        raise refuse("preset", preset, "one of " + ", ".join(preset_names()), action)
    text = preset_text(preset)
    name = preset
    options_set = {
        option: (path, value) for option, (path, value) in fields_by_option.items() if value is not None
    }
    values = {path: opt.value_of(value) for path, value in options_set.values()}
    options = {field: option for option, (path, _) in options_set.items() for field in fields_of(path)}
    options |= dict.fromkeys(("pinion.teeth", "gear.teeth", "teeth"), "--teeth") | {"oil": "--oil"}
    if teeth is not None:
        if preset != opt.DEFAULT_PAIR or from_rexs is not None:
            raise refuse("--teeth", teeth, "without a preset or REXS file", "Leave one of them out.")
        fields_set = {field for path in values for field in fields_of(path)}
        for option in fields_by_option:
            if option not in options_set and fields_by_option[option][0] in sizes:
                if option == "--torque" and "operating.pinion_power" in fields_set:
                    continue
                action = "Give it, or the power: --set 'power=5 kW'." if option == "--torque" else "Give it."
                raise refuse(option, "missing", "a value beside --teeth", action)
        name = f"pair_{re.sub('[^0-9]+', '_', teeth)}"
        if output is not None and str(output) != "-":
            name = output.stem
    elif from_rexs is None:
        for option, (_, value) in options_set.items():
            action = "Give --teeth PINION/GEAR too, or edit the file."
            raise refuse(option, value, "with --teeth or --from-rexs", action)
    if stage is not None and from_rexs is None:
        raise refuse("--stage", stage, "a stage of the file of --from-rexs", "Give --from-rexs FILE too.")
    if from_rexs is not None:
        mapping, notes = gear_pair_from_rexs(from_rexs, stage, values)
        for remark in notes:
            note(remark)
        text = parameter_text(mapping, notes)
        name = from_rexs.name.split(".")[0] or "rexs"
    elif teeth is not None:
        try:
            text = new_pair_text(name, {"teeth": teeth} | values)
        except ParameterError as error:
            raise opt.by_option(error, options, "") from None
    if output is not None and str(output) == "-":
        typer.echo(text, nl=False)
        return
    for remark in load_gear_pair(tomllib.loads(text)).geometry.notes:
        note(remark)
    path = check_file(output or Path(f"{name}.toml"), (".toml",), force=force)
    write_text(path, text, new=not force)
    rows = drawing_rows(load_gear_pair(tomllib.loads(text)))
    show("Hold it against the drawing:", "quantity | symbol | unit | >pinion | >gear | assumed", rows)
    stderr().print(f"wrote {path}; next: spurcheck report {path} -o report")


@guarded
def export(
    source: str,
    output: Annotated[
        Path,
        opt.output(
            "Of a pair: .rexs or .rexsj (REXS as XML, JSON), .mat or .npz (linear "
            "model). Of a result: .csv, .mat or .nc. The suffix chooses."
        ),
    ],
    speed: opt.Speed = None,
    torque: opt.Torque = None,
    law: opt.Law = None,
    settings: opt.Settings = None,
    supports: opt.Supports = None,
    force: opt.Force = False,
) -> None:
    """Write a gear pair or a result for another program.

    FVA-Workbench, KISSsoft, MASTA, Romax and Bearinx exchange gear units as REXS files; 'spurcheck init
    --from-rexs' reads REXS files. The linear model is the pair averaged over a mesh cycle: matrices A, B, C,
    D from the torques to the transmission error and the displacements, for MATLAB (.mat) and for
    python-control or SciPy (.npz). The linear model is on the springs of 'bearings'; a pair with shafts needs
    --supports springs. A result is any .nc file that spurcheck wrote.

    [bold]Examples[/bold]
    spurcheck export nasa_28_28 -o pair.rexs
    spurcheck export nasa_28_28 --speed 4000 -o averaged.mat
    spurcheck export study-sweep/results.nc -o study.csv

    Parameters
    ----------
    source PAIR|RESULT : Gear pair (preset or TOML), or a result file (.nc).
    """
    from lumped.errors import refuse
    from validation.exchange import write_rexs, write_state_space
    from validation.exchange.results import STATE_SPACE_SUFFIXES, one_table, read_netcdf, write_results
    from validation.exchange.rexs.encodings import FORMS
    from validation.files.output import DATA_SUFFIXES, check_file

    if source.lower().endswith(".nc"):
        options_of_pairs = {
            "--speed": speed,
            "--torque": torque,
            "--law": law,
            "--set": settings,
            "--supports": supports,
        }
        for option, value in options_of_pairs.items():
            if value is not None:
                raise refuse(option, "with a result file", "a gear pair", "Leave it out.")
        check_file(output, DATA_SUFFIXES, force=force)
        result = read_netcdf(source)
        if output.suffix.lower() == ".csv":
            result, left_out = one_table(result)
            if left_out:
                names = ", ".join(left_out)
                stderr().print(f"left out, for they have other axes: {names}; .mat and .nc hold everything")
        write_results(result, output, force=force)
    else:
        pair = opt.gear_pair(source, speed, torque, law, settings)
        check_file(output, (*FORMS, *STATE_SPACE_SUFFIXES), force=force)
        if output.suffix.lower() in STATE_SPACE_SUFFIXES:
            write_state_space(pair, output, force=force, supports=supports)
        elif supports is not None:
            raise refuse("--supports", supports, "with a linear model, .mat or .npz", "Leave it out.")
        else:
            write_rexs(pair, output, force=force)
            left_out_fields = "bearings, shafts, damping, friction law, stiffness model and inertia"
            note(f"REXS is written without {left_out_fields}: keep the parameter file")
    stderr().print(f"wrote {output}")
