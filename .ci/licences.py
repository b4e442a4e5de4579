"""Print name, version and licence of spurcheck and of every distribution that it needs to run.

    python .ci/licences.py [EXTRA ...]

Licences are those that the metadata of a distribution state: the licence expression, else the classifiers,
else the first line of the field Licence. A distribution that states none is printed with "not stated", and
the exit code is 1.
"""

import importlib.metadata as metadata
import sys

from packaging.requirements import Requirement
from packaging.utils import canonicalize_name


def needed(extras: tuple[str, ...]) -> dict[str, metadata.Distribution]:
    """Return the distributions that spurcheck with its extras needs on this machine, by canonical name."""
    reached: dict[str, metadata.Distribution] = {}
    visited: set[tuple[str, str]] = set()
    waiting = [("spurcheck", ""), *(("spurcheck", extra) for extra in extras)]
    while waiting:
        name, extra = waiting.pop()
        if (name, extra) in visited:
            continue
        visited.add((name, extra))
        distribution = reached[name] = metadata.distribution(name)
        for text in distribution.requires or ():
            requirement = Requirement(text)
            if requirement.marker is None or requirement.marker.evaluate({"extra": extra}):
                target = canonicalize_name(requirement.name)
                waiting += [(target, ""), *((target, one) for one in requirement.extras)]
    return reached


def licence(distribution: metadata.Distribution) -> str:
    """Return the licence that the metadata of a distribution state; empty where they state none."""
    fields = distribution.metadata
    if fields.get("License-Expression"):
        return str(fields["License-Expression"])
    classifiers = [
        one.split(" :: ")[-1] for one in fields.get_all("Classifier") or () if one.startswith("License :: ")
    ]
    return ", ".join(classifiers) or str(fields.get("License") or "").strip().split("\n")[0]


def main() -> int:
    """Print the table, and return the exit code."""
    rows = [
        (distribution.metadata["Name"], distribution.version, licence(distribution))
        for _, distribution in sorted(needed(tuple(sys.argv[1:])).items())
    ]
    for name, version, stated in rows:
        print(f"{name:24} {version:14} {stated or 'not stated'}")
    return int(any(not stated for _, _, stated in rows))


if __name__ == "__main__":
    sys.exit(main())
