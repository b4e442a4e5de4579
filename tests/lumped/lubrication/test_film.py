"""Do film, Hertz contact and an oil's viscosity obey their closed forms, data sheets and standards?"""

import itertools

import numpy as np
import pytest

from lumped import load_gear_pair
from lumped.errors import ParameterError
from lumped.lubrication.film import (
    effective_modulus,
    film_parameter,
    film_thickness,
    hertz_half_width,
    hertz_pressure,
    regime,
)
from lumped.lubrication.viscosity import (
    ISO_VG_MIDPOINT,
    grade_viscosity,
    kinematic_viscosity,
    oil_density,
    reference_oils,
    viscosity_at_100,
    viscosity_index,
    walther_constants,
)
from lumped.path_of_contact import contact_path

STEEL = float(effective_modulus(206e3, 0.3, 206e3, 0.3))  # N/mm^2


def test_film_does_not_depend_on_the_unit_system():
    # the same dimensionless groups from SI quantities; a wrong power of ten in equation (21) shows here
    modulus, eta, v_e, rho, w = STEEL * 1e6, 10e-3, 10.0, 8e-3, 100e3
    alpha = 0.010471 * 10**0.1348 * 1e-6  # mm^2/N -> m^2/N
    groups = (
        (alpha * modulus) ** 0.56 * (eta * v_e / (2 * modulus * rho)) ** 0.69 * (w / (modulus * rho)) ** -0.1
    )
    assert film_thickness(100, 8, 10, 10, STEEL) * 1e-6 == pytest.approx(3.06 * groups * rho, rel=1e-13)


def test_hertz_pressure_carries_the_load():
    # the elliptic pressure over the band integrates to (pi/2) p_h b_H = w
    w, rho = np.array([20.0, 100.0, 700.0]), np.array([3.0, 8.0, 20.0])
    carried = 0.5 * np.pi * hertz_pressure(w, rho, STEEL) * 1e3 * hertz_half_width(w, rho, STEEL)
    np.testing.assert_allclose(carried, w, rtol=1e-14)


@pytest.mark.parametrize("thresholds", [(1, 4), (1, 1, 10), (4, 1, 10), (0, 4, 10)])
def test_regime_refuses_thresholds_out_of_order(thresholds):
    with pytest.raises(ParameterError, match="three increasing positive film parameters"):
        regime(2.0, thresholds)


def test_a_film_on_smooth_flanks_is_refused():
    with pytest.raises(ParameterError, match="composite_roughness"):
        film_parameter(0.3, 0.1, 0.0)


def test_pair_takes_both_roughnesses_unless_one_is_given():
    pair = load_gear_pair("fzg_c").with_(pinion__roughness=0.3, gear__roughness=0.4)
    assert contact_path(pair).composite_roughness == pytest.approx(0.5e-6, rel=1e-14)
    assert contact_path(pair).roughness == pytest.approx(0.35e-6, rel=1e-14)
    given = pair.with_(friction__composite_roughness=0.2)
    assert contact_path(given).composite_roughness == pytest.approx(0.2e-6, rel=1e-14)


def test_walther_passes_through_its_points():
    constants = walther_constants(100.0, 40.0, 11.1, 100.0)
    # two points determine two constants; the double logarithm amplifies rounding about tenfold
    np.testing.assert_allclose(kinematic_viscosity([40.0, 100.0], constants), [100.0, 11.1], rtol=1e-12)


@pytest.mark.parametrize("points", [(100, 40, 11, 40), (11, 40, 100, 100), (100, 40, 100, 100)])
def test_impossible_points_are_refused(points):
    with pytest.raises(ParameterError, match="less viscous at the higher one"):
        walther_constants(*points)


def test_density_expands_about_its_reference():
    assert oil_density(870.0, 15.0) == 870.0
    # slope at 15 degC is -0.6278 kg/(m^3 K) for every oil: a rho = 0.6278. Central difference over 2 K
    slope = (oil_density(870.0, 16.0) - oil_density(870.0, 14.0)) / 2
    assert slope == pytest.approx(-0.6278, rel=1e-5)


