"""A function of the user, by the name "path/to/file.py:function"."""

from __future__ import annotations

import importlib.util
import inspect
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from types import ModuleType
from typing import Any

from lumped.arguments import nearest
from lumped.errors import refuse


def named_function(field: str, source: str | Path, form: str) -> Callable[..., Any] | None:
    """Return the function that "path/to/file.py:function" names; None where the text names no Python file.

    The function can import modules beside its file when it runs.

    Parameters
    ----------
    field : name of the argument in a refusal
    source : the text
    form : how the function is written, for a file without functions: "f(parameters)"

    Raises
    ------
    ParameterError : no such file, a file that cannot be imported, no such function, or no name of a function
    """
    path, separator, name = str(source).rpartition(":")
    if separator and path.lower().endswith(".py"):
        return _of_module(field, Path(path), name)
    if str(source).lower().endswith(".py"):
        functions = _functions(_module(field, Path(source)))
        action = f"Type {source}:{functions[0]}" if functions else f"Write a function {form}."
        allowed = "the name of a function behind a colon"
        raise refuse(field, str(source), allowed, f"{action}. Functions: {', '.join(functions)}.")
    return None


def _of_module(field: str, path: Path, name: str) -> Callable[..., Any]:
    module = _module(field, path)
    function = getattr(module, name, None)
    if not callable(function):
        functions = _functions(module)
        action = nearest(name, functions) or "Name one of these."
        allowed = f"one of {', '.join(functions)}" if functions else "a function of the module"
        raise refuse(field, f"{path}:{name}", allowed, action)
    return _in_folder(function, path.resolve().parent)


def _in_folder(function: Callable[..., Any], folder: Path) -> Callable[..., Any]:
    """Return the function so that it imports modules beside its own as it runs."""

    def wrapped(*arguments: Any, **keywords: Any) -> Any:
        with _importable(folder):
            return function(*arguments, **keywords)

    wrapped.__signature__ = inspect.signature(function)  # type: ignore[attr-defined]
    return wrapped


def _functions(module: ModuleType) -> list[str]:
    return [
        name
        for name, value in vars(module).items()
        if inspect.isfunction(value) and value.__module__ == module.__name__ and name[0] != "_"
    ]


@contextmanager
def _importable(folder: Path) -> Iterator[None]:
    """Let modules of a folder be imported."""
    sys.path.insert(0, str(folder))
    try:
        yield
    finally:
        sys.path.remove(str(folder))


def _module(field: str, path: Path) -> ModuleType:
    """Import a module file."""
    if not path.is_file():
        raise refuse(field, path, "a Python file that exists", "Check the folder and the name.")
    spec = importlib.util.spec_from_file_location(f"their_model_{path.stem}", path)
    if spec is None or spec.loader is None:
        raise refuse(field, path, "a Python file", "Name a file that ends in .py.")
    module = importlib.util.module_from_spec(spec)
    try:
        with _importable(path.resolve().parent):
            spec.loader.exec_module(module)
    except Exception as error:
        why = f"{type(error).__name__}: {error}"
        raise refuse(field, path, "a Python file that can be imported", f"Correct it: {why}.") from error
    return module
