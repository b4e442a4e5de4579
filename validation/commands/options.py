"""Options that several commands share. Functions here turn options into gear pairs, axes and files."""

from __future__ import annotations

import math
import re
import tomllib
import warnings
from collections import Counter
from collections.abc import Callable, Iterable, Mapping
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal, NamedTuple

import typer

from validation.commands.cluster import refuse_no_address
from validation.commands.terminal import Early, Group, note, stderr

if TYPE_CHECKING:
    import numpy as np
    import xarray as xr
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from floquet.engine.chart import ChartAxis
    from lumped import GearPair
    from lumped.errors import ParameterError

DEFAULT_PAIR = "nasa_28_28"
_LARGEST_COUNT = 5000
#: Fields that only some friction laws or forms of relief read.
_READ_BY_LAWS = re.compile(r"^(friction\.(?!law$)|lubricant\.)|\.(roughness$|(tip|root)_relief)")


def output(help: str) -> Any:
    """Return the option --output, which names the file or folder to write. ``help``: kinds of files."""
    return typer.Option("--output", "-o", help=help)


PairArgument = Annotated[
    str | None,
    typer.Argument(
        metavar="PAIR",
        help="Preset (see 'spurcheck presets') or parameter file (TOML).",
        show_default=DEFAULT_PAIR,
    ),
]
Speed = Annotated[str | None, typer.Option("--speed", help="Pinion speed in rpm, or '200 rad/s'.")]
Torque = Annotated[str | None, typer.Option("--torque", help="Pinion torque in N m, or '200 lbf*in'.")]
Range = Annotated[
    str | None,
    typer.Option(
        "--range",
        metavar="FROM..TO",
        help="Pinion speeds: 200..3000 (rpm) or '10..50 Hz'; default: to about twice the operating speed.",
    ),
]
Law = Annotated[str | None, typer.Option("--law", help="Friction law: I to V, none, or a name: coulomb.")]
SupportsName = Literal["springs", "shafts"]
Supports = Annotated[
    SupportsName | None,
    typer.Option(
        "--supports",
        help="What holds the gears: springs, the four of 'bearings', or the elastic 'shafts'. "
        "Default: shafts where the file has them.",
        show_default=False,
    ),
]
Settings = Annotated[
    list[str] | None,
    typer.Option(
        "--set",
        metavar="FIELD=VALUE",
        help="Change any parameter, as often as needed: --set 'lubricant.viscosity=8 mPa*s'.",
    ),
]
SAMPLES = 128
SAMPLE_SECONDS = 30.0
Samples = Annotated[
    int | None,
    typer.Option(
        help="Number of possible machines; all of them are computed.",
        show_default=f"{SAMPLES}, as far as --seconds go",
    ),
]
Seconds = Annotated[
    float | None,
    typer.Option(
        help="Processor time after which no further machine begins.",
        show_default=f"{SAMPLE_SECONDS:.0f} without --samples",
    ),
]
Cluster = Annotated[
    str | None,
    typer.Option(
        "--cluster",
        metavar="ADDRESS",
        help="Dask cluster that computes: the address of its scheduler, tcp://HOST:8786, or local:8, a "
        "cluster of 8 workers on this machine.",
        show_default=False,
    ),
    Early(refuse_no_address),
]
WaitSeconds = Annotated[
    float | None,
    typer.Option(
        "--wait-seconds",
        help="Longest time in which the cluster has no worker, in seconds; default 300.",
        show_default=False,
    ),
]
Json = Annotated[bool, typer.Option("--json", help="Print the numbers as JSON (SI units) and nothing else.")]
Force = Annotated[bool, typer.Option("--force", help="Overwrite what is there already.")]
ForceFolder = Annotated[
    bool, typer.Option("--force", help="Replace what this command wrote into that folder earlier.")
]


