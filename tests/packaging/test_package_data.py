"""Are the files that are no Python code, which a wheel leaves out unless it is told, all named?"""

import tomllib
from fnmatch import fnmatch
from pathlib import Path

ROOT = Path(__file__).parents[2]
PACKAGES = ("lumped", "multibody", "floquet", "validation")


def test_every_file_of_the_packages_goes_into_the_wheel():
    data = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    patterns = data["tool"]["setuptools"]["package-data"]
    found, left_out = 0, []
    for package in PACKAGES:
        for path in sorted((ROOT / package).rglob("*")):
            if path.is_dir() or path.suffix == ".py" or path.parent.name == "__pycache__":
                continue
            found += 1
            name = path.relative_to(ROOT / package).as_posix()
            named = any(fnmatch(name, pattern) for pattern in patterns.get(package, ()))
            if not named and not any(fnmatch(path.name, pattern) for pattern in patterns["*"]):
                left_out.append(f"{package}/{name}")
    assert left_out == []
    assert found > 10
