"""The stamp of a compiled function: a hash of everything on which its machine code depends.

When numba compiles a function it freezes what the function's global names stand for into the code. The stamp
is taken then, of the same objects: bytecode, defaults and closure of the function, the numbers, arrays and
records that it names, and the same of every compiled function that it names, through any number of files. So
an edit counts where it acts, also one of a number that another file computes. A comment, or another function
of the same file, does not count. A hash of files would not know which edit acts, whether a module was loaded
again, nor whether the file is still the text that was imported.

Two kinds of globals cannot be taken apart so: functions that write machine instructions (intrinsics), and
objects of kinds that are not named here. They count with the text of their file and of all files that it
imports, directly or not.
"""

from __future__ import annotations

import ast
import hashlib
import importlib.util
import sys
import time
from collections.abc import Iterator
from enum import Enum
from functools import cache
from pathlib import Path
from types import CodeType, FunctionType, ModuleType
from typing import Any

import llvmlite  # type: ignore[import-untyped]
import numba
import numpy as np
from numba.core.dispatcher import Dispatcher

#: Of these the version counts, not the content.
_LIBRARIES = sys.stdlib_module_names | {"numpy", "numba", "llvmlite"}
_VERSIONS = sys.version, numba.__version__, llvmlite.__version__, np.__version__
_TYPES: Any = numba.types
#: Modules that pass options to numba, which count by themselves.
_PASSING = __name__, "lumped.compiler"
#: Modules with compiled functions are imported after this one [s]; clocks of files tick in hundredths.
_IMPORTED = time.time() - 0.05
#: Bytecode, and what it means. Not the flags: they repeat it, and numba clears them under a profiler.
_CODE = (
    "co_code", "co_names", "co_varnames", "co_freevars", "co_cellvars", "co_exceptiontable",
    "co_argcount", "co_posonlyargcount", "co_kwonlyargcount",
)  # fmt: skip


class UnknownDependencyError(Exception):
    """It cannot be decided whether code on disk belongs to the function."""


def stamp_of(dispatcher: Any) -> str:
    """Stamp of a compiled function.

    Raises
    ------
    UnknownDependencyError : it names an object that is neither taken apart nor from a file, or the file was
        written after its import
    """
    content = _VERSIONS, _Dependencies().of_compiled(dispatcher)
    return hashlib.sha256(repr(content).encode()).hexdigest()


def compiled_behind(dispatcher: Any) -> list[Any]:
    """Return a compiled function and all compiled functions that it calls, directly or not."""
    dependencies = _Dependencies()
    dependencies.of_compiled(dispatcher)
    return dependencies.functions


def own_state_of(dispatcher: Any) -> tuple[str, tuple[Any, ...]]:
    """State of a compiled function alone, and the compiled functions that it names.

    The functions count as objects, not with their content: the states of all of them say what the stamp says,
    and each is computed in a time that does not grow with the number of functions behind.

    Raises
    ------
    UnknownDependencyError : as ``stamp_of``
    """
    own = _OwnDependencies()
    content = own.of_compiled(dispatcher)
    return hashlib.sha256(repr(content).encode()).hexdigest(), tuple(own.functions[1:])


def described(signature: Any) -> str:
    """Types of the arguments, and the fields of records, which the names of the types leave out."""
    return repr((signature, list(_fields(signature))))


def _fields(kind: Any) -> Iterator[tuple[str, ...]]:
    if isinstance(kind, _TYPES.BaseNamedTuple):
        yield (kind.instance_class.__module__, kind.instance_class.__qualname__, *kind.fields)
    for part in kind if isinstance(kind, tuple | _TYPES.BaseTuple) else ():
        yield from _fields(part)
    if isinstance(kind, _TYPES.Optional):
        yield from _fields(kind.type)


