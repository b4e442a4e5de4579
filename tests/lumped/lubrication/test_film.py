"""Do Hertz contact, film thickness and film parameter obey their closed forms and their published numbers?"""

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
