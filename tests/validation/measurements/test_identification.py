"""Does alignment find the phase and identification the friction, when the truth is known?"""

import dataclasses

import numpy as np
import pytest

from lumped import simulate
from lumped.errors import NumericalError, ParameterError
from tests.unlike_pairs import unlike_pair
from tests.validation.measurements.synthetic import synthetic_measurement
from validation.measurements import evaluate, predict
from validation.measurements.comparison import align, mesh_cycles, overlay
from validation.measurements.identification import identify_friction
from validation.plots.of_result import plot

MU = 0.05


@pytest.fixture(scope="module")
def pair():
    return unlike_pair("rack_25_degrees_always_pushing").with_(
        mesh__contact="prescribed", operating__pinion_speed=800, friction__maximum=None
    )


@pytest.fixture(scope="module")
def truth(pair):
    return predict(pair.with_(friction__law="coulomb", friction__coefficient=MU), recurrence=3)


def record(truth, scale=1.0, stated_noise=True, **changes):
    """A synthetic record, with a factor on the friction."""
    settings = {"seed": 5, "engagements": 4, "noise_normal": 0.0, "noise_friction": 0.0} | changes
    made = synthetic_measurement(truth, **settings)
    friction = {name: scale * made.channels[name] for name, _ in made.named("friction_force")}
    noise = {n: scale * v if v and n in friction else v for n, v in made.noise.items()}
    noise = noise if stated_noise else dict.fromkeys(noise)
    return dataclasses.replace(made, channels=made.channels | friction, noise=noise)


def test_prediction_follows_a_tooth_pair_through_a_transient(pair):
    # Independent of the labelling code: a settled transient, in which the pair that enters in cycle j is
    # slot n # during cycle j and slot n - 1 during cycle j + 1.
    prediction = predict(pair, recurrence=2)
    run = simulate(pair, 2, samples_per_cycle=1024, initial="periodic")
    u = run["time"].to_numpy()[:-1] / prediction.geometry.mesh_period
    first = np.where(u < 1.0, run["normal_load"].to_numpy()[1, :-1], run["normal_load"].to_numpy()[0, :-1])
    # 1e-6: the transient's tolerance is 1e-10, the periodic start is good to better than 1e-8
    np.testing.assert_allclose(
        prediction.value("normal_load", u, "A"), first, atol=1e-6 * first.max(), rtol=0
    )
    np.testing.assert_array_equal(prediction.contact(u, "A"), u < prediction.geometry.contact_ratio)
    np.testing.assert_allclose(prediction.value("normal_load", u + 1.0, "B"), first, atol=1e-6 * first.max())


def test_times_are_mesh_cycles_at_the_speed_of_the_record(truth):
    other = truth.pair.with_(speed=3 * 800)
    expected = record(truth).abscissa / truth.geometry.mesh_period
    np.testing.assert_allclose(mesh_cycles(record(truth), other), expected, rtol=1e-14)


@pytest.mark.parametrize("start", [0.0, 0.37, 1.9, 2.75])
def test_alignment_finds_an_unknown_start(truth, start):
    found = align(record(truth, start=start, noise_normal=0.02), truth)
    away = (found.shift - start + 1.5) % 3.0 - 1.5
    # The sampled jumps fix the phase to a fraction of the sample spacing, 1/100 cycle.
    assert abs(away) < 2e-3


def test_the_standard_error_of_the_phase_is_the_spread_of_the_phases(truth):
    starts = np.random.default_rng(4).uniform(0.0, 3.0, 20)
    noisy = [record(truth, start=u, noise_normal=0.02, seed=j) for j, u in enumerate(starts)]
    found = [align(one, truth) for one in noisy]
    away = (np.array([one.shift for one in found]) - starts + 1.5) % 3.0 - 1.5
    # 20 phases know their spread to 16 %; 50 % is three of those.
    assert np.mean([one.standard_error for one in found]) == pytest.approx(away.std(), rel=0.5)


def test_alignment_does_not_take_a_calibration_error_for_a_phase(truth):
    clean = record(truth, start=0.6)
    wrong = dataclasses.replace(clean, channels={k: 1.2 * v + 30.0 for k, v in clean.channels.items()})
    found = align(wrong, truth)
    assert found.shift == pytest.approx(0.6, abs=2e-3)
    assert found.share_explained > 0.999