class _Dependencies:
    """A walk from one function to everything on which it depends.

    The methods return texts, numbers and tuples, so that ``repr`` differs for any two results. An object that
    was visited before is represented by its number in the walk, because functions may call each other in
    circles.
    """

    def __init__(self) -> None:
        self._visited: dict[object, int] = {}
        self.functions: list[Any] = []

    def of_compiled(self, dispatcher: Any) -> tuple[Any, ...]:
        """Return a compiled function with its options and all globals that it names."""
        if (number := self._again(id(dispatcher))) is not None:
            return "again", number
        self.functions.append(dispatcher)
        function = dispatcher.py_func
        cells = function.__closure__ or ()
        bound = (
            dispatcher.targetoptions, dispatcher._compiler.pipeline_class.__qualname__, dispatcher.locals,
            function.__defaults__, function.__kwdefaults__,
            tuple(cell.cell_contents for cell in cells),
        )  # fmt: skip
        name = function.__qualname__
        module = function.__module__
        return module, name, self._of(bound, (), function), self._of_code(function.__code__, function)

    def _of_code(self, code: CodeType, function: FunctionType) -> tuple[Any, ...]:
        """Return bytecode, constants, inner functions, and every global that the code may name.

        ``co_names`` has attributes too. An attribute with the name of a global brings in this global without
        need.
        """
        constants = [
            self._of_code(one, function) if isinstance(one, CodeType) else self._of(one, (), function)
            for one in code.co_consts
        ]
        global_names = function.__globals__
        named = [
            (name, self._of(global_names[name], code.co_names, function))
            for name in code.co_names
            if name in global_names
        ]
        return *(getattr(code, part) for part in _CODE), *constants, *named

    def _of(self, value: Any, names: tuple[str, ...], function: FunctionType) -> Any:
        """Return the content of a global.

        ``names`` are the attributes that the code may read from a module.
        """
        kind = type(value)
        if value is None or value is ... or kind in (bool, int, float, complex, str, bytes):
            return kind.__name__, repr(value)
        if isinstance(value, Dispatcher):
            return self.of_compiled(value)
        if isinstance(value, ModuleType):
            return self._of_module(value, names, function)
        if isinstance(value, np.dtype):
            return "dtype", repr(value)
        if isinstance(value, np.generic | np.ndarray) and not value.dtype.hasobject:
            order = value.flags.c_contiguous, value.flags.f_contiguous
            return kind.__name__, repr(value.dtype), value.shape, order, value.tobytes()
        if kind in (set, frozenset):
            return kind.__name__, sorted(repr(self._of(one, names, function)) for one in value)
        if kind is dict:
            return "dict", [self._of(pair, names, function) for pair in value.items()]
        if isinstance(value, Enum):
            return self._of(kind, names, function), value.name
        if isinstance(value, tuple) and (kind is tuple or hasattr(kind, "_fields")):
            return self._of(kind, names, function), [self._of(one, names, function) for one in value]
        if isinstance(value, type) and issubclass(value, Enum):
            members = {name: member.value for name, member in value.__members__.items()}
            return value.__module__, value.__qualname__, self._of(members, names, function)
        if isinstance(value, type) and issubclass(value, tuple) and hasattr(value, "_fields"):
            defaults = self._of(getattr(value, "_field_defaults", {}), names, function)
            return value.__module__, value.__qualname__, value._fields, defaults
        if _in_library(value):
            return value.__module__, value.__qualname__
        return self._of_files(value, function)

    def _of_module(self, module: ModuleType, names: tuple[str, ...], function: FunctionType) -> Any:
        """Return the attributes that the code may read from a module."""
        if _root(module.__name__) in _LIBRARIES:
            return "library", module.__name__
        if (number := self._again((id(module), names))) is not None:
            return "again", number
        attributes = [(name, getattr(module, name)) for name in names if hasattr(module, name)]
        return module.__name__, [(name, self._of(value, names, function)) for name, value in attributes]

    def _of_files(self, value: Any, function: FunctionType) -> tuple[str, ...]:
        """Return a hash of the file of a global, else of the function, and of all files that are imported."""
        module = getattr(value, "__module__", None)
        if not isinstance(module, str) or _root(module) in _LIBRARIES:
            module = function.__module__
        return "files", getattr(value, "__qualname__", type(value).__qualname__), _text_behind(module)

    def _again(self, key: object) -> int | None:
        """Return the number of an object that was visited before, else None."""
        number = self._visited.get(key)
        self._visited.setdefault(key, len(self._visited))
        return number


class _OwnDependencies(_Dependencies):
    """A walk that ends at every other compiled function."""

    def of_compiled(self, dispatcher: Any) -> tuple[Any, ...]:
        """Return the first compiled function as the other walk does, and of each later one its number."""
        if not self.functions:
            return super().of_compiled(dispatcher)
        number = self._again(id(dispatcher))
        if number is None:
            self.functions.append(dispatcher)
        return "compiled", number


def _root(module: str) -> str:
    return module.partition(".")[0]


def _in_library(value: Any) -> bool:
    """Whether a class or function is the object with this name in a library."""
    module = getattr(value, "__module__", None)
    name = getattr(value, "__qualname__", None)
    if not isinstance(module, str) or not isinstance(name, str) or _root(module) not in _LIBRARIES:
        return False
    return getattr(sys.modules.get(module), name, None) is value


@cache
def _text_behind(module: str) -> str:
    """Hash of the file of a module and of all files that it imports, directly or not, without libraries."""
    texts: dict[str, str] = {}
    pending = [module]
    while pending:
        name = pending.pop()
        if name in texts or name in _PASSING or _root(name) in _LIBRARIES or (path := _file(name)) is None:
            continue
        status = path.stat()
        if max(status.st_mtime, status.st_ctime) >= _IMPORTED:
            raise UnknownDependencyError(f"{path} was written after its import")
        text = path.read_bytes()
        texts[name] = hashlib.sha256(text).hexdigest()
        pending += _imports(ast.parse(text), name if path.name == "__init__.py" else name.rpartition(".")[0])
    if module not in texts:
        raise UnknownDependencyError(f"{module} has no file")
    return hashlib.sha256(repr(sorted(texts.items())).encode()).hexdigest()


def _imports(tree: ast.AST, package: str) -> Iterator[str]:
    """Names of the modules that a file of this package may import."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            base = importlib.util.resolve_name("." * node.level + (node.module or ""), package)
            yield base
            yield from (f"{base}.{alias.name}" for alias in node.names)


def _file(module: str) -> Path | None:
    """Source file of a module that is or can be imported; None: there is none of that name."""
    imported = sys.modules.get(module)
    try:
        spec = None if imported is not None else importlib.util.find_spec(module)
    except (ImportError, ValueError):
        return None
    path = (
        imported.__file__ if imported is not None and hasattr(imported, "__file__") else spec and spec.origin
    )
    return Path(path) if path and path.endswith(".py") else None
