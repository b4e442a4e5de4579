"""Does the agreement hold for every preset, friction law and stiffness model, and scale as it should?

What finite motion adds is proportional to the deflections, so the difference between the models over the
size of the motion falls fourfold when the torque is quartered. A mistake in geometry, sign or load would
not fall at all, and noise would not fall regularly: the ratio is the tolerance.
"""

from __future__ import annotations

import numpy as np
import pytest

import lumped
import multibody

PRESETS = ["nasa_28_28", "nasa_art_25_31", "kahraman_blankenship_50_50", "fzg_c"]
LAWS = ["coulomb", "benedict_kelley", "xu_kahraman", "smoothed_coulomb", "composite"]
STIFFNESS = {
    "rectangular": {"model": "rectangular"},
    "parabolic": {"model": "parabolic"},
    "smooth": {"model": "parabolic", "ramp_length": 2.0},
}
CYCLES, SAMPLES = 10, 64


def runs(pair, **options):
    shared = {"initial": "periodic", "samples_per_cycle": SAMPLES}
    return multibody.simulate(pair, CYCLES, **shared, **options), lumped.simulate(pair, CYCLES, **shared)


def difference(run, reference, name):
    return float(np.abs(run[name] - reference[name]).max() / np.ptp(reference[name].to_numpy()))


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("preset", PRESETS)
def test_linear_level(preset, law):
    pair = lumped.load_gear_pair(preset).with_(friction__law=law)
    run, reference = runs(pair, fidelity="linear")
    for name in ("dte", "x_p", "x_g", "theta_p", "theta_g", "normal_load"):
        assert difference(run, reference, name) < 1e-6, name


def steady_difference(pair):
    """Periodic motions compared, each with the brake torque that balances it: no transient, no drift."""
    run = multibody.steady_state(pair, samples_per_cycle=128, effects={"contact_loss": False})
    reference = lumped.steady_state(pair, samples_per_cycle=128)
    return {name: difference(run, reference, name) for name in ("dte", "x_p", "x_g", "theta_p", "theta_g")}


@pytest.mark.slow
@pytest.mark.parametrize("stiffness", STIFFNESS)
@pytest.mark.parametrize("preset", PRESETS)
def test_exact_level_scales_with_torque(preset, stiffness):
    """Coulomb friction (a coefficient free of torque) at full and at a quarter of the preset's torque."""
    pair = lumped.load_gear_pair(preset).with_(
        friction__law="coulomb", friction__coefficient=0.05, mesh__stiffness=STIFFNESS[stiffness]
    )
    torque = pair.operating.pinion_torque
    full, quarter = (
        steady_difference(pair.with_(operating__pinion_torque=share * torque)) for share in (1.0, 0.25)
    )
    for name, value in full.items():
        # The next order in torque is a share of the difference itself: some per cent.
        assert value / quarter[name] == pytest.approx(4.0, rel=0.08), name
        assert value < 0.15


@pytest.mark.slow
@pytest.mark.parametrize("law", LAWS)
def test_exact_level_agrees_under_every_law(law):
    """Laws II, III and V depend on torque themselves, so only the size is bounded: some per cent at most."""
    pair = lumped.load_gear_pair("nasa_28_28").with_(friction__law=law)
    for stiffness, limit in (("rectangular", 0.05), ("smooth", 0.005)):
        found = steady_difference(pair.with_(mesh__stiffness=STIFFNESS[stiffness]))
        assert 1e-5 < found["dte"] < limit
