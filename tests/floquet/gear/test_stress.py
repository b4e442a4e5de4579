"""Is the compiled route as accurate as it says on random gear pairs, measured in extended precision?"""

from __future__ import annotations

import numpy as np
import pytest

from floquet import gear_pair_system, monodromy
from floquet.gear.reference import RATE, extended_monodromy, stress_test
from lumped import load_gear_pair

extended = pytest.mark.skipif(
    np.finfo(np.longdouble).nmant < 63, reason="long double is no more than double on this platform"
)


@extended
@pytest.mark.slow
def test_random_pairs_stay_within_their_bounds() -> None:
    seed = 4
    result = stress_test(100, seed)
    print(f"seed {seed}: worst error {result.error.max('pair').values}")
    assert (result.excess <= 1.0).all()
    assert (result.error.sel(route="fine") < 1e-11).all()
    assert (result.error < 1e-9).all()  # required of the fast route
    # Not idle: a bound that is always large would pass.
    assert float(result.bound.sel(route="fine").median()) < 1e-9
    assert float(result.bound.sel(route="joined").median()) < 1e-8


@pytest.mark.parametrize("law", ["coulomb", "xu_kahraman"])
def test_reference_agrees_with_the_general_engine(law: str) -> None:
    # Two routes that share neither the series nor the arithmetic.
    pair = load_gear_pair("fzg_c").with_(friction__law=law)
    units = np.repeat([1.0, RATE], 3)
    exact = extended_monodromy(pair) * units[:, None] / units
    other = monodromy(gear_pair_system(pair, "feedback"), rtol=1e-11)
    d = other.scaling
    assert np.linalg.norm((other.matrix - exact) * d / d[:, None], 2) <= other.matrix_error
