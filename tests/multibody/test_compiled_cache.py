"""Does an edit of one compiled file reach the functions of other files that call it?"""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import multibody._jit

CALLED = """
from pkg._jit import compiled

@compiled
def double(x):
    return 2.0 * x
"""
CALLER = """
from pkg._jit import compiled
from pkg.called import double

@compiled
def f(x):
    return double(x)
"""


def test_the_cache_notices_edits_of_called_files(tmp_path):
    package = tmp_path / "pkg"
    package.mkdir()
    for name, text in (
        ("__init__", ""),
        ("_jit", Path(multibody._jit.__file__).read_text(encoding="utf-8")),
        ("called", CALLED),
        ("caller", CALLER),
    ):
        (package / f"{name}.py").write_text(text, encoding="utf-8")

    def run():
        """Value, and the number of functions taken from the cache."""
        code = "from pkg.caller import f; print(f(1.0), sum(f.stats.cache_hits.values()))"
        shown = subprocess.run(
            [sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True, check=True
        )
        return tuple(float(part) for part in shown.stdout.split())

    assert run() == (2.0, 0)
    assert run() == (2.0, 1)  # there is a cache to go stale
    (package / "called.py").write_text(CALLED.replace("2.0", "3.0"), encoding="utf-8")
    assert run() == (3.0, 0)
