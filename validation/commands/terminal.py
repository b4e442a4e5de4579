"""Output of commands: one message for an error, progress on stderr, tables on stdout."""

from __future__ import annotations

import functools
import inspect
import os
import re
import sys
import traceback
import unicodedata
import warnings
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal, NamedTuple, NoReturn

import typer
from rich.console import Console
from rich.markup import escape
from rich.table import Table
from rich.text import Text
from typer.core import TyperCommand

from validation.files.formatting import number, quantity
from validation.stop_signals import interruption_kept

if TYPE_CHECKING:
    from lumped.typing import Progress

#: Exit codes: a verdict that fails; an input that is refused; a computation or a file that fails; an
#: interruption.
FAILED = 1
REFUSED = 2
NUMERICAL = 3
INTERRUPTED = 130


#: Unicode categories of characters that control a terminal or reorder a line. The line end is allowed.
_UNSEEN = ("Cc", "Cf", "Cs")


class PlainConsole(Console):
    """Console that prints text from files as plain text, without markup and without control characters."""

    def __init__(self, **options: Any) -> None:
        super().__init__(markup=False, highlight=False, emoji=False, **options)

    def render_str(self, text: str, **options: Any) -> Text:
        """Return the text with invisible characters written as escape sequences."""
        if not text.isprintable():
            text = "".join(
                c.encode("unicode_escape").decode() if unicodedata.category(c) in _UNSEEN and c != "\n" else c
                for c in text
            )
        return super().render_str(text, **options)

    def print(self, *objects: Any, **options: Any) -> None:
        """Print text without line breaks, and tables as wide as the terminal."""
        unbroken = all(isinstance(one, str) for one in objects)
        super().print(*objects, **({"soft_wrap": unbroken} | options))


#: Message of the parser (pattern) -> message for the user.
_PARSER = (
    (r"^Input should be a valid integer.*", "Write a whole number, without point and exponent."),
    (r"^Input should be a valid number.*", "Write a number."),
    (r"^Value error, ", ""),
    (r"^(Got unexpected extra .*)", r"\1. Put a value that has blanks in quotes: '1450 rpm'."),
)
#: An entry of "Parameters" in the docstring of a command: name, placeholder of the value, help text.
_ENTRY = re.compile(r"^(\w+)(?: (\S+))? : (.*(?:\n +.*)*)", re.MULTILINE)
_quiet: ContextVar[bool] = ContextVar("quiet", default=False)
#: Option that every command has, see ``guarded``.
_QUIET = typer.Option("--quiet", "-q", help="Print errors only: no tables, notes or progress.")


def stdout() -> Console:
    """Return the console for results. A new console follows a replaced standard stream."""
    return PlainConsole(quiet=_quiet.get())


def stderr() -> Console:
    """Return the console for notes, progress and errors."""
    return PlainConsole(stderr=True, quiet=_quiet.get())


def print_json(data: Mapping[str, Any]) -> None:
    """Print numbers and records as JSON on stdout. A number that is not finite becomes null."""
    from pydantic_core import to_json

    typer.echo(to_json(data, indent=1, inf_nan_mode="null"))


