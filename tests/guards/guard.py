"""What a guard is, and how it is tried from both sides of its limit, for both gears."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

from lumped import GearPair, ParameterError
from lumped.path_of_contact import law_range_violations
from lumped.path_of_contact.friction import friction_path_function
from lumped.quasi_static.tooth_error import relief_starts
from tests.unlike_pairs import unlike_pair

#: What acts on a pair with changes: the name under which it does, and its words.
Acts = list[tuple[str, str]]
Changes = Mapping[str, Any]
GEARS = ("pinion", "gear")
MATE = {"pinion": "gear", "gear": "pinion"}


def _refusals(action: Callable[[], object]) -> Acts:
    try:
        action()
    except ParameterError as error:
        return [(problem.field, str(problem)) for problem in error.problems]
    return []


def load(pair: GearPair, changes: Changes) -> Acts:
    """Fields that are refused where the pair is loaded."""
    return _refusals(lambda: pair.with_(dict(changes)))


def curve(pair: GearPair, changes: Changes) -> Acts:
    """Fields that are refused where the stiffness of a tooth pair is computed."""
    changed = pair.with_(dict(changes))
    return _refusals(lambda: changed.mesh.stiffness.curve(changed))


def relief(pair: GearPair, changes: Changes) -> Acts:
    """Fields that are refused where the relief becomes an unloaded tooth error."""
    changed = pair.with_(dict(changes))
    return _refusals(lambda: relief_starts(changed))


def friction(pair: GearPair, changes: Changes) -> Acts:
    """Fields that are refused where the friction coefficient over the path of contact is computed."""
    changed = pair.with_(dict(changes))
    return _refusals(lambda: friction_path_function(changed, warn=False))


def law_range(pair: GearPair, changes: Changes) -> Acts:
    """Quantities that leave the range of the pair's friction law."""
    return [(v.range.quantity, str(v)) for v in law_range_violations(pair.with_(dict(changes)))]


def stiffness_range(pair: GearPair, changes: Changes) -> Acts:
    """Quantities outside the range of the fits of the stiffness model, with the part of the model."""
    changed = pair.with_(dict(changes))
    return [(f"{v.law}: {v.range.quantity}", str(v)) for v in changed.mesh.stiffness.violations(changed)]


@dataclass(frozen=True)
class Guard:
    """One limit of the program: a row of the table.

    In the texts ``{gear}`` stands for one gear and ``{mate}`` for the other gear. A row with one of both is
    tried for both gears. Numbers are in the unit of the parameter file.

    Attributes
    ----------
    where : file with the guard
    names : field, range or sentence that the guard names
    least, most : last allowed value; a number, or a function of the pair and the name of the gear
    source : source of the limit
    base : name of the unlike pair on which the guard is tried
    after : changes of this pair that are made first
    sets : path of the field that takes the value, or function of pair, gear and value; default ``names``
    judge : function that returns the guards that act
    says : words of the message, different from the messages of other guards with the same name
    beside : whether other guards may act at the same values; else the guard must act alone
    near : distance of the tried values from the limit, relative (absolute at 0)
    whole : whether the value is a whole number; tried are the limit and the next whole number
    """

    where: str
    names: str
    base: str
    source: str
    least: float | Callable[[GearPair, str], float] | None = None
    most: float | Callable[[GearPair, str], float] | None = None
    sets: str | Callable[[GearPair, str, Any], Changes] | None = None
    judge: Callable[[GearPair, Changes], Acts] = load
    after: Changes = field(default_factory=dict)
    says: str = ""
    beside: bool = False
    near: float = 1e-9
    whole: bool = False

    @property
    def gears(self) -> tuple[str, ...]:
        """Gears for which the guard is tried. A guard without ``{gear}`` and ``{mate}`` is tried once."""
        texts = (self.names, self.says, *(self.after), self.sets if isinstance(self.sets, str) else "")
        return (
            GEARS
            if any("{gear}" in t or "{mate}" in t for t in texts) or callable(self.sets)
            else ("pinion",)
        )

    @property
    def title(self) -> str:
        """Name of the row in the list of tests."""
        way = "least" if self.most is None else "most"
        name = self.says if self.names == "doubt" else self.names
        return f"{name.strip(' =').replace(' ', '_')}-{way}"

    def pair(self, gear: str) -> GearPair:
        """The pair before its value is set."""
        after = {path.format(gear=gear, mate=MATE[gear]): value for path, value in self.after.items()}
        return unlike_pair(self.base).with_(after) if after else unlike_pair(self.base)

    def sides(self, gear: str) -> Iterator[tuple[bool, Any]]:
        """Whether it must act at a value, and the value: just inside and just outside."""
        limit = self.least if self.most is None else self.most
        value = limit(self.pair(gear), gear) if callable(limit) else limit
        out = -1 if self.most is None else 1
        if self.whole:
            yield False, value
            yield True, value + out
            return
        step = self.near * (abs(value) or 1.0)
        yield False, value - out * step
        yield True, value + out * step

    def acts(self, gear: str, value: Any) -> tuple[Acts, Acts]:
        """Return the guards that act at a value: guards with this name and these words, and all others."""
        names = {"gear": gear, "mate": MATE[gear]}
        sets = self.names if self.sets is None else self.sets
        pair = self.pair(gear)
        changes = sets(pair, gear, value) if callable(sets) else {sets.format(**names): value}
        guards = self.judge(pair, changes)
        matching = [
            a for a in guards if a[0] == self.names.format(**names) and self.says.format(**names) in a[1]
        ]
        return matching, [a for a in guards if a not in matching]

    def complaints(self) -> list[str]:
        """Sides of the limit on which the guard does not act as the row says."""
        wrong = []
        for gear in self.gears:
            for outside, value in self.sides(gear):
                matching, others = self.acts(gear, value)
                side = "outside" if outside else "inside"
                if len(matching) != outside:
                    wrong.append(f"{gear}, {value!r}, {side}: acts {len(matching)} times; beside it {others}")
                elif others and not self.beside:
                    wrong.append(f"{gear}, {value!r}, {side}: beside it {others}")
        return wrong


@dataclass(frozen=True)
class Choice:
    """A row of the table without a number: changes that are refused, and changes that are accepted."""

    where: str
    names: str
    base: str
    source: str
    refused: Changes
    taken: Changes
    judge: Callable[[GearPair, Changes], Acts] = load
    says: str = ""

    @property
    def title(self) -> str:
        """Name of the row in the list of tests."""
        return f"{self.names}-choice"

    def complaints(self) -> list[str]:
        """Changes with which the guard does not act as the row says."""
        wrong = []
        for gear, (outside, changes) in itertools.product(GEARS, ((True, self.refused), (False, self.taken))):
            names = {"gear": gear, "mate": MATE[gear]}
            expected_name = self.names.format(**names)
            named = {path.format(**names): value for path, value in changes.items()}
            guards = self.judge(unlike_pair(self.base), named)
            if [a[0] for a in guards] != [expected_name] * outside or any(
                self.says not in a[1] for a in guards
            ):
                wrong.append(f"{gear}, {named}: {guards}")
        return wrong