def test_alignment_refuses_a_record_that_does_not_fit(truth):
    rng = np.random.default_rng(3)
    clean = record(truth).channels
    for offset in (0.0, 1e3):  # a mean explains nothing
        noise = {k: offset + rng.standard_normal(v.size) for k, v in clean.items()}
        with pytest.raises(NumericalError, match="explains only"):
            align(dataclasses.replace(record(truth), channels=noise), truth)
    # The other sign of the friction, which jumps at the pitch point: at no phase is it the prediction.
    made = record(truth)
    spec = made.spec.model_copy(update={"channel": made.spec.channel[1:2]})
    assert spec.channel[0].name == "friction_A"
    turned = dataclasses.replace(made, spec=spec, channels={"friction_A": -clean["friction_A"]})
    with pytest.raises(NumericalError, match="explains only"):
        align(turned, truth)


def without_normal_loads(made):
    spec = made.spec.model_copy(
        update={"channel": tuple(c for c in made.spec.channel if c.quantity == "friction_force")}
    )
    return dataclasses.replace(made, spec=spec)


@pytest.mark.parametrize("normal", ["measured", "predicted"])
def test_without_noise_the_truth_comes_back(truth, normal):
    clean = record(truth, start=1.3)
    measured = clean if normal == "measured" else without_normal_loads(clean)
    found = identify_friction(measured, truth, align(clean, truth, shift=1.3))
    assert found.normal == normal
    # One sample from the pitch point F = mu N holds through the linear interpolation of the prediction.
    assert found.estimate == pytest.approx(MU, rel=1e-9 if normal == "measured" else 2e-3)
    assert found.standard_error < 1e-3 * MU


def test_the_interval_is_that_of_students_t_over_engagements(truth):
    for engagements in (2, 4):
        noisy = record(truth, noise_friction=0.02, engagements=engagements)
        found = identify_friction(noisy, truth, align(noisy, truth, shift=0.0))
        assert found.blocks == 8  # four engagements of two pairs; two are cut into eight runs of samples
    reach = 2.3646 * found.standard_error  # t of 7 degrees of freedom, 97.5 %
    np.testing.assert_allclose([found.estimate - found.low, found.high - found.estimate], reach, rtol=5e-3)


def test_noise_on_the_load_biases_plain_least_squares_but_not_the_weighted_one(truth):
    # Plain least squares: E[estimate] = mu <N^2> / (<N^2> + sigma_N^2), here with sigma_N = 20 % of T_p/r_bp.
    how = {"noise_normal": 0.2, "engagements": 60, "noise_friction": 0.02, "seed": 11}
    found = {}
    for stated in (True, False):
        noisy = record(truth, stated_noise=stated, **how)
        found[stated] = identify_friction(noisy, truth, align(noisy, truth, shift=0.0))
    load = truth.pair.operating.pinion_torque / truth.geometry.base_radius_pinion
    phases = np.linspace(0, truth.geometry.contact_ratio, 20001)[:-1]
    mean_square = float(np.mean(truth.value("normal_load", phases, "A") ** 2))
    expected = MU * mean_square / (mean_square + (0.2 * load) ** 2)
    assert expected < 0.96 * MU  # the effect is there to be seen
    # 19700 samples: standard errors near 0.2 %, so 4 of them
    assert found[False].estimate == pytest.approx(expected, abs=4 * found[False].standard_error)
    assert found[True].estimate == pytest.approx(MU, abs=4 * found[True].standard_error)
    assert found[True].standard_error < 0.005 * MU


TWO_PERCENT = {"noise_normal": 0.02, "noise_friction": 0.02}


def coverage(pair, law, noise, seeds, scale=1.3):
    """Estimates and standard errors over the truth for many noise seeds, and which intervals hold it.

    Every record starts at an unknown mesh phase and is aligned by its normal loads against a prediction with
    the wrong friction, as a user's would be.
    """
    constant = {"friction.law": "coulomb", "friction.coefficient": MU}
    truth = predict(pair.with_(constant if law == "coulomb" else {"friction.law": law}), recurrence=4)
    guess = predict(pair.with_(constant | {"friction.coefficient": 0.5 * MU}), recurrence=4)
    factor, value = (1.0, MU) if law == "coulomb" else (scale, scale)
    found = []
    for seed in range(seeds):
        start = float(np.random.default_rng([seed, 1]).uniform(0.0, 4.0))
        made = record(truth, **({"seed": seed, "start": start, "scale": factor} | TWO_PERCENT | noise))
        found.append(
            identify_friction(made, guess, align(made, guess), law=None if law == "coulomb" else law)
        )
    estimates = np.array([one.estimate for one in found]) / value
    errors = np.array([one.standard_error for one in found]) / value
    return estimates, errors, np.array([one.low <= value <= one.high for one in found])


