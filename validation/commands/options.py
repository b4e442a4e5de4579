"""Options that several commands share, and how they become gear pairs, axes and files."""

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

from validation.commands.terminal import Group, note, stderr

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
    """Return the option that names the file or folder to write; ``help`` says what can be written."""
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
Json = Annotated[bool, typer.Option("--json", help="Print the numbers as JSON (SI units) and nothing else.")]
Force = Annotated[bool, typer.Option("--force", help="Overwrite what is there already.")]
ForceFolder = Annotated[
    bool, typer.Option("--force", help="Replace what this command wrote into that folder earlier.")
]


def limits_of_samples(samples: int | None, seconds: float | None) -> dict[str, Any]:
    """How many samples, and for how long: a number that is asked for is computed however long it takes."""
    if samples is None:
        return {"samples": SAMPLES, "seconds": SAMPLE_SECONDS if seconds is None else seconds}
    return {"samples": samples, "seconds": seconds}


def time_words(found: xr.Dataset) -> str:
    """What ended the samples, and how they go on."""
    return f"the time of {found.attrs['seconds']:g} s was used up; --samples {found.attrs['asked']} takes all"


def gear_pair(
    pair: str | None,
    speed: str | None = None,
    torque: str | None = None,
    law: str | None = None,
    settings: list[str] | None = None,
    speed_range: str | None = None,
    variant: str | None = None,
) -> GearPair:
    """Load a gear pair and apply the options of the command line; None: the example, which a note says.

    ``variant`` holds further changes, FIELD=VALUE, between semicolons.
    """
    from lumped import load_gear_pair
    from lumped.errors import ParameterError
    from lumped.schema.changes import fields_of
    from validation.validity.plausibility import parameter_warnings

    asked = [(f"--set {path}", path, text) for path, text in set_fields(settings).items()]
    changes = [] if variant is None else variant.split(";")
    asked += [(f"--variant {path}", path, text) for path, text in set_fields(changes, "--variant").items()]
    for name, text in (("speed", speed), ("torque", torque), ("law", law), ("range", speed_range)):
        if text is not None:
            asked.append((f"--{name}", fields_of(name)[0], text))
    once(field for _, path, _ in asked for field in fields_of(path))
    if pair is None:
        note(f"no gear pair is named, so this is the example {DEFAULT_PAIR}: name your parameter file.")
    own = load_gear_pair(pair or DEFAULT_PAIR)
    try:
        varied = own.with_({path: value_of(text) for _, path, text in asked})
    except ParameterError as error:
        options = {field: option for option, path, _ in asked for field in (path, *fields_of(path))}
        raise by_option(error, options, error.source.removesuffix(" varied")) from None
    for option, path, text in asked:
        others = {other: value_of(value) for _, other, value in asked if other != path}
        if _READ_BY_LAWS.search(fields_of(path)[0]) and not _has_effect(own, varied, others):
            given = path.endswith(".roughness") and varied.friction.composite_roughness is not None
            law = "friction.composite_roughness is given" if given else f"the law is {varied.friction.law}"
            why = f"mesh.relief is '{varied.mesh.relief}'" if "relief" in path else law
            note(f"{option} = {text} changes nothing in the motion: {why}.")
        if varied.shafts is not None and fields_of(path)[0].startswith("bearings."):
            note(f"{option} = {text} changes nothing on the shafts, which hold the gears: see --supports.")
    if varied.stiffness_note:
        note(varied.stiffness_note)
    for warning in parameter_warnings(varied):
        note(warning)
    return varied


def _has_effect(own: GearPair, varied: GearPair, others: dict[str, Any]) -> bool:
    """Whether the laws of ``varied`` are other than those of ``own`` with the ``others`` of its changes."""
    from lumped import LawRangeWarning
    from lumped.errors import ParameterError
    from lumped.quasi_static.contacts import contact_of

    def laws(of: GearPair) -> list[bytes]:
        elements = contact_of(of).elements(of)
        functions = (elements.stiffness, elements.friction, elements.error)
        return [array.tobytes() for law in functions for array in (law.breaks, law.coefficients)]

    with warnings.catch_warnings(), suppress(ParameterError):  # of the pair without it
        warnings.simplefilter("ignore", LawRangeWarning)
        without = own.with_(others)
        return without == varied or laws(without) != laws(varied)
    return True


def alike(pair: GearPair) -> GearPair:
    """The twin with like teeth, for a command that takes no teeth that differ; a note says so."""
    if pair.healthy is not pair:
        note("this command takes all teeth of a gear as alike; spurcheck teeth takes them as given.")
    return pair.healthy


