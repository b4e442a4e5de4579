"""Reading files that somebody else wrote: ordinary files only, and not more than a bound."""

from __future__ import annotations

import codecs
import os
import re
import stat
import tomllib
from pathlib import Path
from typing import Any

from lumped.errors import ParameterError, refuse, shown

#: Most parts of a dotted key. No schema nests half as deep, and reading a key takes the square of its parts.
_MAX_PARTS = 50


def parse_toml(text: str, source: str) -> dict[str, Any]:
    """Return the content of TOML text, in a time that grows no faster than the text; ``source`` names it.

    Refused: malformed, nested too deeply, or a dotted key of more than 50 parts.
    """
    try:
        parts = 0
        for sign in re.finditer(r"^[ \t]*#.*|[.,=\[\]{}\n]", text, re.MULTILINE):
            parts = parts + 1 if sign[0] == "." else 0
            if parts > _MAX_PARTS:
                raise ValueError(f"more than {_MAX_PARTS} dots in a row (at character {sign.start()})")
        return tomllib.loads(text)
    except (RecursionError, ValueError) as error:
        why = f"The TOML is malformed: {error}."
        if found_at := re.search(r"at line (\d+)", str(error)):
            line = text.splitlines()[int(found_at[1]) - 1].strip()
            hint = ""
            if re.search(r"=\s*[+-]?\d+,\d", line):
                hint = " Decimals have a point, and text is put in quotes."
            elif unit := re.search(r"=\s*([-+.\d][-+.\deE_]*\s*[A-Za-z][^#]*)", line):
                hint = f" A number with a unit is text, in quotes: '{unit[1].strip()}'."
            why = f"Line {found_at[1]} is malformed: {shown(line)} ({error}).{hint}"
        raise refuse("file", source, "well-formed TOML", why) from None


def read_text(
    path: str | Path, limit: int, *, field: str = "file", kind: str = "text file", **words: str
) -> str:
    """Return the text of an ordinary file in UTF-8, with or without a byte order mark; see ``read_bytes``.

    A CSV file may also be in UTF-16 with a mark: spreadsheets and measuring machines write such files.
    """
    data = read_bytes(path, limit, field=field, kind=kind, **words)
    is_utf_16 = kind == "CSV file" and data.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE))
    try:
        return data.decode("utf-16" if is_utf_16 else "utf-8-sig")
    except UnicodeDecodeError as error:
        why = f"It cannot be read: byte {error.start} is no {error.encoding.upper()}. Save it as UTF-8 text."
        raise refuse(field, Path(path), f"a {kind} in UTF-8", why) from None


def read_bytes(
    path: str | Path,
    limit: int,
    *,
    field: str = "file",
    kind: str = "file",
    instead: str = "",
    action: str = "Check the path.",
) -> bytes:
    """Return the bytes of an ordinary file, also through a link. Any other file is refused.

    A pipe would block for ever, and a device never ends. Both are refused before the first byte is read.
    ``field`` named the file, ``kind`` is wanted, ``instead`` (", or ...") could have been named; ``action``
    is what to do where it does not exist.
    """
    try:
        flags = os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0)
        descriptor = os.open(path, flags)
        try:
            if not stat.S_ISREG(os.fstat(descriptor).st_mode):
                action = "This is a folder or a device: name an ordinary file."
                raise refuse(field, Path(path), f"a readable {kind}", action)
            data = b""
            while len(data) <= limit and (block := os.read(descriptor, limit + 1 - len(data))):
                data += block
        finally:
            os.close(descriptor)
    except FileNotFoundError:
        raise refuse(field, Path(path), f"a {kind} that exists{instead}", action) from None
    except OSError as error:
        why = f"It cannot be read: {error.strerror or error}."
        raise refuse(field, Path(path), f"a readable {kind}", why) from None
    except ParameterError:
        raise
    except ValueError as error:  # such as a NUL in the name
        raise refuse(field, str(path), f"a readable {kind}", f"It cannot be read: {error}.") from None
    if len(data) > limit:
        raise refuse(field, Path(path), f"<= {limit} bytes", "Is this the right file?")
    return data
