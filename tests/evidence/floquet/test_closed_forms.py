"""Does every number of the verification keep its limit?"""

import numpy as np
import pytest

from floquet import PROPAGATORS, monodromy
from tests.evidence.floquet import closed_forms, coulomb_zones
from tests.evidence.floquet.closed_forms import (
    constant_error,
    mathieu_error,
    meissner_error,
    symplectic_defect,
)
from tests.evidence.floquet.reference_systems import meissner, meissner_trace

#: Methods of low order would need very many steps for more.
RTOL = {name: 1e-11 if known.order > 4 else 1e-8 for name, known in PROPAGATORS.items()}
extended = pytest.mark.skipif(
    np.finfo(np.longdouble).nmant < 63, reason="long double is no more than double on this platform"
)
CHECKS = (
    closed_forms.check_closed_forms, closed_forms.check_invariants, closed_forms.check_orders,
    pytest.param(closed_forms.check_random_gears, marks=extended), closed_forms.check_hsu,
    closed_forms.check_gear_chain, coulomb_zones.check_coulomb_gear_pair,
)  # fmt: skip


@pytest.mark.parametrize("function", CHECKS, ids=lambda f: getattr(f, "__name__", None))
def test_every_number_keeps_its_limit(function, monkeypatch) -> None:
    monkeypatch.setattr(closed_forms, "COUNT", 30)  # random gear pairs; the documentation draws 100
    checks = list(function())
    assert checks
    assert not [check for check in checks if not check.passes]


@pytest.mark.parametrize(("delta", "part"), [(0.5, 0.9), (2.75, 0.5), (5.0, 0.05), (1.0, 0.4), (4.0, 0.75)])
def test_the_verdict_is_that_of_the_closed_form(delta: float, part: float) -> None:
    assert meissner_error(delta, part * delta) < 1e-9
    unstable = abs(meissner_trace(delta, part * delta)) > 2.0
    assert monodromy(meissner(delta, part * delta)).verdict == ("unstable" if unstable else "undecided")


@pytest.mark.parametrize("q", [0.1, 1.0, 5.0])
def test_mathieu(q: float) -> None:
    assert max(mathieu_error(m, q, 1e-10) for m in range(5)) < 1e-9


@pytest.mark.parametrize("method", PROPAGATORS)
def test_every_propagator_keeps_closed_forms_across_switches_and_is_symplectic_as_registered(method) -> None:
    for delta, epsilon in ((1.3, 0.4), (4.0, 3.0), (2.2, 0.05)):
        # 100: |M| < 10, and the norm in which rtol is kept is a balanced one.
        assert meissner_error(delta, epsilon, RTOL[method], method) < 100 * RTOL[method]
    for n in (2, 8):
        assert constant_error(n, RTOL[method], method) < 10 * RTOL[method]  # balanced norm
    # Gauss methods conserve quadratic invariants.
    defect = symplectic_defect(method)
    assert defect < 1e-12 if PROPAGATORS[method].symplectic else defect > 1e-9
