"""Does an oil's viscosity follow Walther's law and its data sheet?"""

import numpy as np
import pytest

from lumped import load_gear_pair
from lumped.errors import ParameterError
from lumped.lubrication.viscosity import kinematic_viscosity, oil_density, viscosity_at_100, walther_constants
from lumped.path_of_contact import contact_path


def test_walther_passes_through_its_points():
    constants = walther_constants(100.0, 40.0, 11.1, 100.0)
    # two points determine two constants; the double logarithm amplifies rounding about tenfold
    np.testing.assert_allclose(kinematic_viscosity([40.0, 100.0], constants), [100.0, 11.1], rtol=1e-12)


def test_walther_is_straight_on_its_paper():
    constants = walther_constants(100.0, 40.0, 11.1, 100.0)
    celsius = np.array([-10.0, 25.0, 60.0, 130.0])
    level = np.log10(np.log10(kinematic_viscosity(celsius, constants) + 0.7))
    slopes = np.diff(level) / np.diff(np.log10(celsius + 273.15))
    np.testing.assert_allclose(slopes, -constants[1], rtol=1e-11)  # rounding of the double logarithm


@pytest.mark.parametrize("points", [(100, 40, 11, 40), (11, 40, 100, 100), (100, 40, 100, 100)])
def test_impossible_points_are_refused(points):
    with pytest.raises(ParameterError, match="less viscous at the higher one"):
        walther_constants(*points)


def test_density_expands_about_its_reference():
    assert oil_density(870.0, 15.0) == 870.0
    # slope at 15 degC is -0.6278 kg/(m^3 K) for every oil: a rho = 0.6278. Central difference over 2 K
    slope = (oil_density(870.0, 16.0) - oil_density(870.0, 14.0)) / 2
    assert slope == pytest.approx(-0.6278, rel=1e-5)


def test_density_expands_faster_when_hot():
    # ln(rho/rho_15) = -a dT - 0.8 (a dT)^2: its second difference over dT = 40 K is -1.6 (40 a)^2
    log_density = np.log(oil_density(870.0, [15.0, 55.0, 95.0]))
    bend = log_density[2] - 2 * log_density[1] + log_density[0]
    # 1.3e-3 from logarithms near 6.8: rounding 1e-15/1e-3
    assert bend == pytest.approx(-1.6 * (0.6278 / 870.0 * 40.0) ** 2, rel=1e-10)


def test_lubricant_law_feeds_the_contact():
    pair = load_gear_pair("nasa_28_28").with_(
        lubricant={
            "viscosity_law": {
                "kinematic_viscosity_40": 100.0,
                "kinematic_viscosity_100": 11.1,
                "density": 880.0,
                "temperature": 100.0,
            }
        }
    )
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
