"""Which gear pairs do the tests use? A census of the pairs whose physics is computed, as a plugin of pytest.

``python -m pytest -n 0 -p tests.meta.census tests/lumped ...`` prints the table at its end. A use is a test
and a pair, whatever its operating point, of which the test computes stiffness, friction, masses or contact.
What is cached from an earlier test, or computed by a fixture of several tests, counts for the first of them.
"""

from __future__ import annotations

import sys
from collections import Counter
from collections.abc import Callable, Iterator
from typing import Any

import pytest

from lumped.path_of_contact import contact_path, pair_stiffness
from lumped.quasi_static.contacts import contact_of, mesh_elements
from lumped.schema.assumed import Assumed
from lumped.schema.bodies import bodies_of
from lumped.schema.pair import GearPair

#: What a test computes of a pair where it uses its physics.
ENTRANCES = (contact_path, pair_stiffness, contact_of, mesh_elements, bodies_of)
PACKAGES = ("lumped", "multibody", "floquet", "validation", "spurcheck", "tests")


class Census:
    """Uses of pairs by the tests of one run."""

    def __init__(self) -> None:
        self.uses: set[tuple[str, GearPair]] = set()
        self.test = ""

    def watched(self, entrance: Callable[..., Any]) -> Callable[..., Any]:
        def watch(pair: Any, *arguments: Any, **options: Any) -> Any:
            if isinstance(pair, GearPair):
                self.uses.add((self.test, standard(pair)))
            return entrance(pair, *arguments, **options)

        return watch

    def watch_modules(self) -> None:
        """Put a watch before the entrances in every module that has imported them."""
        watches = {id(entrance): self.watched(entrance) for entrance in ENTRANCES}
        for name, module in list(sys.modules.items()):
            if name.partition(".")[0] in PACKAGES and module is not None:
                for key, value in list(vars(module).items()):
                    if id(value) in watches:
                        setattr(module, key, watches[id(value)])

    @pytest.hookimpl(wrapper=True)
    def pytest_collection(self) -> Iterator[None]:
        collected = yield
        self.watch_modules()
        return collected

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_protocol(self, item: pytest.Item) -> Iterator[None]:
        self.test = item.nodeid
        return (yield)

    def pytest_terminal_summary(self, terminalreporter: Any) -> None:
        pairs = [pair for _, pair in self.uses]
        terminalreporter.write_line(f"{len(pairs)} uses of {len(set(pairs))} pairs")
        for question, answer in QUESTIONS.items():
            shares = Counter(answer(pair) for pair in pairs)
            text = ", ".join(f"{kind} {100 * n / len(pairs):.0f} %" for kind, n in shares.most_common(6))
            terminalreporter.write_line(f"{question}: {text}")


def standard(pair: GearPair) -> GearPair:
    """The pair at a speed and torque and with a name that are the same for all."""
    operating = pair.operating.model_copy(update={"pinion_speed": 1.0, "pinion_torque": 1.0})
    changed = {
        "operating": operating,
        "name": "",
        "description": "",
        "sources": (),
        "assumed": Assumed(),
        "uncertainty": (),
    }
    return GearPair.model_construct(**{name: getattr(pair, name) for name in GearPair.model_fields} | changed)


def ratio_of(pair: GearPair) -> str:
    ratio = pair.geometry.contact_ratio
    names = {1.2: "below 1.2", 1.5: "1.2 to 1.5", 1.8: "1.5 to 1.8", 2.0: "1.8 to 2", 2.2: "2 to 2.2"}
    return next((name for most, name in names.items() if ratio < most), "above 2.2")


def teeth_of(pair: GearPair) -> str:
    pinion = pair.pinion.teeth
    gear = pair.gear.teeth
    return "equal" if pinion == gear else "larger gear drives" if pinion > gear else "pinion drives"


QUESTIONS: dict[str, Callable[[GearPair], object]] = {
    "pair": lambda pair: f"{pair.pinion.teeth}/{pair.gear.teeth}",
    "rack [deg]": lambda pair: round(pair.basic_rack.pressure_angle * 57.29577951, 1),
    "teeth": teeth_of,
    "profile shift of the pinion": lambda pair: (
        "none"
        if pair.profile_shifts[0] == 0  # also one that follows from the centre distance
        else "positive"
        if pair.profile_shifts[0] > 0
        else "negative"
    ),
    "face widths": lambda pair: "equal" if pair.pinion.face_width == pair.gear.face_width else "unequal",
    "contact ratio": ratio_of,
    "stiffness": lambda pair: pair.mesh.stiffness.model,
    "teeth differ": lambda pair: pair.healthy is not pair,
    "shafts": lambda pair: pair.shafts is not None,
    "relief": lambda pair: (
        bool(pair.pinion.tip_relief or pair.gear.tip_relief) and pair.mesh.relief != "ignored"
    ),
    "contact": lambda pair: pair.mesh.contact,
    "friction": lambda pair: pair.friction.law,
}


def pytest_configure(config: pytest.Config) -> None:
    config.pluginmanager.register(Census(), "census of pairs")
