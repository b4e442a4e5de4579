"""Flags of numba that are compared quickly, and by what acts on numba's own functions.

A compiled function calls functions of numba's library, such as ``max`` and ``np.empty``. numba compiles each
of them for every set of flags of the callers, though only some flags are handed on to them. For every
operation that it compiles numba looks these functions up by flags, and compares flags by 25 properties: a
tenth of the time of a compilation. The flags here are equal if those that are handed on are equal, and are
compared as dictionaries.
"""

from __future__ import annotations

from typing import Any

from numba.core.compiler import Flags

#: Flags of a function that act on this function alone: ``inherit_if_not_set`` in numba hands on others.
_NOT_HANDED_ON = ("release_gil", "no_cpython_wrapper", "no_cfunc_wrapper")
#: With a numba that lacks one of these, functions are compiled with plain flags.
_ARE_KNOWN = all(name in getattr(Flags, "options", ()) for name in _NOT_HANDED_ON)
#: Values of the flags that are not set, and the hash, which numba takes of the names alone.
_DEFAULTS = {name: option.default for name, option in getattr(Flags, "options", {}).items()}
_HASH = hash(Flags())


class SharingFlags(Flags):  # type: ignore[misc]  # numba ships no types
    """Flags of a compiled function under which functions of numba's library are shared."""

    __slots__ = ()

    def values(self) -> dict[str, Any]:
        """Return the values of all flags."""
        return {**_DEFAULTS, **self._values}

    def __hash__(self) -> int:
        return _HASH

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Flags):
            return NotImplemented
        return _handed_on(self) == _handed_on(other)


def _handed_on(flags: Any) -> dict[str, Any]:
    values: dict[str, Any] = flags.values()
    for name in _NOT_HANDED_ON:
        del values[name]
    return values


def share_library_functions(dispatcher: Any) -> None:
    """Compile a function with flags under which functions of numba's library are shared."""
    if _ARE_KNOWN and hasattr(dispatcher._compiler, "_customize_flags"):
        dispatcher._compiler._customize_flags = SharingFlags
