"""Does every number of the verification page keep its bound, and would it notice a wrong engine?"""

from __future__ import annotations

import numpy as np
import pytest

import validation.floquet_verification as verification
from floquet.vaishya_singh import CoulombGearPair


@pytest.mark.parametrize("function", verification.CHECKS, ids=lambda f: f.__name__)
def test_every_number_keeps_its_bound(function) -> None:
    checks = list(function())
    assert checks
    for check in checks:
        assert np.isfinite(check.value)
        assert check.passed, f"{check.name}: {check.value:.3g} not in {check.low:g} to {check.high:g}"


def test_a_wrong_closed_form_is_noticed(monkeypatch) -> None:
    # The pieces multiplied in the wrong order.
    def reversed_order(pair: CoulombGearPair, ratio: float) -> np.ndarray:
        first, second, third = (pair.transition(ratio, piece) for piece in range(3))
        return first @ second @ third

    monkeypatch.setattr(CoulombGearPair, "monodromy_matrix", reversed_order)
    assert not all(check.passed for check in verification.check_coulomb_gear_pair())


def test_the_table_is_printed(capsys, monkeypatch) -> None:
    monkeypatch.setattr(verification, "CHECKS", (verification.check_meissner,))
    assert verification.main() == 0
    assert "Meissner" in capsys.readouterr().out