class Files(NamedTuple):
    """Files that a command writes, checked before any work."""

    paths: tuple[Path, ...]
    force: bool

    def write(self, data: xr.Dataset, draw: Callable[[], Figure] | None = None) -> None:
        """Write data or its figure, as each suffix says; ``draw`` makes another figure than ``plot``."""
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
    """The options --output and --force for files of "data", "figure" or both."""
    words = {
        "data": ".nc (NetCDF), .mat (MATLAB) or .csv for data",
        "figure": ".png, .svg or .pdf for the figure",
    }
    text = f"Result file, as often as needed: {', '.join(words[kind] for kind in kinds.split())}."

    def make(output: list[Path] | None, force: bool | None) -> Files:
        from validation.files.output import DATA_SUFFIXES, FIGURE_SUFFIXES, check_file

        known = {"data": DATA_SUFFIXES, "figure": FIGURE_SUFFIXES}
        suffixes = tuple(suffix for kind in kinds.split() for suffix in known[kind])
        return Files(tuple(check_file(one, suffixes, force=bool(force)) for one in output or ()), bool(force))

    return Group({"output": Annotated[list[Path] | None, output(text)], "force": Force}, make)


ResultFiles = Annotated[Files, _files("data figure")]
DataFiles = Annotated[Files, _files("data")]
FigureFiles = Annotated[Files, _files("figure")]
_PAIR = {"pair": PairArgument, "speed": Speed, "torque": Torque, "law": Law, "settings": Settings}
_RANGED = _PAIR | {"speed_range": Range}
#: A pair with its teeth as given; the same with what it is called and a range of speeds; one with like teeth.
Pair = Annotated["GearPair", Group(_PAIR, gear_pair)]
NamedPair = Annotated[
    "tuple[str, GearPair]",
    Group(_RANGED, lambda pair, **options: (pair or DEFAULT_PAIR, gear_pair(pair, **options))),
]
AlikePair = Annotated["GearPair", Group(_RANGED, lambda **options: alike(gear_pair(**options)))]


def once(fields: Iterable[str]) -> None:
    """Refuse a field that two options set, of which only the last would count."""
    from lumped.errors import refuse

    for field, count in Counter(fields).items():
        if count > 1:
            raise refuse(field, f"set {count} times", "one value", "Leave the others out.")


def set_fields(settings: list[str] | None, option: str = "--set") -> dict[str, str]:
    """Return field path -> text of its value of every --set; ``option`` is named in a refusal."""
    from lumped.errors import refuse

    found: dict[str, str] = {}
    for item in settings or []:
        path, separator, text = item.partition("=")
        if not separator or not path.strip():
            raise refuse(option, item, "FIELD=VALUE", f"For example {option} mesh.damping_ratio=0.03.")
        once([*found, path.strip()])
        found[path.strip()] = text.strip()
    return found


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


def axis_values(
    text: str, known: Mapping[str, ChartAxis], option: str = "--axis"
) -> tuple[str, NDArray[np.float64]]:
    """Name and values of an axis written NAME=FROM:TO:COUNT; ``option`` is named in a refusal."""
    import numpy as np

    from lumped.arguments import nearest
    from lumped.errors import ParameterError, refuse

    name, separator, values = (part.strip() for part in text.partition("="))
    allowed = f"NAME=FROM:TO:COUNT with different ends and a count from 2 to {_LARGEST_COUNT}"
    example = "speed_rpm=1000:20000:80" if "speed_rpm" in known else f"{next(iter(known))}=1:2:80"
    wrong = refuse(option, text, allowed, f"For example {option} {example}.")
    *ends, many = values.split(":")
    if not separator or len(ends) != 2 or not many.strip().isdecimal():
        raise wrong
    if name not in known:
        advice = nearest(name, known) or "Choose one of them."
        raise refuse(option, name, "one of " + ", ".join(known), advice)
    low, high = sorted(number_in(option, end, known[name].units) for end in ends)
    if low == high or not 2 <= int(many) <= _LARGEST_COUNT:
        raise wrong
    found = np.linspace(low, high, int(many))
    try:
        known[name].check(name, found)
    except ParameterError as error:
        raise by_option(error, {f"axes[{name!r}]": f"{option} {name}"}, "") from None
    return name, found


def axes_values(texts: list[str] | None, known: Mapping[str, ChartAxis]) -> dict[str, NDArray[np.float64]]:
    """Axes by name, see `axis_values`; refuses a name that comes twice."""
    found = [axis_values(text, known) for text in texts or []]
    once(f"--axis {name}" for name, _ in found)
    return dict(found)


def number_in(option: str, text: str, unit: str) -> float:
    """Number in a unit, of text that may carry another one of its kind; ``option`` is named in a refusal."""
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
