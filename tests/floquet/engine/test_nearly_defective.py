"""Do the bounds of multipliers hold where three of them nearly share an eigenvector, and are they no more?

Each error of the matrix that its bound allows is tried that moves one multiplier most; what it makes of the
multipliers is enclosed with 77 digits.
"""

import numpy as np
import pytest

pytest.importorskip("flint", reason="needs python-flint (extra: test)")

from floquet.engine.multipliers import multipliers_with_bounds
from tests.floquet.engine.judge.balls import worst_ratio
from tests.floquet.engine.judge.enclosures import balls, disks, nearly_defective, worst_errors


def ratios(M: np.ndarray, delta: float, near: float) -> tuple[float, float]:
    """Largest error over the bound: of all multipliers, and of the three next to a place."""
    values, bounds = multipliers_with_bounds(M, delta)
    cluster = np.argsort(np.abs(values - near))[:3]
    cluster_ratios = []
    for E in worst_errors(M, delta):
        exact = disks(balls(M) + balls(E))
        worst = worst_ratio(values, bounds, exact)[0]
        exact = sorted(exact, key=lambda disk: abs(disk[0] - near))[:3]
        cluster_ratios.append((worst, worst_ratio(values[cluster], bounds[cluster], exact)[0]))
    return tuple(np.max(cluster_ratios, axis=0))


@pytest.mark.parametrize("power", [3, 6, 9, 13, 18, 24])
@pytest.mark.parametrize("delta", [1e-15, 1e-12, 1e-9, 1e-7, 1e-5])
def test_bounds_hold_whatever_the_condition_of_the_eigenvectors(power: int, delta: float) -> None:
    """It is 1e2 to 1e12, and errors are from rounding to far more than tells the three apart."""
    worst, cluster = ratios(nearly_defective(power), delta, 0.875)
    assert worst <= 1.0
    assert cluster <= 1.0
    # Rounding of the residuals, some 1e-12, is in all bounds; errors above it move others as far as bounded.
    if delta > 1e-11:
        assert worst > 0.9
    # Where the error is beyond what tells them apart, Elsner's bound has (2 |B|)^(2/3), |B| up to 3 in the
    # basis of the Schur form, for the product of both couplings. Between there and simple ones it is looser.
    if delta >= 1e-9 and power >= 13:
        assert cluster > 1.0 / 8.0
    if power == 3 and 1e-11 < delta < 1e-8:
        assert cluster > 0.9