def limits_of_samples(
    samples: int | None, seconds: float | None, cluster: str | None = None
) -> dict[str, Any]:
    """Return the number of samples and the time limit.

    If the user states a number of samples, all samples are computed, unless --seconds sets a limit. On a
    cluster all samples are computed.
    """
    if cluster is not None:
        if seconds is not None:
            from lumped.errors import refuse

            action = "Leave it out, and state --samples: a cluster computes all of them."
            raise refuse("seconds", seconds, "none with --cluster", action)
        return {"samples": SAMPLES if samples is None else samples, "seconds": None}
    if samples is None:
        return {"samples": SAMPLES, "seconds": SAMPLE_SECONDS if seconds is None else seconds}
    return {"samples": samples, "seconds": seconds}


def time_words(samples: xr.Dataset) -> str:
    """Say that the time limit ended the sampling, and how to compute all samples."""
    seconds = samples.attrs["seconds"]
    samples_wanted = samples.attrs["asked"]
    return f"the time of {seconds:g} s was used up; --samples {samples_wanted} takes all"


def gear_pair(
    pair: str | None,
    speed: str | None = None,
    torque: str | None = None,
    law: str | None = None,
    settings: list[str] | None = None,
    speed_range: str | None = None,
    variant: str | None = None,
) -> GearPair:
    """Load a gear pair and apply the options of the command line.

    Without a name of a pair, the example is loaded and a note says so. ``variant`` holds further changes,
    FIELD=VALUE, separated by semicolons.
    """
    from lumped import load_gear_pair
    from lumped.errors import ParameterError
    from lumped.schema.changes import fields_of
    from validation.validity.plausibility import parameter_warnings

    settings_wanted = [(f"--set {path}", path, text) for path, text in set_fields(settings).items()]
    changes = [] if variant is None else variant.split(";")
    settings_wanted += [
        (f"--variant {path}", path, text) for path, text in set_fields(changes, "--variant").items()
    ]
    for name, text in (("speed", speed), ("torque", torque), ("law", law), ("range", speed_range)):
        if text is not None:
            settings_wanted.append((f"--{name}", fields_of(name)[0], text))
    once(field for _, path, _ in settings_wanted for field in fields_of(path))
    if pair is None:
        note(f"no gear pair is named, so this is the example {DEFAULT_PAIR}: name your parameter file.")
    pair_as_read = load_gear_pair(pair or DEFAULT_PAIR)
    try:
        pair_as_set = pair_as_read.with_({path: value_of(text) for _, path, text in settings_wanted})
    except ParameterError as error:
        options = {field: option for option, path, _ in settings_wanted for field in (path, *fields_of(path))}
        raise by_option(error, options, error.source.removesuffix(" varied")) from None
    for option, path, text in settings_wanted:
        others = {other: value_of(value) for _, other, value in settings_wanted if other != path}
        if _READ_BY_LAWS.search(fields_of(path)[0]) and not _has_effect(pair_as_read, pair_as_set, others):
            has_composite_roughness = (
                path.endswith(".roughness") and pair_as_set.friction.composite_roughness is not None
            )
            law = (
                "friction.composite_roughness is given"
                if has_composite_roughness
                else f"the law is {pair_as_set.friction.law}"
            )
            why = f"mesh.relief is '{pair_as_set.mesh.relief}'" if "relief" in path else law
            note(f"{option} = {text} changes nothing in the motion: {why}.")
        if pair_as_set.shafts is not None and fields_of(path)[0].startswith("bearings."):
            note(f"{option} = {text} changes nothing on the shafts, which hold the gears: see --supports.")
    if pair_as_set.stiffness_note:
        note(pair_as_set.stiffness_note)
    for warning in parameter_warnings(pair_as_set):
        note(warning)
    return pair_as_set