class Once(TyperCommand):
    """Command that refuses an option given twice, if only the last value would count."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """Check for options given twice, then parse the line. Errors are reworded in plain language."""
        try:
            _, _, order = self.make_parser(ctx).parse_args(args=list(args))
            for parameter, count in Counter(order).items():
                if count > 1 and not (getattr(parameter, "is_flag", True) or parameter.multiple):
                    name = max(parameter.opts, key=len)
                    ctx.fail(f"{name} is given {count} times and takes one value: leave the others out.")
            return super().parse_args(ctx, args)
        except Exception as error:
            usage: Any = error  # an error of usage has its text as an attribute
            if type(error).__name__ == "NoSuchOption":
                from validation.commands.hints import about_option

                ctx.fail(f"No such option: {usage.option_name}.{about_option(usage.option_name, ctx)}")
            for pattern, words in _PARSER if hasattr(error, "message") else ():
                usage.message = re.sub(pattern, words, usage.message)
            raise


class Group(NamedTuple):
    """Mark of a parameter that several options make. ``guarded`` replaces the parameter by the options.

    Attributes
    ----------
    options : name of the option -> type; the default of every option is None
    make : function that makes the value of the parameter from the values of the options
    """

    options: Mapping[str, Any]
    make: Callable[..., Any]


class Early(NamedTuple):
    """Mark of a parameter whose value is checked before any file is read.

    Attributes
    ----------
    check : function of the value; it raises ParameterError
    """

    check: Callable[[Any], None]


def _by_options(action: str, options: Mapping[str, str]) -> str:
    """Rewrite each function argument NAME="VALUE" in an advice as the option that sets this argument."""

    def option(match: re.Match[str]) -> str:
        name, value = match.groups()
        return f"{options[name]} {value}" if name in options else match[0]

    return re.sub(r'\b(\w+)="(\w+)"', option, action)


def guarded(command: Callable[..., None]) -> Callable[..., None]:
    """Turn errors into one message and an exit code, and warnings into notes. Add the option --quiet.

    The options of a ``Group`` replace the parameter that carries this mark. The section "Parameters" of the
    docstring has the help of all other parameters. A parameter without a default is an argument; a parameter
    with a default is an option.
    """
    text, _, entries = inspect.cleandoc(command.__doc__ or "").partition("\nParameters\n----------\n")
    helps = {
        name: (metavar or None, " ".join(words.split())) for name, metavar, words in _ENTRY.findall(entries)
    }
    annotated: Any = Annotated
    groups: dict[str, Group] = {}
    checks: list[tuple[str, Callable[[Any], None]]] = []
    #: Argument of a function of the packages -> option that sets this argument.
    options = {
        "samples_per_cycle": "--samples",
        "samples": "--samples",
        "seconds": "--seconds",
        "output": "--output",
        "supports": "--supports",
        "axes": "--axis",
        "cluster": "--cluster",
        "wait_seconds": "--wait-seconds",
    }
    keyword = functools.partial(inspect.Parameter, kind=inspect.Parameter.KEYWORD_ONLY)
    shown: list[inspect.Parameter] = []
    for one in inspect.signature(command, eval_str=True).parameters.values():
        kind = one.annotation
        if one.name in helps:
            metavar, words = helps[one.name]
            info = typer.Argument(metavar=metavar, help=words)
            if one.default is not one.empty:
                options[one.name] = f"--{one.name.strip('_').replace('_', '-')}"
                info = typer.Option(options[one.name], metavar=metavar, help=words)
            kind = annotated[kind, info]
        marks = getattr(kind, "__metadata__", ())
        checks += [(one.name, mark.check) for mark in marks if isinstance(mark, Early)]
        group = next((mark for mark in marks if isinstance(mark, Group)), None)
        if group is not None:
            groups[one.name] = group
            shown += [keyword(name, default=None, annotation=kind) for name, kind in group.options.items()]
        else:
            shown.append(keyword(one.name, default=one.default, annotation=kind))
    shown.append(keyword("quiet", default=False, annotation=annotated[bool, _QUIET]))

    @functools.wraps(command)
    def run(**kwargs: Any) -> None:
        from lumped.display.progress import without_bars
        from lumped.errors import LawRangeWarning, ParameterError, SpurcheckError, typed_errors

        silent = _quiet.set(bool(kwargs.pop("quiet", False)))
        noted_subjects: set[str] = set()

        def show(message: Warning | str, *_: object, **__: object) -> None:
            text = str(message)
            subject = getattr(message, "subject", text)  # a law outside its range at every speed of a sweep
            if subject not in noted_subjects:
                noted_subjects.add(subject)
                note(text)

        try:
            # A command draws its bar itself.
            with interruption_kept(typer.Exit, typer.Abort), warnings.catch_warnings(), without_bars():
                warnings.simplefilter("always", LawRangeWarning)
                warnings.showwarning = show
                for name, check in checks:
                    check(kwargs[name])
                made = {
                    name: group.make(**{option: kwargs.pop(option) for option in group.options})
                    for name, group in groups.items()
                }
                with typed_errors():
                    command(**made, **kwargs)
        except ParameterError as error:
            problems = [
                replace(p, field=options.get(p.field, p.field), action=_by_options(p.action, options))
                for p in error.problems
            ]
            fail(str(ParameterError(problems, error.source)), REFUSED)
        except SpurcheckError as error:
            fail(str(error), NUMERICAL)
        except OSError as error:
            from validation.files.output import WORKING_FOLDER_DELETED, working_folder_deleted

            if working_folder_deleted():
                fail(WORKING_FOLDER_DELETED, REFUSED)
            if error.filename:
                fail(f"{error.filename}: {error.strerror or type(error).__name__}", REFUSED)
            fail(unprinted(error), NUMERICAL)
        except KeyboardInterrupt:
            fail("interrupted", INTERRUPTED)
        except MemoryError:
            fail("not enough memory: ask for fewer points, samples or cycles", NUMERICAL)
        except (typer.Exit, typer.Abort):
            raise
        except Exception as error:  # noqa: BLE001
            # Python's own exit code for a fault is 1. Here 1 means a verdict that fails.
            place = traceback.extract_tb(error.__traceback__)[-1]
            file_and_line = f"{Path(place.filename).name}:{place.lineno}"
            fail(
                f"a fault in spurcheck: {type(error).__name__} at {file_and_line}: {error}. "
                "Please report it.",
                NUMERICAL,
            )
        finally:
            _quiet.reset(silent)

    run.__doc__ = text
    run.__signature__ = inspect.Signature(shown)  # type: ignore[attr-defined]
    run.__annotations__ = {one.name: one.annotation for one in shown}
    return run


def fail(text: str, code: int) -> NoReturn:
    """End the command with one message and an exit code."""
    PlainConsole(stderr=True).print(f"[bold red]error:[/bold red] {escape(text)}", markup=True)
    raise typer.Exit(code)


def unprinted(error: OSError) -> str:
    """Return the message for a standard stream that is closed, and redirect the stream to the null device."""
    for stream, descriptor in ((sys.stdout, 1), (sys.stderr, 2)):
        try:
            stream.flush()
        except OSError:  # the text left in the buffer would fail again and change the exit code
            os.dup2(os.open(os.devnull, os.O_WRONLY), descriptor)
    return f"the result cannot be printed: {error.strerror or type(error).__name__}"


def note(text: str) -> None:
    """Print a remark on stderr, apart from the result."""
    stderr().print(f"[yellow]note:[/yellow] {escape(text)}", markup=True)


@contextmanager
def progress_bar(text: str, *, moving: bool = True) -> Iterator[Progress]:
    """Show a progress bar on stderr while the block runs. Without a terminal nothing is drawn.

    A bar that is not ``moving`` stands still, and has no thread.
    """
    from lumped.display.terminal_bar import bar_of_stages

    with bar_of_stages(stderr(), moving=moving) as bar:
        task = bar.add_task(text, total=1.0)

        def tell(fraction: float, stage: str = "", /) -> None:
            bar.update(task, completed=fraction, description=stage or text)

        yield tell


def show(title: str, columns: str, rows: Iterable[Sequence[Any]]) -> None:
    """Print a table on stdout.

    ``columns``: headings, separated by " | ". A heading that starts with ">" marks a right-aligned column.
    ``rows``: cells; a cell is a text, a number, or a number and a unit: (value, "m").
    """
    made = Table(title=title or None, title_justify="left", title_style="bold")
    for column in columns.split(" | "):
        right = column.startswith(">")
        side: Literal["right", "left"] = "right" if right else "left"
        made.add_column(column.removeprefix(">"), justify=side, no_wrap=right, overflow="fold")
    for row in rows:
        made.add_row(*map(_cell, row))
    stdout().print(made)


def _cell(value: Any) -> Any:
    if isinstance(value, tuple):
        size, unit = value
        return quantity(size, unit, 3)
    return value if isinstance(value, str | Text) else number(value)
