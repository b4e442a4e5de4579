"""What to type in place of an option or a command that does not exist.

One table for options of the program, below, and one for parameters of the pair, ``lumped.fields.hints``. Add
a row where users type a word that nothing has.
"""

from __future__ import annotations

import difflib
from typing import Any

#: Option that users type -> options that it may mean. The first one that the command has counts.
_ALIASES: dict[str, tuple[str, ...]] = {
    **dict.fromkeys(("--out", "--dir", "--folder", "--file", "--save", "--to", "--export"), ("--output",)),
    **dict.fromkeys(("--overwrite", "--replace", "-f", "--yes", "-y"), ("--force",)),
    **dict.fromkeys(("--rpm", "-n", "--pinion-speed"), ("--speed",)),
    "--speeds": ("--range", "--speed"),
    **dict.fromkeys(("--load", "--moment", "--pinion-torque"), ("--torque",)),
    **dict.fromkeys(("--friction", "--friction-law"), ("--law",)),
    **dict.fromkeys(("--axes", "--over"), ("--axis",)),
    **dict.fromkeys(("--jobs", "--threads", "--cores", "--processes", "-j"), ("--workers",)),
    **dict.fromkeys(("--scheduler", "--dask", "--client"), ("--cluster",)),
    **dict.fromkeys(("--n", "--number", "--count", "--points"), ("--samples",)),
    **dict.fromkeys(("--random-seed", "--rng"), ("--seed",)),
    **dict.fromkeys(("--silent", "--no-progress"), ("--quiet",)),
    **dict.fromkeys(("--width", "--facewidth", "-b"), ("--face-width",)),
}
#: Option that names a kind of file -> suffix. It means --output where the command writes such a file.
_SUFFIXES = {
    **{f"--{suffix}": f".{suffix}" for suffix in ("csv", "nc", "mat", "png", "svg", "pdf", "rexs", "npz")},
    **dict.fromkeys(("--plot", "--figure", "--picture"), ".png"),
    "--netcdf": ".nc",
    "--matlab": ".mat",
}
#: What to do instead of an option that users expect. The tables above count first.
_SENTENCES = {
    "--pair": "Type: the gear pair without an option, as in spurcheck report my_pair.toml",
    **dict.fromkeys(
        ("--format", "--pdf", "--html", "--print"),
        "Type: spurcheck report PAIR -o report, then print report/index.html from the browser, which has a "
        "layout for paper and PDF. A figure as PDF: spurcheck simulate PAIR --steady -o motion.pdf",
    ),
    **dict.fromkeys(
        ("--plot", "--figure", "--picture", "--png", "--svg"),
        "Type: spurcheck simulate PAIR --steady -o motion.png; a report has its figures in it",
    ),
    **dict.fromkeys(
        ("--csv", "--nc", "--mat", "--netcdf", "--matlab"),
        "Type: spurcheck simulate PAIR --steady -o motion.csv; a report has its numbers in report.json",
    ),
    **dict.fromkeys(
        ("--time", "--duration", "--tend", "--t-end", "--end"),
        "Type: --cycles N, mesh cycles of spurcheck simulate; one cycle lasts 60/(rpm x pinion teeth) s",
    ),
    **dict.fromkeys(
        ("--scheduler", "--dask", "--client"),
        "Type: --workers N on this machine; a cluster in Python: run_sweep(study, folder, executor=...)",
    ),
    **dict.fromkeys(
        ("--verbose", "-v", "--debug", "--log"), "Notes and progress are shown without it, unless --quiet"
    ),
    **dict.fromkeys(
        ("--centre-distance", "--center-distance", "--axis-distance"), "Type: --set centre_distance=80 (mm)"
    ),
    **dict.fromkeys(
        ("--helix", "--helix-angle", "--beta"), "Gears are spur gears: a helix angle is not modelled"
    ),
    **dict.fromkeys(
        ("--class", "--tolerance-class", "--iso-1328"), "Type: --set gears.deviations.tolerance_class=6"
    ),
    **dict.fromkeys(("--language", "--lang", "--locale"), "Reports are in English"),
    **dict.fromkeys(
        ("--dt", "--steps", "--step", "--timestep", "--rtol", "--method", "--solver", "--integrator"),
        "Steps follow from the accuracy; --samples N sets the output times per mesh cycle of "
        "spurcheck simulate",
    ),
}
#: What to type instead of a word that is no command.
COMMANDS = {
    "help": "spurcheck --help",
    "version": "spurcheck --version",
    "measurement": "spurcheck report PAIR --record FILE",
    "jumps": "spurcheck response",
    "gui": "spurcheck interactive",
    **dict.fromkeys(("new", "create"), "spurcheck init"),
    **dict.fromkeys(("run", "figures", "efficiency", "analyse", "analyze"), "spurcheck report"),
    **dict.fromkeys(("verify", "validate"), "spurcheck check"),
    **dict.fromkeys(("list", "ls", "examples", "pairs"), "spurcheck presets"),
    "predict": "spurcheck report PAIR; in Python: spurcheck.predict(pair)",
    "plot": "spurcheck simulate PAIR --steady -o motion.png; in Python: spurcheck.plot(result)",
    "convert": "spurcheck init --from-rexs FILE, or spurcheck export PAIR -o FILE",
    "import": "spurcheck init --from-rexs FILE",
    **dict.fromkeys(("fit", "identify", "identification"), "spurcheck calibrate PAIR RECORD"),
    "spectrum": "spurcheck teeth PAIR; in Python: spurcheck.order_spectrum(motion)",
    "campbell": "spurcheck stability PAIR; in Python: spurcheck.campbell(pair)",
}
#: Likeness from which an option may be a slip of the fingers.
_LIKE = 0.75