def _has_effect(pair_as_read: GearPair, pair_as_set: GearPair, other_changes: dict[str, Any]) -> bool:
    """Whether one of several changes has an effect on the laws of a gear pair.

    The laws with all changes (``pair_as_set``) are compared with the laws without this change
    (``pair_as_read`` with ``other_changes``).
    """
    from lumped import LawRangeWarning
    from lumped.errors import ParameterError
    from lumped.quasi_static.contacts import contact_of

    def laws(gear_pair: GearPair) -> list[bytes]:
        elements = contact_of(gear_pair).elements(gear_pair)
        functions = (elements.stiffness, elements.friction, elements.error)
        return [array.tobytes() for law in functions for array in (law.breaks, law.coefficients)]

    with warnings.catch_warnings(), suppress(ParameterError):  # the other changes alone may be refused
        warnings.simplefilter("ignore", LawRangeWarning)
        without_the_change = pair_as_read.with_(other_changes)
        return without_the_change == pair_as_set or laws(without_the_change) != laws(pair_as_set)
    return True


def alike(pair: GearPair) -> GearPair:
    """Return the twin with like teeth, for a command that needs like teeth. A note names this replacement."""
    if pair.healthy is not pair:
        note("this command takes all teeth of a gear as alike; spurcheck teeth takes them as given.")
    return pair.healthy


class Files(NamedTuple):
    """Output files of a command. The paths are checked before any computation."""

    paths: tuple[Path, ...]
    force: bool

    def write(self, data: xr.Dataset, draw: Callable[[], Figure] | None = None) -> None:
        """Write data or a figure to each file, by suffix. ``draw``: replaces the function ``plot``."""
        from validation.exchange.results import write_results
        from validation.files.output import DATA_SUFFIXES

        figure = None
        for path in self.paths:
            if path.suffix.lower() in DATA_SUFFIXES:
                write_results(data, path, force=self.force)
            else:
                from validation.plots.of_result import plot
                from validation.plots.style import save

                figure = figure or (draw() if draw else plot(data))
                save(figure, path, new=not self.force)
            stderr().print(f"wrote {path}")


def _files(kinds: str) -> Group:
    """Return the options --output and --force. ``kinds``: "data", "figure" or "data figure"."""
    words = {
        "data": ".nc (NetCDF), .mat (MATLAB) or .csv for data",
        "figure": ".png, .svg or .pdf for the figure",
    }
    text = f"Result file, as often as needed: {', '.join(words[kind] for kind in kinds.split())}."

    def make(output: list[Path] | None, force: bool | None) -> Files:
        from validation.files.output import DATA_SUFFIXES, FIGURE_SUFFIXES, check_file

        suffixes_by_kind = {"data": DATA_SUFFIXES, "figure": FIGURE_SUFFIXES}
        suffixes = tuple(suffix for kind in kinds.split() for suffix in suffixes_by_kind[kind])
        return Files(tuple(check_file(one, suffixes, force=bool(force)) for one in output or ()), bool(force))

    return Group({"output": Annotated[list[Path] | None, output(text)], "force": Force}, make)


ResultFiles = Annotated[Files, _files("data figure")]
DataFiles = Annotated[Files, _files("data")]
FigureFiles = Annotated[Files, _files("figure")]
_PAIR = {"pair": PairArgument, "speed": Speed, "torque": Torque, "law": Law, "settings": Settings}
_RANGED = _PAIR | {"speed_range": Range}
#: `Pair`: a pair with its teeth as given. `NamedPair`: the name of the pair and the pair, with --range.
#: `AlikePair`: a pair with like teeth, with --range.
Pair = Annotated["GearPair", Group(_PAIR, gear_pair)]
NamedPair = Annotated[
    "tuple[str, GearPair]",
    Group(_RANGED, lambda pair, **options: (pair or DEFAULT_PAIR, gear_pair(pair, **options))),
]
AlikePair = Annotated["GearPair", Group(_RANGED, lambda **options: alike(gear_pair(**options)))]


