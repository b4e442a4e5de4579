"""Are the entries by which a box of a chart is proven enclosed, for eigenvectors that nearly are parallel?

Patches are made by hand, and what their entries are in the eigenvectors of a box is computed with 77 digits.
"""

import numpy as np
import pytest

pytest.importorskip("flint", reason="needs python-flint (extra: test)")

from flint import arb, arb_mat

from floquet.rank_one.boxes import FlowPolynomial, bounded_entries, decided
from tests.floquet.engine.judge.enclosures import balls, least_moduli, nearly_defective, real_balls

#: Boxes of a patch as (x, y) whose middles are those of the patch: all of it, parts, no width, two ulps wide.
CENTRAL = np.array([
    [[-1.0, 1.0], [-1.0, 1.0]], [[-0.3, 0.3], [-1.0, 1.0]], [[-1e-3, 1e-3], [-0.02, 0.02]],
    [[0.0, 0.0], [0.0, 0.0]], [[-5e-324, 5e-324], [-0.3, 0.3]],
])  # fmt: skip
#: Boxes with edges on those of the patch, in its middle and anywhere; one is one ulp wide.
OTHERS = np.array([
    [[-1.0, 0.0], [-1.0, 1.0]], [[0.0, 1.0], [-1.0, 0.0]], [[-0.7, -0.45], [0.1, 0.3]],
    [[0.97, 1.0], [-1.0, -0.9]], [[np.nextafter(0.5, 0.0), 0.5], [0.6, 0.8]],
])  # fmt: skip
#: Where each box is looked at, as shares of its widths: corners, middle and a place in each half.
SHARES = np.array([[a, b] for a in (0.0, 0.5, 1.0) for b in (0.0, 0.5, 1.0)] + [[0.2, 0.7], [0.8, 0.3]])
#: Rounding that every box allows for per unit of reach and of the coefficients: (64 24^2 + 32 (6 + 8)) 2^-53
#: times the coefficients before and after restriction, see `bounded_entries`.
ALLOWED = 2.0 * (64 * 24**2 + 32 * 14) * 2.0**-53


def patch_of(terms: dict[tuple[int, int], np.ndarray], error: float = 0.0) -> FlowPolynomial:
    """A patch with coefficients of T_a(x) T_b(y) for some (a, b)."""
    coefficients = np.zeros((24, 16, 6, 6))
    for place, matrix in terms.items():
        coefficients[place] = matrix
    return FlowPolynomial(coefficients, error, 1.0)


def exact_entries(
    terms: dict[tuple[int, int], np.ndarray], V: np.ndarray, box: np.ndarray
) -> tuple[list[np.ndarray], np.ndarray]:
    """Moduli of V^-1 M(x, y) V at places of a box, from below, and |row i of V^-1| |column j of V|."""
    inverse = balls(V).inv()
    vectors = balls(V)
    parts = arb_mat([real_balls(M).entries() for M in terms.values()])
    entries = []
    for x, y in box[:, 0] + SHARES * (box[:, 1] - box[:, 0]):
        row = arb_mat([[arb(x).chebyshev_t(a) * arb(y).chebyshev_t(b) for a, b in terms]]) * parts
        M = arb_mat(6, 6, row.entries())
        entries.append(least_moduli(inverse * M * vectors))
    rows = np.linalg.norm(least_moduli(inverse), axis=1)
    reach = rows[:, None] * np.linalg.norm(np.abs(V), axis=0) * (1.0 - 1e-14)  # rounding of the norms
    return entries, reach