def test_lubricant_law_feeds_the_contact():
    pair = load_gear_pair("nasa_28_28").with_(
        lubricant={
            "viscosity_law": {
                "kinematic_viscosity_40": 100.0, "kinematic_viscosity_100": 11.1, "density": 880.0,
                "temperature": 100.0,
            }
        }
    )  # fmt: skip
    expected = 11.1e-6 * float(oil_density(880.0, 100.0))
    assert pair.lubricant.dynamic_viscosity == pytest.approx(expected, rel=1e-12)
    assert contact_path(pair).viscosity == pytest.approx(expected, rel=1e-12)


def test_a_grade_in_the_parameter_file_is_its_walther_line():
    by_grade = load_gear_pair("nasa_28_28").with_(
        {"lubricant.viscosity": None, "lubricant.viscosity_law": {"iso_vg": 100, "temperature": "60 degC"}}
    )
    points = {
        "kinematic_viscosity_40": 100.0,
        "kinematic_viscosity_100": viscosity_at_100(100.0),
        "temperature": 60.0,
    }
    by_points = by_grade.with_({"lubricant.viscosity_law": points})
    # The same line through the same two points; the second passes through the file's units once more.
    assert by_grade.lubricant.dynamic_viscosity == pytest.approx(
        by_points.lubricant.dynamic_viscosity, rel=1e-12
    )


@pytest.mark.parametrize(
    "law",
    [{"iso_vg": 90}, {"iso_vg": 100, "kinematic_viscosity_40": 100.0}, {"kinematic_viscosity_40": 100.0}],
)
def test_half_a_description_of_an_oil_is_refused(law):
    with pytest.raises(ParameterError, match="iso_vg"):
        load_gear_pair("nasa_28_28").with_(
            {"lubricant.viscosity": None, "lubricant.viscosity_law": {**law, "temperature": 60.0}}
        )


@pytest.mark.parametrize(
    ("viscosity_40", "viscosity_100", "index"),
    [(73.30, 8.86, 92), (22.83, 5.05, 156), (53.47, 7.80, 111)],  # worked examples of ASTM D2270, section 5
)
def test_viscosity_index_of_the_standards_examples(viscosity_40, viscosity_100, index):
    assert round(viscosity_index(viscosity_40, viscosity_100)) == index


def test_pieces_of_the_reference_oils_join():
    # a wrong digit in the table shows as a gap; each piece is within 0.1 per cent of the tabulated oils
    for joint in (3.8, 4.4, 5.0, 6.4, 7.0, 7.7, 9.0, 12.0, 15.0, 18.0, 22.0, 28.0, 40.0, 55.0, 70.0):
        for left, right in zip(reference_oils(joint), reference_oils(joint * (1 + 1e-12)), strict=True):
            assert left == pytest.approx(right, rel=2e-3)


@pytest.mark.parametrize("viscosity", [10.0, 46.0, 100.0, 320.0, 3200.0])
@pytest.mark.parametrize("index", [60.0, 95.0, 100.0, 140.0])
def test_viscosity_at_100_inverts_the_index(viscosity, index):
    assert viscosity_index(viscosity, viscosity_at_100(viscosity, index)) == pytest.approx(index, abs=0.5)


def test_grades_are_a_preferred_number_series():
    # ISO 3448: each mid-point about 50 per cent above the one before
    grades = list(ISO_VG_MIDPOINT)
    assert (len(grades), grades[0], grades[-1]) == (20, 2, 3200)
    for grade, following in itertools.pairwise(grades):
        assert 1.4 <= ISO_VG_MIDPOINT[following] / ISO_VG_MIDPOINT[grade] <= 1.55


def test_what_does_not_exist_is_refused():
    with pytest.raises(ParameterError, match="iso_vg = 50: allowed 2, 3, 5"):
        grade_viscosity(50, 60.0)
    with pytest.raises(ParameterError, match="viscosity_index"):
        viscosity_at_100(2.2)
    with pytest.raises(ParameterError, match="kinematic_viscosity_100"):
        viscosity_index(10.0, 1.5)
