"""Is the reference in extended precision the gear pair of the general engine?"""

import numpy as np
import pytest

from floquet import gear_pair_system, monodromy
from lumped import load_gear_pair
from tests.evidence.floquet.extended import RATE, extended_monodromy


@pytest.mark.parametrize("law", ["coulomb", "xu_kahraman"])
def test_reference_agrees_with_the_general_engine(law: str) -> None:
    # Two routes that share neither the series nor the arithmetic.
    pair = load_gear_pair("fzg_c").with_(friction__law=law)
    units = np.repeat([1.0, RATE], 3)
    exact = extended_monodromy(pair) * units[:, None] / units
    other = monodromy(gear_pair_system(pair, "mesh"), rtol=1e-11)
    d = other.scaling
    assert np.linalg.norm((other.matrix - exact) * d / d[:, None], 2) <= other.matrix_error
