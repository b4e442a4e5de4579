"""Exceptions of spurcheck: what a caller can catch, each mapped to a builtin."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import numpy as np


@dataclass(frozen=True)
class FieldProblem:
    """One refused input.

    Attributes
    ----------
    field : dotted path of the field, e.g. ``"pinion.face_width"``
    value : the refused value, as text with its unit
    allowed : the allowed range or set, as text with its unit
    action : what to do next
    """

    field: str
    value: str
    allowed: str
    action: str

    def __str__(self) -> str:
        return f"{self.field} = {self.value}: allowed {self.allowed}. {self.action}"


#: Most problems that one refusal lists.
MOST_PROBLEMS = 50
_SHOWN_CHARACTERS = 60
#: Longest text of a value in a refusal; a path has to fit.
_MOST_CHARACTERS = 500


def quoted(value: object) -> str:
    """Return a value as Python code would write it, also a value that is nested too deeply for ``repr``."""
    try:
        return repr(value.item() if isinstance(value, np.generic) else value)
    except RecursionError:
        return "a value that is nested too deeply"
    except ValueError:  # Python writes no longer integers in decimals
        return "a number of thousands of digits"


def shown(value: object, most: int = _SHOWN_CHARACTERS) -> str:
    """Return the text of a refused value, cut to a length that fits into a message."""
    text = value if isinstance(value, str) else quoted(value)
    cut = f"... ({len(text)} characters)" if len(text) > most else ""
    # Line ends, control characters and halves of surrogate pairs as code writes them.
    seen = (c if c.isprintable() else c.encode("unicode_escape").decode() for c in text[:most])
    return "".join(seen) + cut


class SpurcheckError(Exception):
    """Base of every error that spurcheck raises on purpose."""


class ParameterError(SpurcheckError, ValueError):
    """Input refused before any work started; lists every problem found.

    Parameters
    ----------
    problems : the refused inputs
    source : origin of the inputs (a file name, a preset, "mapping")
    """

    def __init__(self, problems: list[FieldProblem], source: str = "") -> None:
        self.problems = tuple(problems)
        self.source = source
        head = f"{source}: " if source else ""
        if len(problems) == 1:
            text = f"{head}{problems[0]}"
        else:
            lines = "\n".join(f"  - {p}" for p in problems)
            text = f"{head}{len(problems)} problems\n{lines}"
        super().__init__(text)

    def __reduce__(self) -> tuple[type[ParameterError], tuple[list[FieldProblem], str]]:
        """Pickle by the arguments, not by the text: worker processes send errors back."""
        return type(self), (list(self.problems), self.source)


def refuse(field: str, value: object, allowed: str, action: str) -> ParameterError:
    """Build the ``ParameterError`` for one refused input (the caller raises it)."""
    text = shown(str(value) if isinstance(value, Path) else value, _MOST_CHARACTERS)
    return ParameterError([FieldProblem(field, text, allowed, action)])


class NumericalError(SpurcheckError, ArithmeticError):
    """A computation did not reach its accuracy or met a non-finite number; the text says what to try."""


class BeyondFlanksError(NumericalError):
    """Teeth bend so far under the torque that pairs touch far beyond their flanks, where no model applies."""


class SlowPairError(NumericalError):
    """A mesh cycle lasts more vibrations than a run can follow: the pair moves as if it stood still."""


class UnsettledError(NumericalError):
    """No run with unilateral contact comes to a periodic motion: the pair beats, is chaotic, or grows."""


class StorageError(SpurcheckError, OSError):
    """A result cannot be written; the text names the path, the reason and what to do."""

    @classmethod
    def of(cls, path: Path, error: OSError) -> StorageError:
        """Return the error for a file or folder that cannot be written."""
        reason = error.strerror or str(error) or type(error).__name__
        return cls(f"{path}: cannot be written: {reason}. Free space or choose another place.")


#: Modules that read files. An error that begins in one of them is about the content of a file.
_READERS = ("h5py", "h5netcdf", "netCDF4", "json", "tomllib", "zipfile", "zlib", "openpyxl", "scipy.io")


@contextmanager
def typed_errors() -> Iterator[None]:
    """Raise errors of libraries as typed errors. Every public function of ``spurcheck`` runs inside.

    - An error of linear algebra or of arithmetic becomes a ``NumericalError``.
    - A file that cannot be opened, and an error that begins in a reader of files, become a
      ``ParameterError`` of the field "file".

    Any other error is a fault of the program, or of a function of the user, and passes.
    """
    try:
        yield
    except (SpurcheckError, MemoryError, RecursionError):
        raise
    except (np.linalg.LinAlgError, ArithmeticError) as error:
        raise NumericalError(
            f"The computation failed: {error or type(error).__name__}. A value of the pair may be far from "
            "usual: look at the notes of spurcheck.validity_flags, and at the units of stiffness and mass."
        ) from error
    except Exception as error:
        if isinstance(error, OSError) and error.filename is not None:
            reason = error.strerror or type(error).__name__
            raise refuse("file", str(error.filename), "a file that can be read", f"{reason}.") from error
        if (reader := _reader(error)) is not None:
            action = f"It is damaged, or of another kind: save it again. ({reader}: {shown(str(error), 120)})"
            raise refuse("file", "its content", "a file that is complete", action) from error
        raise


def _reader(error: Exception) -> str | None:
    """The module of ``_READERS`` in which an error begins; None: the error begins elsewhere."""
    place = error.__traceback__
    module = ""
    while place is not None:
        module = str(place.tb_frame.f_globals.get("__name__", ""))
        place = place.tb_next
    return next((name for name in _READERS if f"{module}.".startswith(f"{name}.")), None)


class LawRangeWarning(UserWarning):
    """A friction or film law was evaluated outside its range of validity.

    Attributes
    ----------
    subject : the law and the quantity, without the value
    largest : largest friction coefficient outside the range
    """

    def __init__(self, text: str, subject: str = "", largest: float = 0.0) -> None:
        super().__init__(text)
        self.subject = subject
        self.largest = largest


class LikeTeethWarning(UserWarning):
    """A function for like teeth got a pair whose teeth differ. The result is that of like teeth."""


class ResolutionWarning(UserWarning):
    """A function that is sampled has features that are narrower than the first samples."""


class OldFormatWarning(UserWarning):
    """The text of a parameter file has another meaning in its older format than in the present format."""
