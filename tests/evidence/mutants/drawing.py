"""Which lines are changed, and how: drawn by a seed from the lines of physics and logic.

A line is known by its file, its text and how often the text has occurred in the file before. The lines of a
package are put in an order by a digest of that and the seed, and the first ones are taken. So an edit of
one line, or of any test, leaves the other lines drawn as they are.
"""

from __future__ import annotations

import hashlib
from collections import Counter, defaultdict
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from tests.evidence.mutants.operators import Mutation, differs, mutations

#: Share of each package in the lines drawn, in sixtieths. Of the lines that can be drawn the packages have
#: 22, 10, 19 and 9 sixtieths: both models are given somewhat more, for they hold the physics.
WEIGHTS = {"lumped": 26, "multibody": 12, "floquet": 13, "validation": 9}
#: What is not drawn: outcomes in words, labels, commands, pictures, pages and files of results (faults in
#: what a report shows have a catalogue of their own, in ``tests/evidence/faults``); how code is compiled
#: and kept.
LEFT_OUT = (
    "lumped/cache.py", "lumped/compiler.py", "lumped/errors.py", "lumped/labelling.py", "lumped/outcomes.py",
    "lumped/typing.py", "validation/cli.py", "validation/commands/", "validation/cross_check/words.py",
    "validation/exchange/new_pair_file.py", "validation/files/", "validation/interactive/",
    "validation/plots/", "validation/reporting/", "validation/stop_signals.py", "validation/templates/",
)  # fmt: skip


@dataclass(frozen=True)
class Mutant:
    """One change of one drawn line."""

    key: str  # digest of the line, whatever commit it is in
    file: str
    line: int
    operator: str
    before: str  # text of the lines that change, as one line
    after: str
    source: str  # the whole file with the change


def files(root: Path) -> list[str]:
    """Return path from the root -> file, for all files of a tree from which lines may be drawn."""
    paths = (path.relative_to(root).as_posix() for name in WEIGHTS for path in (root / name).rglob("*.py"))
    return sorted(file for file in paths if not file.startswith(LEFT_OUT))


def draw(root: Path, count: int, seed: int, only: str = "") -> list[Mutant]:
    """Draw mutants from the packages by weight, or from one file; fewer where there are not as many lines."""
    if only:
        return _first(root, [only], count, seed)
    shares = {name: count * weight / sum(WEIGHTS.values()) for name, weight in WEIGHTS.items()}
    counts = {name: int(share) for name, share in shares.items()}
    for name in sorted(shares, key=lambda one: counts[one] - shares[one])[: count - sum(counts.values())]:
        counts[name] += 1
    paths = files(root)
    parts = ([file for file in paths if file.startswith(f"{name}/")] for name in WEIGHTS)
    return [
        one
        for part, number in zip(parts, counts.values(), strict=True)
        for one in _first(root, part, number, seed)
    ]


def _first(root: Path, among: list[str], count: int, seed: int) -> list[Mutant]:
    """The first lines in the order of the seed, each with its change."""
    lines = {}
    for file in among:
        source = (root / file).read_text(encoding="utf-8")
        for key, line, changes in _lines(file, source):
            lines[_digest(seed, key)] = (key, file, line, changes, source)
    mutants: list[Mutant] = []
    for rank in sorted(lines):
        if len(mutants) == count:
            break
        mutants += _mutant(*lines[rank], seed)
    return mutants


def _lines(file: str, source: str) -> Iterator[tuple[str, int, list[Mutation]]]:
    """Key and number of every line that can change, and its changes."""
    content = source.encode()
    texts = source.split("\n")
    of_line = defaultdict(list)
    for change in mutations(source):
        of_line[content.count(b"\n", 0, change.start)].append(change)
    seen: Counter[str] = Counter()
    for number, text in enumerate(texts):
        seen[text.strip()] += 1
        if number in of_line:
            yield _digest(file, text.strip(), seen[text.strip()])[:12], number + 1, of_line[number]


def _mutant(key: str, file: str, line: int, changes: list[Mutation], source: str, seed: int) -> list[Mutant]:
    """Draw one mutant of a line, or None. The operator is drawn first, so rare operators are drawn, too."""
    begin = len("\n".join(source.split("\n")[: line - 1]).encode())

    def rank(change: Mutation) -> tuple[str, str]:
        return _digest(seed, key, change.operator), _digest(seed, key, change.start - begin, change.new)

    for change in sorted(changes, key=rank):
        changed = change.applied(source)
        if differs(source, changed):
            return [Mutant(key, file, line, change.operator, *_shown(source, changed, line), changed)]
    return []


def _shown(source: str, changed: str, line: int) -> tuple[str, str]:
    """The lines that a change touches, before and after, each as one line."""
    old = source.split("\n")[line - 1 :]
    new = changed.split("\n")[line - 1 :]
    while len(old) > 1 and len(new) > 1 and old[-1] == new[-1]:
        old.pop(), new.pop()
    return " ".join(" ".join(old).split()), " ".join(" ".join(new).split())


def _digest(*parts: object) -> str:
    return hashlib.sha256("\0".join(map(str, parts)).encode()).hexdigest()
