"""Is no verdict on systems without damping wrong, and are nearly all of them decided?"""

import pytest

from tests.evidence.floquet.neutral_counts import Count, count_gears, count_mathieu, count_meissner


@pytest.mark.parametrize(
    ("count", "share"),
    [(lambda: count_mathieu(60), 1.0), (lambda: count_meissner(60), 1.0), (lambda: count_gears(3), 0.9)],
)
def test_verdicts_are_those_of_the_judge(count, share: float) -> None:
    result: Count = count()
    assert result.wrong == 0
    verdicts = result.verdicts
    decided = verdicts["neutral"] + verdicts["unstable"]
    assert decided >= share * sum(verdicts.values())
    assert min(verdicts["neutral"], verdicts["unstable"]) > 0
