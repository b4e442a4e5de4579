"""The compiler of this package: no fast-math, since checks for NaN must work."""

from pathlib import Path

from lumped.compiler import Compiler

_PACKAGE = Path(__file__).parents[1]
compiled = Compiler(path for path in _PACKAGE.rglob("*.py") if b"@compiled" in path.read_bytes())