def about_option(name: str, context: Any) -> str:
    """Return what to type in place of an option that a command does not have, as the end of a message.

    Parameters
    ----------
    name : the option, with its dashes
    context : context of the parser for the command
    """
    options = {one: option for option in context.command.params for one in option.opts if one[0] == "-"}
    for alias in _ALIASES.get(name, ()):
        if alias in options:
            return f" Type: {alias}. {_meaning(options[alias])}"
    output = options.get("--output")
    if output is not None and name in _SUFFIXES and _SUFFIXES[name] in (output.help or ""):
        return f" Type: --output NAME{_SUFFIXES[name]}"
    if name == "--format" and any(suffix in (output.help if output else "") for suffix in (".nc", ".mat")):
        return f" The ending of --output chooses the format: {_meaning(output)}"
    if name in _SENTENCES:
        return f" {_SENTENCES[name]}"
    word = name.lstrip("-").replace("-", "_")
    setting = _setting(word) if "--set" in options else ""
    if setting:
        return f" Type: {setting}"
    if close := difflib.get_close_matches(name, options, n=3, cutoff=_LIKE):
        return f" Did you mean {' or '.join(close)}?"
    if owners := _owners(name, context):
        return f" It is an option of {' and '.join(f'spurcheck {one}' for one in owners)}."
    if "--set" in options and (fields := _fields(word)):
        return f" Type: {' or '.join(f'--set {field}=VALUE' for field in fields[:3])}"
    return f" See {context.command_path} --help."


def _meaning(option: Any) -> str:
    """The first sentence of the help of an option."""
    return str(option.help or "").partition(". ")[0].rstrip(".")


def _setting(word: str) -> str:
    """The option --set for a word that names a parameter of the pair; empty: the word names none."""
    from lumped.fields.hints import hint_of
    from lumped.schema.changes import SHORT_NAMES
    from lumped.schema.pair import stated_unit

    if hint := hint_of(word):
        return f"{hint.settings}. {hint.sentence}"
    if word not in SHORT_NAMES:
        return ""
    unit = stated_unit(SHORT_NAMES[word][0])
    return f"--set {word}=VALUE" + (f" ({unit})" if unit not in (None, "1") else "")


def _fields(word: str) -> list[str]:
    """Fields of a file whose name contains a word."""
    from lumped.fields.refusals import fields_named
    from lumped.schema.pair import GearPair

    return fields_named(GearPair, word)


def _owners(name: str, context: Any) -> list[str]:
    """Names of the other commands that have an option."""
    commands = getattr(getattr(context.parent, "command", None), "commands", {})
    return [one for one, other in commands.items() if any(name in option.opts for option in other.params)]
