"""Does every number of the verification page keep its bound, and would it notice a wrong engine?"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import validation.verification.floquet_closed_forms as verification
from floquet import monodromy
from floquet.gear import coulomb_zones
from floquet.gear.vaishya_singh import CoulombGearPair
from lumped.errors import NumericalError, ParameterError
from validation.reporting import floquet_page
from validation.verification import coulomb_zones as coulomb_checks
from validation.verification.floquet_check import error

PAGE = Path(__file__).parents[3] / "docs" / "verification" / "floquet.md"


@pytest.mark.parametrize("function", verification.CHECKS, ids=lambda f: f.__name__)
def test_every_number_keeps_its_bound(function) -> None:
    checks = list(function())
    assert checks
    for check in checks:
        assert np.isfinite(check.value)
        assert check.passed, f"{check.name}: {check.value:.3g} not in {check.low:g} to {check.high:g}"


@pytest.fixture
def quick_parts(monkeypatch):
    """Parts of the page without their cost: each writes its own name."""
    parts = {name: (lambda name=name: f"<{name}>\n") for name in floquet_page.FILES}
    monkeypatch.setattr(floquet_page, "FILES", parts)


def test_the_page_of_the_documentation_asks_for_every_part_once(quick_parts) -> None:
    text = PAGE.read_text(encoding="utf-8")
    page, figures = floquet_page.filled(text)
    assert "_generated" not in page
    for name in floquet_page.FILES:
        if name in figures:
            assert page.count(f"]({name})") == 1
        else:
            assert page.count(f"<{name}>") == 1
    assert set(figures) == {"floquet_coulomb_zones.svg"}


def test_no_number_of_a_table_is_typed_on_the_page() -> None:
    assert "|---" not in PAGE.read_text(encoding="utf-8").replace(" ", "")


def test_the_page_is_written_with_its_figure(tmp_path, quick_parts) -> None:
    assert floquet_page.main([str(PAGE), str(tmp_path / "out")]) == 0
    assert {p.name for p in (tmp_path / "out").iterdir()} == {PAGE.name, "floquet_coulomb_zones.svg"}
    assert floquet_page.main([]) == 2


def test_an_unknown_part_is_refused() -> None:
    with pytest.raises(ParameterError, match=r"floquet_exakt\.md"):
        floquet_page.filled("```{include} ../_generated/floquet_exakt.md\n```")


def test_a_number_outside_its_bounds_stops_the_page() -> None:
    def wrong():
        yield error("Meissner", 2e-9, 1e-9, "worst error")

    with pytest.raises(NumericalError, match="Meissner: 2e-09 is not ≤ 1e-09"):
        floquet_page.check_table((wrong,))


def test_the_figure_of_the_zones_is_reproducible() -> None:
    text = floquet_page.coulomb_zones()
    assert text.startswith("<?xml")
    assert text == floquet_page.coulomb_zones()


def test_zones_of_one_sign_close_where_a_change_of_scale_puts_them() -> None:
    # Friction of one sign is the frictionless pair at speed/sqrt(f) with damping zeta sqrt(f), exactly.
    f = np.sqrt(1.0 + coulomb_checks.MU * np.tan(np.deg2rad(20.0)))
    rows = {(zone, case): (damping, ratio) for zone, case, damping, ratio in coulomb_checks.zone_tips(2)}
    for zone in ("2ω", "2ω/2"):
        damping, ratio = rows[zone, "none"]
        assert rows[zone, "constant"] == pytest.approx((damping / f, ratio * f), rel=1e-6)
        # Friction that reverses opens a zone, in second order of mu tan alpha = 0.07.
        assert 0.0 < rows[zone, "reversing"][0] / damping - 1.0 < 2.0 * (f * f - 1.0) ** 2


def test_zones_on_a_grid_are_those_of_the_general_engine() -> None:
    pair = CoulombGearPair(friction=coulomb_checks.MU)
    found = coulomb_zones.zones(pair)
    for sign, damping, ratio in (
        ("reversing", 0.05, 1.95),
        ("constant", 0.02, 1.05),
        ("reversing", 0.0, 0.4),
    ):
        exact = replace(pair, sign=sign, damping_ratio=damping).system(ratio)
        at_sign = found["spectral_radius"].sel(friction=sign)
        near = at_sign.sel(damping_ratio=damping, speed_ratio=ratio, method="nearest")
        assert float(near) == pytest.approx(monodromy(exact, 1e-11).spectral_radius, rel=1e-8)


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
