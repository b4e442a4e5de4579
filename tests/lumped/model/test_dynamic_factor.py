"""K_v of ISO 6336-1 method B against a calculation by hand."""

import math

import pytest

import lumped
from lumped.model.dynamic_factor import _factors, iso_dynamic_factor

PAIR = lumped.load_gear_pair("fzg_c")


@pytest.mark.parametrize(
    ("eps", "expected"),
    [
        (1.4, (0.32, 0.34, 0.23, 0.90, 0.47, 0.47, 0.75)),
        (2.0, (0.32, 0.34, 0.23, 0.90, 0.47, 0.47, 0.875)),
        # ISO 6336-1:2006, table 8, by hand at 2.5
        (2.5, (0.32, 0.57 / 2.2, 0.096 / 0.94, 0.445 / 1.06, 0.47, 0.12 / 0.76, 1.0)),
    ],
)
def test_factors_of_the_table(eps, expected):
    assert _factors(eps) == pytest.approx(expected)


def test_the_resonance_speed_is_that_of_the_reduced_mass_on_the_mean_stiffness():
    """N = 1 where z omega = sqrt(c_gamma b/m_red): the formula with 30000/pi is that in rpm."""
    from lumped.stiffness.iso6336 import mean_of

    bodies = lumped.bodies(PAIR)
    natural = math.sqrt(mean_of(PAIR) / bodies.effective_mass)  # rad/s
    speed = natural / PAIR.pinion.teeth
    found = iso_dynamic_factor(PAIR.with_({"operating.pinion_speed": f"{speed!r} rad/s"}))
    assert found.resonance_ratio == pytest.approx(1.0, rel=1e-9)
    assert found.zone == "main resonance"


def test_it_is_one_at_rest_and_continuous_between_the_zones():
    def at(ratio: float):
        base = iso_dynamic_factor(PAIR).resonance_ratio
        speed = PAIR.operating.pinion_speed * ratio / base
        return iso_dynamic_factor(PAIR.with_({"operating.pinion_speed": f"{speed!r} rad/s"}))

    assert at(1e-4).factor == pytest.approx(1.0, abs=1e-3)
    assert at(1.15 + 1e-9).factor == pytest.approx(at(1.15 - 1e-9).factor, rel=1e-6)
    assert at(1.5 + 1e-9).factor == pytest.approx(at(1.5 - 1e-9).factor, rel=1e-6)
    assert [at(n).zone for n in (0.5, 1.0, 1.3, 2.0)] == [
        "subcritical",
        "main resonance",
        "intermediate",
        "supercritical",
    ]


def test_a_coarser_class_raises_it():
    fine, coarse = iso_dynamic_factor(PAIR, 4).factor, iso_dynamic_factor(PAIR, 8).factor
    # Pitch and profile tolerances grow by sqrt(2) a class: B_p and B_f by 4 from class 4 to 8.
    relief = max((r.amount for r in (PAIR.pinion.tip_relief, PAIR.gear.tip_relief) if r), default=0.0)
    assert coarse > fine
    if relief == 0.0:
        n, c3 = iso_dynamic_factor(PAIR).resonance_ratio, 0.23
        assert (coarse - 1.0 - n * c3) / (fine - 1.0 - n * c3) == pytest.approx(4.0, rel=1e-6)
