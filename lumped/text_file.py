"""Reading files that somebody else wrote: ordinary files only, and not more than a bound."""

from __future__ import annotations

import os
import re
import stat
import tomllib
from pathlib import Path
from typing import Any

from lumped.errors import refuse, shown

#: Most parts of a dotted key. No schema nests half as deep, and reading a key takes the square of its parts.
_MAX_PARTS = 50


def parse_toml(text: str) -> dict[str, Any]:
    """Return the content of TOML text, in a time that grows no faster than the text.

    Raises
    ------
    ValueError : malformed, or a dotted key of more than 50 parts
    RecursionError : nested too deeply
    """
    parts = 0
    for found in re.finditer(r"^[ \t]*#.*|[.,=\[\]{}\n]", text, re.MULTILINE):
        parts = parts + 1 if found[0] == "." else 0
        if parts > _MAX_PARTS:
            raise ValueError(f"more than {_MAX_PARTS} dots in a row (at character {found.start()})")
    return tomllib.loads(text)


def read_text(path: str | Path, limit: int, encoding: str = "utf-8-sig") -> str:
    """Return the text of an ordinary file (or of one that a link leads to).

    A pipe would block for ever and a device never ends, so both are refused before anything is read.

    Parameters
    ----------
    path : file
    limit : largest size [bytes]
    encoding : of the text; the default is UTF-8 with or without the mark that Windows puts in front

    Raises
    ------
    ParameterError : not an ordinary file, or larger than the limit
    OSError : it does not exist or cannot be opened
    ValueError : the name or the text is not what the encoding allows
    """
    flags = os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0)
    descriptor = os.open(path, flags)
    try:
        if not stat.S_ISREG(os.fstat(descriptor).st_mode):
            raise refuse(
                "file", shown(str(path)), "a readable ordinary file", "Name a file, no folder or device."
            )
        data = b""
        while len(data) <= limit and (block := os.read(descriptor, limit + 1 - len(data))):
            data += block
    finally:
        os.close(descriptor)
    if len(data) > limit:
        raise refuse("file", shown(str(path)), f"<= {limit} bytes", "Is this the right file?")
    return data.decode(encoding)
