"""Test one's own gear model by pytest: the marker ``spurcheck`` and the fixture ``spurcheck_reference``.

    @pytest.mark.spurcheck(pair="mypair.toml")
    def test_my_model(spurcheck_reference):
        spurcheck_reference.check(my_model.simulate(speed=1450))

Nothing is imported but pytest itself until a test asks for the fixture.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

if TYPE_CHECKING:
    from lumped import GearPair
    from validation.check.check import Check


@dataclass(frozen=True)
class SpurcheckReference:
    """The reference of a test: a gear pair, and what agrees.

    Attributes
    ----------
    pair : the gear pair of the marker
    limit : misfit up to which curves agree
    options : further arguments of ``spurcheck.check``
    """

    pair: GearPair
    limit: float
    options: dict[str, Any]

    def check(self, theirs: Any) -> Check:
        """Check curves against both programs, see ``spurcheck.check``.

        Raises
        ------
        AssertionError : the curves do not agree; the text has the verdict and the ladder of explanations
        ParameterError : curves that cannot be read or compared
        """
        from validation.check import check

        result = check(self.pair, theirs, limit=self.limit, **self.options)
        if not result.agrees:
            raise AssertionError(ladder_text(result))
        return result


def ladder_text(result: Check) -> str:
    """Return the verdict, the misfit of each channel and the ladder as lines of text."""
    from validation.check.words import percent

    lines = [result.words]
    if result.problem is not None:
        lines += [
            f"  {row.channel.channel.name}: misfit {percent(row.total)}" for row in result.nearer.channels
        ]
    for number, step in enumerate(result.explanations, start=1):
        lines.append(f"  {number}. {step.sentence}: the misfit is then {percent(step.misfit)}")
        lines += [f"     or: {other.sentence}: {percent(other.misfit)}" for other in step.alternatives]
    if result.ladder is not None:
        lines += [
            f"     alone: {other.sentence}: {percent(other.misfit)}" for other in result.ladder.others_alone
        ]
    lines += [f"  {remark}" for remark in result.remarks]
    return "\n".join(lines)


def pytest_configure(config: pytest.Config) -> None:
    """Register the marker."""
    config.addinivalue_line(
        "markers",
        'spurcheck(pair="mypair.toml", limit=0.05, **options): gear pair of the fixture spurcheck_reference; '
        "a relative path starts at the folder of the test; options of spurcheck.check",
    )


@pytest.fixture
def spurcheck_reference(request: pytest.FixtureRequest) -> SpurcheckReference:
    """The gear pair of the marker ``spurcheck``, with ``check(curves)``."""
    marker = request.node.get_closest_marker("spurcheck")
    if marker is None or "pair" not in marker.kwargs or marker.args:
        raise pytest.UsageError('Mark the test: @pytest.mark.spurcheck(pair="mypair.toml").')
    from lumped import load_gear_pair

    options = dict(marker.kwargs)
    pair = options.pop("pair")
    limit = float(options.pop("limit", 0.05))
    if isinstance(pair, (str, Path)):
        beside_test = request.path.parent / pair
        pair = beside_test if beside_test.is_file() else pair
    return SpurcheckReference(load_gear_pair(pair), limit, options)
