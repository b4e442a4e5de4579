"""The command ``spurcheck``."""

from __future__ import annotations

import gc
import inspect
import io
import os
import sys
from contextlib import suppress
from importlib import metadata
from typing import Annotated, Any

import typer
from typer.core import TyperGroup

from validation.commands.any_system import floquet
from validation.commands.calibrate import calibrate
from validation.commands.check import check
from validation.commands.compare import compare
from validation.commands.files import export, init, presets
from validation.commands.hints import COMMANDS as COMMAND_HINTS
from validation.commands.motion import interactive, simulate, teeth, uncertainty
from validation.commands.reference import reference
from validation.commands.report import crosscheck, report
from validation.commands.response import response
from validation.commands.stability import stability
from validation.commands.sweep import sweep
from validation.commands.terminal import NUMERICAL, Once, unprinted
from validation.stop_signals import ended_at_once, interrupt_once

#: Fewer columns in the variable COLUMNS are a mistake of the terminal.
_FEWEST_COLUMNS = 20


class Commands(TyperGroup):
    """Group of all commands. An unknown command or option is refused with the command to type instead."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """Parse a line, its command and options included."""
        if "-help" in args:  # the parser would read -h -e -l -p
            ctx.fail("No such option: -help. Type: --help")
        return super().parse_args(ctx, args)

    def resolve_command(self, ctx: Any, args: list[str]) -> Any:
        """Return the command of a line."""
        line = f"spurcheck report {args[0]}" if args[0].endswith(".toml") else COMMAND_HINTS.get(args[0])
        return (
            ctx.fail(f"No such command '{args[0]}'. Type: {line}")
            if line
            else super().resolve_command(ctx, args)
        )


app = typer.Typer(
    name="spurcheck",
    cls=Commands,
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    rich_markup_mode="rich",
    context_settings={"help_option_names": ["-h", "--help"]},
)


def _version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"spurcheck {metadata.version('spurcheck')}")
        raise typer.Exit


def spurcheck(
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Show the version and exit.")
    ] = False,
) -> None:
    """Trustworthy dynamics of spur gear pairs with sliding friction.

    A lumped model predicts the vibration of a gear pair, an independent multibody model checks it, and
    Floquet theory decides whether it is stable. Start with [bold]spurcheck report -o report[/bold], or write
    a parameter file for your own pair with [bold]spurcheck init[/bold].

    Speeds are pinion speeds in rpm, torques pinion torques in N m; other units may be written out ("200
    lbf*in").

    Exit codes: 0 done, 1 a check of the program fails, 2 an input is refused, 3 a computation or the writing
    of its result fails, 4 the models differ, or a finding that --require forbids, 130 stopped by a signal.
    """


def paragraphs(text: str | None) -> str:
    """Return a docstring as help text. Lines of a paragraph are joined; the terminal wraps paragraphs.

    A line that begins with the name of the program is an example and becomes a paragraph.
    """
    blocks = inspect.cleandoc(text or "").replace("\nspurcheck ", "\n\nspurcheck ").split("\n\n")
    return "\n\n".join(" ".join(block.split()) for block in blocks)


COMMANDS = (
    *(report, presets, init, simulate, export, crosscheck, uncertainty, compare, calibrate, check, stability),
    *(floquet, response, teeth, interactive, sweep, reference),
)
for command in COMMANDS:
    app.command(cls=Once, help=paragraphs(command.__doc__))(command)
app.callback(help=paragraphs(spurcheck.__doc__))(spurcheck)


def _open_streams() -> None:
    """Open closed standard streams. Otherwise the next file that is opened would take a number of 0 to 2."""
    for number in range(3):
        try:
            os.fstat(number)
        except OSError:
            os.open(os.devnull, os.O_RDWR)  # takes the lowest number
    sys.stdout = sys.stdout or os.fdopen(1, "w", closefd=False)
    sys.stderr = sys.stderr or os.fdopen(2, "w", closefd=False)
    for stream in (sys.stdout, sys.stderr):  # a terminal whose encoding has no box-drawing characters
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="replace")


def _forget_narrow_terminal() -> None:
    """Remove a width in COLUMNS on which nothing can be read. With 0 columns every table would be empty."""
    columns = os.environ.get("COLUMNS", "")
    if columns.lstrip("-").isdigit() and int(columns) < _FEWEST_COLUMNS:
        del os.environ["COLUMNS"]


def _hide_dask() -> None:
    """Let xarray find no dask in this process.

    With the extra ``cluster`` xarray would import dask, to see whether an array is one of dask. None is.
    """
    if "xarray" in sys.modules:
        return  # it has found dask
    modules: dict[str, Any] = sys.modules
    modules["dask"] = None  # its import raises ImportError


def main() -> None:
    """Entry point of the installed command."""
    # Must be set before numpy is imported. The matrices are small: BLAS threads only wait for each other.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    # Results live until the end. The default garbage collection would take 5 % of the time of a report.
    # The compiler leaves 2 million objects in a first report. To collect them would take 5 % of its time
    # and save 250 MB.
    gc.set_threshold(5_000_000)
    _open_streams()
    _forget_narrow_terminal()
    if sys.argv[1:2] == ["report"]:
        _hide_dask()
    interrupt_once()  # to the end of the process: an impatient Ctrl-C prints no traceback
    try:
        with ended_at_once():
            app(prog_name="spurcheck")
    except OSError as error:  # of --help and --version, and where stderr takes no message either
        with suppress(OSError):
            print(f"error: {unprinted(error)}", file=sys.stderr)
        sys.exit(NUMERICAL)
    finally:
        gc.freeze()  # prevents one more garbage collection of all results at the end


if __name__ == "__main__":
    main()
