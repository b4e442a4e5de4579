"""Options that several commands share, and how they become a gear pair."""

from __future__ import annotations

import tomllib
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import typer

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    import xarray as xr
    from matplotlib.figure import Figure

    from lumped import GearPair
    from lumped.errors import ParameterError

DEFAULT_PAIR = "nasa_28_28"

PairArgument = Annotated[
    str,
    typer.Argument(
        metavar="PAIR",
        help="Gear pair: the name of a preset (see 'spurcheck presets') or a parameter file (TOML).",
    ),
]
Speed = Annotated[
    str | None,
    typer.Option("--speed", help="Pinion speed; a bare number is rpm, or write the unit: '200 rad/s'."),
]
Torque = Annotated[
    str | None,
    typer.Option("--torque", help="Pinion torque; a bare number is N m, or write the unit: '200 lbf*in'."),
]
Range = Annotated[
    str | None,
    typer.Option(
        "--range",
        metavar="FROM..TO",
        help="Pinion speeds to cover: 200..3000 (rpm) or '10..50 Hz'; default: from near zero to about twice "
        "the operating speed.",
    ),
]
Law = Annotated[
    str | None,
    typer.Option(
        "--law",
        help="Friction law: I to V, none, or a name such as coulomb; an unknown name lists them all.",
    ),
]
Supports = Annotated[
    Literal["springs", "shafts"],
    typer.Option(
        help="What holds the gears: the springs of 'bearings', or the elastic shafts of the section 'shafts'."
    ),
]
Settings = Annotated[
    list[str] | None,
    typer.Option(
        "--set",
        metavar="FIELD=VALUE",
        help="Change any parameter, as often as needed: --set mesh.damping_ratio=0.03 "
        "--set 'lubricant.viscosity=8 mPa*s'.",
    ),
]
Json = Annotated[bool, typer.Option("--json", help="Print the numbers as JSON (SI units) and nothing else.")]
Force = Annotated[bool, typer.Option("--force", help="Overwrite what is there already.")]
ForceFolder = Annotated[
    bool, typer.Option("--force", help="Replace what this command wrote into that folder earlier.")
]


def output(help: str) -> Any:
    """Return the option that names the file or folder to write; ``help`` says what can be written."""
    return typer.Option("--output", "-o", help=help)


def gear_pair(
    source: str,
    speed: str | None,
    torque: str | None,
    law: str | None,
    settings: list[str] | None,
    speed_range: str | None = None,
) -> GearPair:
    """Load a gear pair and apply the overrides of the command line.

    Raises
    ------
    ParameterError : everything that a parameter file could be refused for, and a --set without '='
    """
    from lumped import load_gear_pair
    from lumped.errors import ParameterError
    from validation.commands.terminal import note
    from validation.validity.plausibility import doubts

    changes: dict[str, Any] = {}
    options: dict[str, str] = {}
    for path, text in set_fields(settings).items():
        changes[path] = value_of(text)
        options[path] = f"--set {path}"
    for option, path, text_or_none in (
        ("--speed", "operating.pinion_speed", speed),
        ("--torque", "operating.pinion_torque", torque),
        ("--law", "friction.law", law),
        ("--range", "operating.speed_range", speed_range),
    ):
        if text_or_none is not None:
            changes[path] = value_of(text_or_none)
            options[path] = option
    pair = load_gear_pair(source)
    try:
        pair = pair.with_(changes)
    except ParameterError as error:
        raise by_option(error, options, error.source.removesuffix(" varied")) from None
    for doubt in doubts(pair):
        note(doubt)
    return pair


def set_fields(settings: list[str] | None) -> dict[str, str]:
    """Return field path -> text of its value of every --set.

    Raises
    ------
    ParameterError : a --set without '='
    """
    from lumped.errors import refuse

    found: dict[str, str] = {}
    for item in settings or []:
        path, separator, text = item.partition("=")
        if not separator or not path.strip():
            raise refuse("--set", item, "FIELD=VALUE", "For example --set mesh.damping_ratio=0.03.")
        found[path.strip()] = text.strip()
    return found


def check_supports(pair: GearPair, supports: Literal["springs", "shafts"]) -> None:
    """Refuse shafts that the pair does not have, before any work.

    Raises
    ------
    ParameterError : "shafts" of a pair without them
    """
    from lumped.errors import refuse

    if supports == "shafts" and pair.shafts is None:
        action = "Describe its shafts in the parameter file, or leave the option out."
        raise refuse("--supports", supports, "springs for a pair without [shafts]", action)


def by_option(error: ParameterError, options: Mapping[str, str], source: str) -> ParameterError:
    """Return a refusal that names the options where fields come from them, each problem of an option once."""
    from lumped.errors import ParameterError

    problems = [replace(p, field=options.get(p.field, p.field)) for p in error.problems]
    return ParameterError(list(dict.fromkeys(problems)), source)


def value_of(text: str) -> Any:
    """Value of an option as a parameter file would read it; anything but a TOML value is text."""
    try:
        return tomllib.loads(f"value = {text}")["value"]
    except (tomllib.TOMLDecodeError, RecursionError):
        return text


def figure_or_data(output: Path | None, *, force: bool) -> Path | None:
    """Check an output file that may be data or a figure, before any work."""
    from validation.files.output import DATA_SUFFIXES, FIGURE_SUFFIXES, check_file

    return None if output is None else check_file(output, DATA_SUFFIXES + FIGURE_SUFFIXES, force=force)


def write_result(target: Path, data: xr.Dataset, draw: Callable[[], Figure]) -> None:
    """Write data or the figure of it, as the suffix of the target says."""
    from validation.files.output import DATA_SUFFIXES, write_dataset

    if target.suffix.lower() in DATA_SUFFIXES:
        write_dataset(data, target)
    else:
        from validation.plots.style import save

        save(draw(), target)
