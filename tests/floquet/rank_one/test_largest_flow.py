"""Is the largest flow within a cycle that of all products of its steps?"""

import math
from itertools import accumulate

import numpy as np
import pytest

from floquet.rank_one.batch import fast_monodromies
from floquet.rank_one.kernel_input import packed
from floquet.rank_one.kernels.gains import Limits, Point
from floquet.rank_one.largest_flow import _largest_norm, _steps, largest_flow
from floquet.rank_one.system import RankOneSystem
from tests.floquet.rank_one.test_boxes import mathieu, meissner

LIMITS = Limits(1e-12, 0.5)


@pytest.mark.parametrize("system", [meissner()[0], mathieu()[0]], ids=["Meissner", "Mathieu"])
@pytest.mark.parametrize("period", [0.7, 9.0])
def test_it_bounds_all_products_of_the_steps_closely(system: RankOneSystem, period: float) -> None:
    problem = packed(system)
    point = Point(np.ones(1), 0.3, period)
    recorded = _steps(problem, point, LIMITS)
    assert recorded is not None
    steps = recorded.matrices[: recorded.number[0]]
    n = steps.shape[1]
    products = [list(accumulate(steps[i:], lambda flow, step: step @ flow)) for i in range(len(steps))]
    exact = max(1.0, *(float(np.linalg.norm(flow, 2)) for flows in products for flow in flows))
    found = largest_flow(problem, point, LIMITS)
    assert exact <= found.size <= exact * n ** (1 / 16)
    assert found.error >= recorded.errors[: len(steps)].sum()
    of_cycle = fast_monodromies(system, [period], 0.3).matrices[0]
    np.testing.assert_allclose(products[0][-1], of_cycle, rtol=0.0, atol=1e-10 * exact)


def test_a_flow_that_is_no_number_has_no_bound() -> None:
    flows = np.stack([np.eye(2), np.full((2, 2), math.nan)])
    assert math.isnan(_largest_norm(flows, 1.0))
    assert _largest_norm(flows[:1], 3.0) == 3.0


def test_too_many_steps_have_no_largest_flow() -> None:
    found = largest_flow(packed(meissner()[0]), Point(np.ones(1), 0.1, 1e12), LIMITS)
    assert math.isnan(found.size)
    assert math.isnan(found.error)
