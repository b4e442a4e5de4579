"""Does an independent nonlinear model confirm what Floquet theory says about the linear one?"""

from __future__ import annotations

import numpy as np
import pytest

import floquet
import lumped
import multibody

BASE = lumped.load_gear_pair("nasa_28_28").with_(friction__law="coulomb", friction__coefficient=0.05)
SMOOTH = BASE.with_(mesh__stiffness={"model": "parabolic", "ramp_length": 3.0})
#: Light mesh damping at the speed where the mesh frequency is twice the highest natural frequency: main
#: tongue.
TONGUE = BASE.with_(
    friction__coefficient=0.03,
    mesh__damping_ratio=0.01,
    operating__pinion_speed=33500,
)


def balanced_difference(matrix, reference, period):
    """Norm of the difference over the norm, with rates measured in lengths per radian of the mesh cycle."""
    d = np.concatenate([np.ones(5), np.full(5, period / (2 * np.pi))])
    a, b = (m * d[:, None] / d for m in (matrix, reference))
    return float(np.linalg.norm(a - b) / np.linalg.norm(b))


def floquet_matrix(pair):
    return floquet.monodromy(floquet.gear_pair_system(pair, "relative"), 1e-11).matrix


@pytest.mark.parametrize("pair", [BASE, SMOOTH], ids=["jumps", "smooth"])
def test_linear_flow_map_is_the_floquet_matrix(pair):
    result = multibody.monodromy(pair, fidelity="linear")
    period = lumped.geometry(pair).mesh_period
    assert balanced_difference(result.matrix, floquet_matrix(pair), period) < 1e-8
    expected = floquet.gear_pair_multipliers(pair)
    assert result.spectral_radius == pytest.approx(expected.spectral_radius, rel=1e-8)
    # Its own Newton iteration finds the lumped periodic motion and the lumped balance again.
    steady = lumped.steady_state(pair, samples_per_cycle=8)
    assert result.brake_torque == pytest.approx(steady.attrs["brake_torque"], rel=1e-8)


def test_rigid_rotation_is_a_double_one_and_left_out():
    """The 12-state map has a defective double +1, split by the square root of the integration error."""
    result = multibody.monodromy(BASE, fidelity="linear")
    values = np.linalg.eigvals(result.full)
    assert np.sum(np.abs(values - 1) < 1e-4) == 2
    assert np.abs(result.multipliers - 1).min() > 1e-2


@pytest.mark.slow
def test_exact_flow_map_approaches_floquet_with_falling_torque():
    """Deflections change the geometry in proportion to torque, and the map with it: 16 times less at T/16."""
    difference = []
    for torque in (56.5, 56.5 / 4, 56.5 / 16):
        pair = SMOOTH.with_(operating__pinion_torque=torque)
        result = multibody.monodromy(pair, effects={"contact_loss": False})
        assert result.closure < 1e-7
        difference.append(
            balanced_difference(result.matrix, floquet_matrix(pair), lumped.geometry(pair).mesh_period)
        )
    # At full torque the next order still adds some per cent.
    assert difference[0] / difference[1] == pytest.approx(4, rel=0.1)
    assert difference[1] / difference[2] == pytest.approx(4, rel=0.05)
    assert difference[0] < 0.03


def growth(pair, cycles, size):
    """Rate per cycle at which a perturbed exact run leaves the periodic one, and both runs."""
    result = multibody.monodromy(pair)
    values, left = np.linalg.eig(result.matrix.T)
    column = left[:, np.argmax(np.abs(values))]
    _, right = np.linalg.eig(result.matrix)
    direction = np.real(result.lift @ right[:, np.argmax(np.abs(np.linalg.eigvals(result.matrix)))])
    direction *= size * np.abs(result.state[2]) / np.abs(direction[2])
    names = lumped.periodic_system(pair, "absolute").state_names
    runs = [
        multibody.simulate(pair, cycles, initial=state, rtol=1e-10, samples_per_cycle=8)
        for state in (result.state, result.state + direction)
    ]
    states = [np.stack([run[name].to_numpy()[::8] for name in names], axis=1) for run in runs]
    amplitude = np.abs((states[1] - states[0]) @ result.read.T @ column)
    rate = np.polyfit(np.arange(2, 18), np.log(amplitude[2:18]), 1)[0]
    return rate, runs


@pytest.mark.slow
def test_inside_the_main_tongue_a_perturbation_grows_at_the_floquet_rate_and_then_separates():
    predicted = np.log(floquet.gear_pair_multipliers(TONGUE).spectral_radius)
    assert predicted > 0.15
    rate, (periodic, perturbed) = growth(TONGUE, 60, 1e-4)
    assert rate == pytest.approx(predicted, rel=0.02)
    # The unperturbed run stays pressed; the perturbed one saturates where the teeth begin to separate.
    assert float(periodic["overlap"].min()) > 0
    assert float(perturbed["overlap"].min()) < 0
    swing = np.ptp(perturbed["dte"].to_numpy()[-80:])
    assert swing < 10 * float(np.abs(periodic["dte"]).mean())


@pytest.mark.slow
def test_outside_the_tongue_it_decays_at_the_floquet_rate():
    pair = TONGUE.with_(operating__pinion_speed=24000)
    predicted = np.log(floquet.gear_pair_multipliers(pair).spectral_radius)
    assert predicted < 0
    rate, _ = growth(pair, 20, 1e-2)
    assert rate == pytest.approx(predicted, rel=0.02)