TEN_PERCENT = {"noise_normal": 0.1, "noise_friction": 0.1}


@pytest.mark.slow
@pytest.mark.parametrize(("law", "noise"), [
    ("coulomb", {}), ("coulomb", {"correlation": 0.97}), ("coulomb", TEN_PERCENT), ("xu_kahraman", {}),
], ids=["white noise 2 %", "correlated noise", "noise 10 %", "scale on law III"])  # fmt: skip
def test_interval_covers_the_truth(pair, law, noise):
    estimates, errors, holds = coverage(pair, law, noise, seeds=40)
    # A correct 95 % interval covers 34 to 40 times out of 40 with probability 0.99.
    assert holds.sum() >= 34
    # Bias: three standard errors of the mean, and half a percent at most whatever the noise.
    spread = estimates.std(ddof=1)
    assert abs(estimates.mean() - 1.0) < min(3.5 * spread / np.sqrt(40), 5e-3)
    # 40 estimates know their own spread to 11 %; 35 % is three of those.
    assert errors.mean() == pytest.approx(spread, rel=0.35)


def test_a_record_at_another_speed_and_torque_identifies_the_friction_that_made_it(truth, pair):
    # Predicted with another law, speed and torque: both come from the record, and the constant does not
    # follow the prediction's friction.
    other = pair.with_(operating__pinion_speed=4000, operating__pinion_torque=30, friction__law="xu_kahraman")
    found = evaluate(record(truth, noise_normal=0.02, noise_friction=0.02, start=0.4), other, identify=["mu"])
    (mu,) = found.found
    # Five standard errors: a right estimate misses by more once in two million records.
    assert abs(mu.estimate - MU) < 5 * mu.standard_error < 0.1 * MU
    assert found.points["correlation"].sel(channel="normal_A") > 0.99
    assert found.points["relative_rms"].sel(channel="friction_A") > 0.08  # four times the noise
    assert plot(found.points).axes[0].get_ylabel() == "normal_A [kN]"
    smooth = evaluate(record(truth), other.with_(friction__law="none"))
    assert np.isnan(smooth.points["relative_rms"].sel(channel="friction_A"))
    with pytest.raises(ParameterError, match="xu_kahraman"):
        evaluate(record(truth), other, identify=["sandpaper"])


def test_overlay_metrics_know_a_constant_offset(truth):
    clean = record(truth)
    shifted = dataclasses.replace(clean, channels={k: v + 12.0 for k, v in clean.channels.items()})
    band = overlay(shifted, truth, align(shifted, truth, shift=0.0), bins=16)
    for name in ("bias", "rms"):
        np.testing.assert_allclose(band[name], 12.0, rtol=1e-9)
    np.testing.assert_allclose(band["correlation"], 1.0, atol=1e-12)
    span = np.ptp(truth.value("friction_force", np.linspace(0.0, 2.0, 2048, endpoint=False), "A"))
    assert float(band["relative_rms"].sel(channel="friction_A")) == pytest.approx(12.0 / span)
    np.testing.assert_allclose((band["measured"] - band["predicted"]).to_numpy(), 12.0, rtol=1e-9)
    np.testing.assert_allclose(band["scatter"], 0.0, atol=1e-4)  # difference of squares of 12 N in doubles


def test_arguments_that_cannot_be_used_are_refused(truth):
    clean = record(truth)
    phase = align(clean, truth, shift=0.0)
    with pytest.raises(ParameterError):
        identify_friction(clean, truth, phase, law="unknown")
    for shift in (np.nan, np.inf, 1e300):
        with pytest.raises(ParameterError, match="shift"):
            align(clean, truth, shift=shift)
    far = dataclasses.replace(clean, abscissa=clean.abscissa * 1e20)
    with pytest.raises(ParameterError, match="abscissa"):
        align(far, truth)
    with pytest.raises(NumericalError, match="in contact"):
        identify_friction(clean, truth, dataclasses.replace(phase, standard_error=1.0))
    early = dataclasses.replace(clean, abscissa=clean.abscissa * 1e-6)  # all of it within pair A's contact
    with pytest.raises(NumericalError, match="normal_B is in contact"):
        overlay(early, truth, align(early, truth, shift=0.0))
    with pytest.raises(ParameterError, match="recurrence"):
        predict(truth.pair, recurrence=1)
