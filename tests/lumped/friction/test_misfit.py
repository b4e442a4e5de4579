"""Is the error of the polynomials of a friction law bounded, and hardly more than it is?"""

import numpy as np
import pytest

from lumped import load_gear_pair, preset_names
from lumped.friction import LAWS
from lumped.friction.base import fit_signed
from lumped.friction.misfit import Ellipses, fit_misfit
from lumped.path_function import PathFunction

_T = np.cos(np.pi * (np.arange(300) + 0.5) / 300)


def sampled(function, law, path, settings):
    low, high = function.breaks[:-1, None], function.breaks[1:, None]
    xi = 0.5 * (low + high) + 0.5 * (high - low) * _T
    return np.abs(law.signed(xi.ravel(), path, settings).reshape(xi.shape) - function(xi)).max(axis=1)


@pytest.mark.parametrize("law", [name for name, law in LAWS.items() if law.analytic])
@pytest.mark.parametrize("preset", preset_names())
def test_the_bound_holds_everywhere_and_is_small_over_the_path(preset, law):
    for speed in (500.0, 4000.0, 20000.0):
        pair = load_gear_pair(preset).with_(operating__pinion_speed=speed)
        path, settings, record = pair.nominal_contact, pair.friction, LAWS[law]
        fit = fit_signed(record, path, settings)
        bound = fit_misfit(fit, record, path, settings)
        assert (sampled(fit, record, path, settings) <= bound).all()
        # The fit is wanted to 1e-10; next to P, where mu falls to 0 or is held, short pieces are known worse.
        assert bound @ np.diff(fit.breaks) < 1e-10 * (path.L_XD - path.L_XA)


@pytest.mark.parametrize("law", ["benedict_kelley", "xu_kahraman", "smoothed_coulomb"])
def test_the_bound_of_a_coarse_fit_is_close_to_its_error(law):
    pair = load_gear_pair("fzg_c")
    path, settings, record = pair.nominal_contact, pair.friction, LAWS[law]
    breaks = path.L_XP + (path.L_XD - path.L_XP) * np.geomspace(0.05, 1.0, 3)
    coarse = PathFunction.fit(lambda xi: record.signed(xi, path, settings), breaks, tolerance=1e-3)
    error, bound = sampled(coarse, record, path, settings), fit_misfit(coarse, record, path, settings)
    assert error.max() > 1e-10
    assert (error <= bound).all()
    assert bound.max() <= 10.0 * error.max()


@pytest.mark.parametrize("law", ["benedict_kelley", "xu_kahraman", "smoothed_coulomb"])
def test_the_law_is_at_most_its_bound_in_the_ellipse(law):
    """By the law written for complex positions, on the boundary, where an analytic function is largest."""
    pair = load_gear_pair("fzg_c")
    path, settings, record = pair.nominal_contact, pair.friction, LAWS[law]
    ends = path.L_XP + (path.L_XD - path.L_XP) * np.geomspace(0.02, 1.0, 8)
    ratio, most = record.analytic(ends[:-1], ends[1:], path, settings)
    for low, high, r, size in zip(ends[:-1], ends[1:], ratio, most, strict=True):
        w = r * np.exp(2j * np.pi * np.arange(100) / 100)
        z = 0.5 * (low + high) + 0.25 * (high - low) * (w + 1.0 / w)
        assert np.abs(complex_law(law, z, path, settings)).max() <= size
        assert size < 100.0 * record.signed(np.array([high]), path, settings)[0]
    assert Ellipses.clear_of(np.array([1.0]), np.array([2.0]), [1.0]).ratio == 1.0


def complex_law(law, z, path, settings):
    d, v_e = z - path.L_XP, path.omega_pinion * z + path.omega_gear * (path.L_XY - z)
    v_s, S = (path.omega_pinion + path.omega_gear) * d, path.roughness * 1e6
    if law == "benedict_kelley":
        number = 29.7 * path.unit_load / (path.viscosity * 1e3 * v_s * v_e**2)
        return 0.0127 * 1.13 / (1.13 - S) * np.log10(number)
    if law == "smoothed_coulomb":
        x, mean = settings.sharpness * d, 2.0 / np.pi * LAWS["coulomb"].factor(path, settings)
        return mean * (np.arctan(x) + x / (1.0 + x**2))
    b1, b2, b3, b4, b5, b6, b7, b8, b9 = (
        -8.916465, 1.03303, 1.036077, -0.354068, 2.812084, -0.100601, 0.752755, -0.390958, 0.620305
    )  # fmt: skip
    radius, eta = z * (path.L_XY - z) / path.L_XY, path.viscosity * 1e3
    p_h = 1e-9 * np.sqrt(path.unit_load * path.effective_modulus / (2.0 * np.pi * radius))
    slide = 2.0 * v_s / v_e
    shear = slide * p_h * np.log10(eta)
    f = b1 + b4 * shear + b5 * np.exp(-shear) + b9 * np.exp(S)
    return np.exp(f) * p_h**b2 * slide**b3 * (0.5 * v_e) ** b6 * eta**b7 * radius**b8
