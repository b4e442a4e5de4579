"""The compiler of this package: no fast-math, since checks for NaN must work."""

from pathlib import Path

from lumped.compiler import Compiler

compiled = Compiler(path for path in Path(__file__).parent.glob("*.py") if b"@compiled" in path.read_bytes())
