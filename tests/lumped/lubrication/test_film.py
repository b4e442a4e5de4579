"""Do film, Hertz contact and an oil's viscosity obey their closed forms, data sheets and standards?"""

import itertools

import pytest

from lumped import load_gear_pair
from lumped.errors import ParameterError
from lumped.lubrication.film import film_parameter, film_thickness, regime
from lumped.lubrication.viscosity import (
    ISO_VG_MIDPOINT,
    grade_viscosity,
    oil_density,
    reference_oils,
    viscosity_at_100,
    viscosity_index,
    walther_constants,
)
from lumped.path_of_contact import contact_path


@pytest.mark.parametrize("thresholds", [(1, 4), (1, 1, 10), (4, 1, 10), (0, 4, 10)])
def test_regime_refuses_thresholds_out_of_order(thresholds):
    with pytest.raises(ParameterError, match="three increasing positive film parameters"):
        regime(2.0, thresholds)


@pytest.mark.parametrize(("formula", "power"), [("dowson_toyoda", 0.56), ("hamrock_dowson", 0.53)])
def test_a_film_goes_with_the_pressure_viscosity_of_its_oil(formula, power):
    """k = 0.009, s = 0.17 against k = 0.0125, s = 0.151 at 33 mPa s: G is proportional to k 33^s."""
    first, second = (
        film_thickness(100, 8, 33, 10, 2e5, pressure_viscosity_k=k, pressure_viscosity_s=s, formula=formula)
        for k, s in ((0.009, 0.17), (0.0125, 0.151))
    )
    alpha = 0.009 / 0.0125 * 33.0 ** (0.17 - 0.151)
    assert first / second == pytest.approx(alpha**power, rel=1e-12)


def test_a_film_on_smooth_flanks_is_refused():
    with pytest.raises(ParameterError, match="composite_roughness"):
        film_parameter(0.3, 0.1, 0.0)


@pytest.mark.parametrize("points", [(100, 40, 11, 40), (11, 40, 100, 100), (100, 40, 100, 100)])
def test_impossible_points_are_refused(points):
    with pytest.raises(ParameterError, match="less viscous at the higher one"):
        walther_constants(*points)


def test_lubricant_law_feeds_the_contact():
    law = {"kinematic_viscosity_40": 100.0, "kinematic_viscosity_100": 11.1, "density": 880.0}
    pair = load_gear_pair("nasa_28_28").with_(lubricant={"viscosity_law": law | {"temperature": 100.0}})
    expected = 11.1e-6 * float(oil_density(880.0, 100.0))
    assert pair.lubricant.dynamic_viscosity == pytest.approx(expected, rel=1e-12)
    assert contact_path(pair).viscosity == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize(
    ("viscosity_40", "viscosity_100", "index"),
    [(73.30, 8.86, 92), (22.83, 5.05, 156), (53.47, 7.80, 111)],  # worked examples of ASTM D2270, section 5
)
def test_viscosity_index_of_the_standards_examples(viscosity_40, viscosity_100, index):
    assert round(viscosity_index(viscosity_40, viscosity_100)) == index


def test_pieces_of_the_reference_oils_join():
    # a wrong digit in the table shows as a gap; each piece is within 0.1 per cent of the tabulated oils
    for joint in (3.8, 4.4, 5.0, 6.4, 7.0, 7.7, 9.0, 12.0, 15.0, 18.0, 22.0, 28.0, 40.0, 55.0, 70.0):
        for below, above in zip(reference_oils(joint), reference_oils(joint * (1 + 1e-12)), strict=True):
            assert below == pytest.approx(above, rel=2e-3)


@pytest.mark.parametrize("viscosity", [10.0, 46.0, 100.0, 320.0, 3200.0])
@pytest.mark.parametrize("index", [60.0, 95.0, 100.0, 140.0])
def test_viscosity_at_100_inverts_the_index(viscosity, index):
    assert viscosity_index(viscosity, viscosity_at_100(viscosity, index)) == pytest.approx(index, abs=0.5)


def test_grades_are_a_preferred_number_series():
    # ISO 3448: each mid-point about 50 per cent above the one before
    grades = list(ISO_VG_MIDPOINT)
    assert (len(grades), grades[0], grades[-1]) == (20, 2, 3200)
    for grade, next_grade in itertools.pairwise(grades):
        assert 1.4 <= ISO_VG_MIDPOINT[next_grade] / ISO_VG_MIDPOINT[grade] <= 1.55


def test_what_does_not_exist_is_refused():
    with pytest.raises(ParameterError, match="iso_vg = 50: allowed 2, 3, 5"):
        grade_viscosity(50, 60.0)
    with pytest.raises(ParameterError, match="viscosity_index"):
        viscosity_at_100(2.2)
    with pytest.raises(ParameterError, match="kinematic_viscosity_100"):
        viscosity_index(10.0, 1.5)
