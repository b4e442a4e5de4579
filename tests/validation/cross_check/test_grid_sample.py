"""Does the agreement hold for every preset, friction law and stiffness model, and scale as it should?

What finite motion adds is proportional to the deflections, so the difference between the models over the
size of the motion falls fourfold when the torque is quartered. A mistake in geometry, sign or load would
not fall at all, and noise would not fall regularly: the ratio is the tolerance. With relief the length of
contact depends on the torque, and teeth of the default pair part: flanks are without relief here.
"""

import numpy as np
import pytest

import lumped
import multibody

LAWS = ["coulomb", "benedict_kelley", "xu_kahraman", "smoothed_coulomb", "composite"]
STIFFNESS = {
    "rectangular": {"model": "rectangular"},
    "parabolic": {"model": "parabolic"},
    "smooth": {"model": "parabolic", "ramp_length": 2.0},
}
CYCLES, SAMPLES = 10, 64
PRESETS = lumped.preset_names()
#: Every preset with two laws, every law with two presets, jumps of stiffness and parabola; every preset with
#: one stiffness, and the default pair with all. The rest of the grid runs by ``spurcheck crosscheck --grid``.
WITH_LAWS = [
    (name, LAWS[(i + step) % 5], stiffness)
    for i, name in enumerate(PRESETS)
    for step, stiffness in ((0, "rectangular"), (2, "parabolic"))
]
WITH_STIFFNESS = {("nasa_28_28", name) for name in STIFFNESS}
WITH_STIFFNESS |= {(name, list(STIFFNESS)[i % 3]) for i, name in enumerate(PRESETS)}


def runs(pair, **options):
    shared = {"initial": "periodic", "samples_per_cycle": SAMPLES}
    return multibody.simulate(pair, CYCLES, **shared, **options), lumped.simulate(pair, CYCLES, **shared)


def difference(run, reference, name):
    return float(np.abs(run[name] - reference[name]).max() / np.ptp(reference[name].to_numpy()))


@pytest.mark.parametrize(("preset", "law", "stiffness"), WITH_LAWS)
def test_linear_level(preset, law, stiffness):
    """Two assemblies and two integrators of one set of equations."""
    pair = lumped.load_gear_pair(preset).with_(friction__law=law, mesh__stiffness=STIFFNESS[stiffness])
    run, reference = runs(pair, fidelity="linear")
    for name in ("dte", "x_p", "x_g", "y_p", "y_g", "theta_p", "theta_g", "normal_load", "friction_force"):
        assert difference(run, reference, name) < 1e-6, name


def steady_difference(pair):
    """Periodic motions compared, each with the brake torque that balances it: no transient, no drift."""
    run = multibody.steady_state(pair, samples_per_cycle=128, effects={"contact_loss": False})
    reference = lumped.steady_state(pair, samples_per_cycle=128)
    return {name: difference(run, reference, name) for name in ("dte", "x_p", "x_g", "theta_p", "theta_g")}


@pytest.mark.slow
@pytest.mark.parametrize(("preset", "stiffness"), sorted(WITH_STIFFNESS))
def test_exact_level_scales_with_torque(preset, stiffness):
    """Coulomb friction (a coefficient free of torque) at full and at a quarter of the preset's torque."""
    pair = lumped.load_gear_pair(preset).with_(
        mesh__relief="ignored",
        mesh__stiffness=STIFFNESS[stiffness],
        friction__law="coulomb",
        friction__coefficient=0.05,
    )
    torque = pair.operating.pinion_torque
    full, quarter = (
        steady_difference(pair.with_(operating__pinion_torque=share * torque)) for share in (1.0, 0.25)
    )
    for name, value in full.items():
        # The next order in torque is a share of the difference itself: some per cent.
        assert value / quarter[name] == pytest.approx(4.0, rel=0.08), name
        assert value < 0.15


def test_three_pairs_in_contact():
    """Unequal gears with high teeth, contact ratio 2.24: the same formulas, the same agreement."""
    pair = lumped.load_gear_pair("nasa_28_28").with_(
        pinion__teeth=50,
        gear__teeth=60,
        centre_distance=None,
        basic_rack__addendum_coefficient=1.3,
        basic_rack__dedendum_coefficient=1.6,
        basic_rack__fillet_radius_coefficient=0.2,
        mesh__relief="ignored",
        friction__law="coulomb",
        friction__coefficient=0.05,
    )
    assert lumped.geometry(pair).contact_ratio == pytest.approx(2.24, abs=0.01)
    linear, reference = runs(pair, fidelity="linear")
    assert linear.sizes["pair"] == 3
    assert float((linear["normal_load"] != 0).sum("pair").max()) == 3
    for name in ("dte", "x_p", "normal_load", "friction_force", "position"):
        assert difference(linear, reference, name) < 1e-6, name
    full, quarter = (
        steady_difference(pair.with_(operating__pinion_torque=torque)) for torque in (56.5, 56.5 / 4)
    )
    assert full["dte"] / quarter["dte"] == pytest.approx(4.0, rel=0.08)
    assert full["dte"] < 0.1


@pytest.mark.slow
@pytest.mark.parametrize("law", LAWS)
def test_exact_level_agrees_under_every_law(law):
    """Laws II, III and V depend on torque themselves, so only the size is bounded: some per cent at most."""
    pair = lumped.load_gear_pair("nasa_28_28").with_(friction__law=law, mesh__relief="ignored")
    for stiffness, limit in (("rectangular", 0.05), ("smooth", 0.005)):
        found = steady_difference(pair.with_(mesh__stiffness=STIFFNESS[stiffness]))
        assert 1e-5 < found["dte"] < limit
