"""Is a pair on shafts what it must be where that is known: a pair on springs, and balanced forces?"""

import numpy as np
import pytest

from lumped import ParameterError, periodic_system, simulate, steady_state


def test_rigid_shafts_are_the_springs(unequal, on_short_shafts):
    pair = unequal.with_({"mesh.contact": "loaded", "operating.pinion_speed": 3000})
    springs = steady_state(pair, samples_per_cycle=64)
    shafts = steady_state(on_short_shafts(pair), samples_per_cycle=64, supports="shafts")
    # Tooth dampers follow from the inertia of the gear alone, from which that of the shaft was taken: 1e-4.
    names = ("dte", "x_p", "y_g", "theta_p_dot", "normal_load", "bearing_force_x_g", "bearing_force_y_p")
    for name in names:
        size = float(np.abs(springs[name]).max())
        assert float(np.abs(shafts[name] - springs[name]).max()) < 1e-4 * size, name
    for name in ("brake_torque", "power_sliding", "power_bearings", "spectral_radius", "dte_peak_to_peak"):
        assert shafts.attrs[name] == pytest.approx(springs.attrs[name], rel=1e-4), name
    assert shafts.attrs["power_shafts"] == 0.0
    assert shafts.attrs["supports"] == "shafts"
    assert list(shafts.bearing.to_numpy()) == ["pinion 1", "gear 1"]
    np.testing.assert_array_equal(shafts.bearing_force[1, 0], shafts.bearing_force_x_g)


def test_motion_on_elastic_shafts(shafted):
    run = steady_state(shafted, samples_per_cycle=64, supports="shafts")
    assert run.attrs["error_estimate"] < 1e-6
    assert run.attrs["spectral_radius"] < 1.0
    assert run.attrs["power_bearings"] > 0.0
    assert run.attrs["power_shafts"] > 0.0
    assert list(run.bearing.to_numpy()) == ["pinion 1", "pinion 2", "gear 1"]
    # A transient from the periodic state stays, and one from rest does not.
    system = periodic_system(shafted, "full", supports="shafts")
    moved = simulate(shafted, 2, samples_per_cycle=64, initial="periodic", supports="shafts")
    for part in (moved.isel(time=slice(0, 64)), moved.isel(time=slice(64, 128))):
        size = float(np.abs(run.dte).max())
        np.testing.assert_allclose(part.dte, run.dte, rtol=0, atol=1e-9 * size)
    assert np.abs(moved.dte[0] - moved.dte[128]) < 1e-9 * size
    # At rest under the mean load, bearings and teeth bear it: moments about a bearing give the other's force.
    rest = simulate(shafted, 1, samples_per_cycle=8, supports="shafts").isel(time=0)
    load = shafted.operating.pinion_torque / shafted.geometry.base_radius_pinion
    assert rest.bearing_force.sel(bearing="gear 1", direction="loa") == pytest.approx(-load, rel=1e-9)
    second = load * (90.1 - 30.1) / (151 - 30.1)
    assert rest.bearing_force.sel(bearing="pinion 2", direction="loa") == pytest.approx(second, rel=1e-6)
    assert rest.dte * system.cycle.mean_stiffness == pytest.approx(load, rel=1e-9)


def test_every_form_is_the_same_system(shafted):
    whole, relative, feedback = (
        periodic_system(shafted, form, supports="shafts") for form in ("full", "elastic", "mesh")
    )
    m = len(whole.coordinates)
    keep = np.delete(np.arange(2 * m), [0, m])
    time = 0.3 * whole.period
    for other in (relative, feedback):
        np.testing.assert_array_equal(whole.A(time)[np.ix_(keep, keep)], other.A(time))
    assert not whole.A(time)[:, 0].any()  # the common rotation is felt by nobody
    # Opposite senses: the moments of the pinion's and the gear's shaft have opposite signs.
    gyroscopic, owner, kind = whole.gyroscopic, whole.held.modes.shaft, whole.held.modes.kind
    np.testing.assert_array_equal(gyroscopic, -gyroscopic.T)
    signs = [
        np.trace(gyroscopic[np.ix_((owner == j) & (kind == 0), (owner == j) & (kind == 1))]) for j in (0, 1)
    ]
    assert signs[0] < 0.0 < signs[1]


def test_without_shafts_there_are_none(unequal):
    for function in (steady_state, lambda pair, supports: periodic_system(pair, supports=supports)):
        with pytest.raises(ParameterError, match=r"a gear pair with a section \[shafts\]"):
            function(unequal, supports="shafts")
    with pytest.raises(ParameterError, match="springs, shafts"):
        periodic_system(unequal, supports="shaft")
