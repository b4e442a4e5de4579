"""Is a quantity outside a stated range just beyond its limit, and inside just before it and at it?"""

import math
import warnings

import pytest

from lumped.errors import LawRangeWarning, ParameterError
from lumped.friction import LAWS
from lumped.ranges import checked, range_violations, warnings_are_heard
from lumped.stiffness import foundation, iso6336
from tests.guards.fits import RANGES

EVERY = [*iso6336.RANGES, foundation.HALF_ANGLE, foundation.BODY_RATIO]
EVERY += [one for law in LAWS.values() for one in law.ranges]


@pytest.mark.parametrize(("law", "quantity"), RANGES)
def test_both_ends(law, quantity):
    unit, *ends = RANGES[law, quantity]
    (limits,) = {
        one for one in EVERY if (one.quantity, one.unit, one.low, one.high) == (quantity, unit, *ends)
    }
    for out, end in zip((-1.0, 1.0), ends, strict=True):
        if end is not None:
            step = 1e-9 * (abs(end) or 1.0)
            assert range_violations("law", (limits,), {quantity: [end, end - out * step]}) == ()
            (violation,) = range_violations("law", (limits,), {quantity: [end, end + out * step]})
            assert violation.share == 0.5


def test_what_no_law_can_take():
    least = math.nextafter(0.0, 1.0)
    assert checked("v", [least, 1.0], "m/s").tolist() == [least, 1.0]
    assert checked("v", [0.0, 1.0], "m/s", allow_zero=True).tolist() == [0.0, 1.0]
    for value, allow_zero in ((0.0, False), (-least, True), (math.inf, True), (math.nan, True)):
        with pytest.raises(ParameterError, match="m/s"):
            checked("v", [1.0, value], "m/s", allow_zero=allow_zero)


@pytest.mark.parametrize("ignored", [LawRangeWarning, UserWarning, Warning])
def test_a_warning_that_everybody_ignores_is_not_heard(ignored):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ignored)
        assert not warnings_are_heard()


@pytest.mark.parametrize(
    "choose",
    [
        lambda: None,
        lambda: warnings.simplefilter("error", LawRangeWarning),
        lambda: warnings.simplefilter("ignore", DeprecationWarning),
        lambda: warnings.filterwarnings("ignore", "Benedict", LawRangeWarning),
        lambda: warnings.filterwarnings("ignore", category=LawRangeWarning, module="theirs"),
    ],
)
def test_a_warning_that_somebody_may_want_is_heard(choose):
    """A filter by text or module ignores some warnings; the first filter for a category decides."""
    with warnings.catch_warnings():
        warnings.resetwarnings()
        choose()
        assert warnings_are_heard()