def judged(
    terms: dict[tuple[int, int], np.ndarray], error: float, boxes: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Assert that all entries are inside their bounds.

    Returns for each box (k,) the sum of the bounds on the entries off the diagonal, less what rounding is
    allowed, and that of their largest values.
    """
    V, low, high, f, _, _ = bounded_entries(patch_of(terms, error), boxes[:, 0].T, boxes[:, 1].T)
    assert np.isfinite(high).all()
    allowed = ALLOWED * sum(np.linalg.norm(M) for M in terms.values())
    sums = []
    for k, box in enumerate(boxes):
        entries, reach = exact_entries(terms, V[k], box)
        largest = np.maximum.reduce(entries) + error * reach
        least = np.minimum.reduce(entries) * (1.0 + 1e-14) - error * reach  # moduli from above
        assert (np.diagonal(largest) <= high[k]).all()
        assert (np.diagonal(least) >= low[k]).all()
        largest[range(6), range(6)] = 0.0
        assert (largest <= f[k]).all()
        sums.append((f[k].sum() - allowed * reach.sum(), largest.sum()))
    return tuple(np.array(sums).T)


def varied(kind: str) -> tuple[dict[tuple[int, int], np.ndarray], float]:
    """Terms that vanish in the middle of the patch, and an error of the patch."""
    first, second, third = np.random.default_rng(11).normal(size=(3, 6, 6))
    return {
        "one term": ({(1, 0): 0.3 * first}, 0.0),
        "signed terms": ({(1, 0): -0.3 * first, (3, 2): 0.2 * second, (0, 3): -0.1 * third}, 0.0),
        # Beyond the terms whose signs count; of their restriction to a part of the patch some are negative.
        "high terms": ({(11, 0): -0.3 * first, (0, 9): 0.2 * second, (17, 5): third}, 0.0),
        "error": ({(1, 0): 1e-9 * first}, 1e-5),
    }[kind]


#: By how much the sum of the bounds may exceed that of the largest entries. One term is largest at an end of
#: a box and is its own sum of moduli, but for the inverse, whose error is up to a tenth of the worst column
#: at condition 1e12. The signs of several terms do not agree at one corner. Of those of high degree only the
#: moduli of the matrices count, times |row| |column|.
LOOSE = {"one term": 1.2, "signed terms": 1.6, "high terms": 20.0, "error": 1.001}


@pytest.mark.parametrize("power", [3, 9, 13, 16, 20])
@pytest.mark.parametrize("kind", LOOSE)
def test_entries_are_enclosed_where_eigenvectors_nearly_are_parallel(kind, power) -> None:
    """Their condition is 1e2 to 1e12. The worst error of the patch moves an entry by its norm times reach."""
    terms, error = varied(kind)
    bound, largest = judged({(0, 0): nearly_defective(power), **terms}, error, CENTRAL)
    assert (bound <= LOOSE[kind] * largest).all()


@pytest.mark.parametrize("kind", LOOSE)
def test_entries_are_enclosed_in_boxes_at_the_ends_of_a_patch(kind) -> None:
    terms, error = varied(kind)
    bound, largest = judged({(0, 0): nearly_defective(4), **terms}, error, OTHERS)
    assert (bound <= LOOSE[kind] * largest).all()


def test_eigenvectors_that_are_parallel_to_rounding_bound_nothing() -> None:
    """Of an exact Jordan block the inverse of the eigenvectors is wrong by as much as it is."""
    core = np.diag([0.875, 0.875, -0.5, 0.375, 0.25, 0.125])
    core[0, 1] = 1.0
    x, y = CENTRAL[2:3, 0].T, CENTRAL[2:3, 1].T
    patch = patch_of({(0, 0): core})
    _, low, high, _, _, _ = bounded_entries(patch, x, y)
    assert (high == np.inf).all()
    assert (low == -np.inf).all()
    assert decided(patch, x, y).verdict.tolist() == [0]


def test_a_box_is_decided_up_to_where_its_largest_multiplier_is_1() -> None:
    """Multipliers 1 + x/8, -1/2, ... in a basis of whole numbers, exact: 1 is crossed at x = 0.

    From below |1 + x/8|^2 is known but for the curvature, (width/16)^2.
    """
    upper = np.eye(6) + np.diag([1.0, -1.0, 1.0, -1.0, 1.0], 1)
    inverse = np.rint(np.linalg.inv(upper))
    middle = upper @ np.diag([1.0, -0.5, 0.375, 0.25, 0.125, 0.0625]) @ inverse
    change = upper @ np.diag([0.125, 0.0, 0.0, 0.0, 0.0, 0.0]) @ inverse
    ends = np.array([[-1.0, -1e-8], [-1.0, 0.0], [-1e-8, 1e-8], [0.0, 1.0], [1e-8, 1e-5]])
    all_y = np.tile([-1.0, 1.0], (len(ends), 1))
    expected = [1, 0, 0, 0, -1]
    assert decided(patch_of({(0, 0): middle, (1, 0): change}), ends.T, all_y.T).verdict.tolist() == expected
    # An error of the patch moves the crossing by at most 8 error reach, and reach is below 10 here.
    wrong = patch_of({(0, 0): middle, (1, 0): change}, 1e-3)
    ends = np.array([[-1.0, -1e-3], [-1.0, -0.1], [1e-3, 1.0], [0.1, 1.0]])
    assert decided(wrong, ends.T, all_y[:4].T).verdict.tolist() == [0, 1, 0, -1]