def once(fields: Iterable[str]) -> None:
    """Refuse a field that is set twice: only the last value would count."""
    from lumped.errors import refuse

    for field, count in Counter(fields).items():
        if count > 1:
            raise refuse(field, f"set {count} times", "one value", "Leave the others out.")


def set_fields(settings: list[str] | None, option: str = "--set") -> dict[str, str]:
    """Return field path -> text of the value, for every --set. ``option``: the name in a refusal."""
    from lumped.errors import refuse

    fields: dict[str, str] = {}
    for item in settings or []:
        path, separator, text = item.partition("=")
        if not separator or not path.strip():
            raise refuse(option, item, "FIELD=VALUE", f"For example {option} mesh.damping_ratio=0.03.")
        once([*fields, path.strip()])
        fields[path.strip()] = text.strip()
    return fields


def by_option(error: ParameterError, options: Mapping[str, str], source: str) -> ParameterError:
    """Return the refusal with names of options in place of fields. Equal problems are listed once."""
    from lumped.errors import ParameterError

    problems = [replace(p, field=options.get(p.field, p.field)) for p in error.problems]
    return ParameterError(list(dict.fromkeys(problems)), source)


def value_of(text: str) -> Any:
    """Return the value of an option as a parameter file reads it. A text that is no TOML value stays text."""
    try:
        return tomllib.loads(f"value = {text}")["value"]
    except (tomllib.TOMLDecodeError, RecursionError):
        return text


def axis_values(
    text: str, axes: Mapping[str, ChartAxis], option: str = "--axis"
) -> tuple[str, NDArray[np.float64]]:
    """Return name and values of an axis written NAME=FROM:TO:COUNT.

    ``axes``: the axes that are allowed. ``option``: name of the option in a refusal.
    """
    import numpy as np

    from lumped.arguments import nearest
    from lumped.errors import ParameterError, refuse

    name, separator, values = (part.strip() for part in text.partition("="))
    allowed = f"NAME=FROM:TO:COUNT with different ends and a count from 2 to {_LARGEST_COUNT}"
    example = "speed_rpm=1000:20000:80" if "speed_rpm" in axes else f"{next(iter(axes))}=1:2:80"
    refusal = refuse(option, text, allowed, f"For example {option} {example}.")
    *ends, count = values.split(":")
    if not separator or len(ends) != 2 or not count.strip().isdecimal():
        raise refusal
    if name not in axes:
        advice = nearest(name, axes) or "Choose one of them."
        raise refuse(option, name, "one of " + ", ".join(axes), advice)
    low, high = sorted(number_in(option, end, axes[name].units) for end in ends)
    if low == high or not 2 <= int(count) <= _LARGEST_COUNT:
        raise refusal
    axis_points = np.linspace(low, high, int(count))
    try:
        axes[name].check(name, axis_points)
    except ParameterError as error:
        raise by_option(error, {f"axes[{name!r}]": f"{option} {name}"}, "") from None
    return name, axis_points


def axes_values(texts: list[str] | None, axes: Mapping[str, ChartAxis]) -> dict[str, NDArray[np.float64]]:
    """Return axis name -> values, see `axis_values`. An axis that is given twice is refused."""
    values_by_name = [axis_values(text, axes) for text in texts or []]
    once(f"--axis {name}" for name, _ in values_by_name)
    return dict(values_by_name)


def number_in(option: str, text: str, unit: str) -> float:
    """Return the number that a text states, in ``unit``. The text may carry any unit of the same kind.

    ``option``: name of the option in a refusal.
    """
    from lumped.errors import refuse
    from lumped.fields.units import to_si, to_stated

    stated = unit.replace(" ", "*")
    allowed = "a number" if unit == "1" else f"a number in {unit}"
    try:
        number = to_stated(to_si(value_of(text.strip()), stated), stated)
    except (ValueError, TypeError) as error:
        raise refuse(option, text, allowed, f"{error}.") from None
    if not math.isfinite(number):
        raise refuse(option, text, allowed, "Correct it.")
    return number
