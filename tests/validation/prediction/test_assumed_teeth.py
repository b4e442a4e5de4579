"""Machines with teeth of an assumed class: probability of their range, and what the range may not do."""

import math

import numpy as np
import pytest
import xarray as xr

import lumped
from lumped.model.dynamic_factor import ASSUMED_TOLERANCE_CLASS, iso_dynamic_factor
from tests.unlike_pairs import known_sizes, unlike_pair
from validation.prediction import assumed_teeth as module
from validation.prediction.assumed_teeth import (
    REVOLUTION,
    WIDENED,
    assumed_teeth,
    has_range,
    quantiles,
    revolution_range,
    widened,
    with_assumed_class,
)
from validation.prediction.motion import Motion, measured, predicted, predicted_by_long_steps

#: The teeth of both gears push at all times. Everything is known but the torque.
PAIR = known_sizes(unlike_pair("rack_25_degrees_always_pushing")).with_(
    {"assumed": {}, "uncertainty": {"operating.pinion_torque": "+- 4 %"}}
)
SHARES = np.array([0.05, 0.5, 0.95])


def teeth_of(ratios: object, samples: int | None = None) -> xr.Dataset:
    """Machines with the same ratios of every result."""
    ratios = np.asarray(ratios, dtype=float)
    variables = {f"{name}_ratio": ("machine", ratios) for name in WIDENED}
    variables[REVOLUTION] = ("machine", 4e-5 * np.ones(ratios.size))
    return xr.Dataset(variables, attrs={"samples": ratios.size if samples is None else samples})


def samples_of(values: object) -> xr.Dataset:
    values = np.asarray(values, dtype=float)
    ends = np.percentile(values, [5.0, 50.0, 95.0])
    return xr.Dataset(
        dict.fromkeys(WIDENED, ("sample", values))
        | {f"{name}_percentile": ("percentile", ends) for name in WIDENED}
    )


def test_the_class_is_that_of_the_dynamic_factor_of_the_standard():
    drawn = with_assumed_class(PAIR)
    classes = {drawn.pinion.deviations.tolerance_class, drawn.gear.deviations.tolerance_class}
    assert classes == {iso_dynamic_factor(PAIR).tolerance_class} == {ASSUMED_TOLERANCE_CLASS}
    assert drawn.pinion.deviations.seed != drawn.gear.deviations.seed


def test_a_range_by_hand():
    """Table of Student's t: 2.920 for two degrees of freedom, 95 %; logarithms -0.1, 0, 0.1 have s = 0.1."""
    low, middle, high = np.log(quantiles(np.exp([-0.1, 0.0, 0.1]), SHARES))
    assert middle == pytest.approx(0.0, abs=1e-12)
    assert (low, high) == pytest.approx((-0.33717, 0.33717), rel=2e-4)


@pytest.mark.parametrize("machines", [3, 4, 8])
def test_one_more_machine_lies_in_the_range_nine_times_in_ten(machines):
    """Log-normal machines: 6000 ranges hold one more machine with 0.9 +- 3 times 0.0039 (binomial)."""
    values = np.exp(np.random.default_rng(5).normal(-2.0, 0.3, (6000, machines + 1)))
    ends = np.array([quantiles(row[:-1], SHARES[[0, 2]]) for row in values])
    inside = np.mean((ends[:, 0] <= values[:, -1]) & (values[:, -1] <= ends[:, 1]))
    assert inside == pytest.approx(0.9, abs=0.012)


@pytest.mark.parametrize("name", WIDENED)
@pytest.mark.parametrize("ratio", [0.7, 1.6])
def test_equal_ratios_move_one_end_alone(name, ratio):
    samples = samples_of(np.linspace(2.0, 3.0, 101))
    low, high = widened(samples, teeth_of([ratio] * 8), name)
    expected = (2.05, 2.95 * ratio) if ratio > 1.0 else (2.05 * ratio, 2.95)
    # The 5 % of a table of 64 equal columns lies within a sample's distance, 0.01, of the 5 % of a column.
    assert (low, high) == pytest.approx(expected, abs=0.011 * max(ratio, 1.0))


@pytest.mark.parametrize("seed", range(12))
def test_the_range_of_perfect_teeth_is_always_inside(seed):
    """Ratios about 1, mostly below or mostly above; few samples, whose percentiles interpolate."""
    rng = np.random.default_rng(seed)
    samples = samples_of(np.exp(rng.normal(1.0, 0.4, 16)))
    teeth = teeth_of(np.exp(rng.normal(rng.uniform(-0.3, 0.3), 0.1, 8)))
    for name in WIDENED:
        low, _, high = samples[f"{name}_percentile"].to_numpy()
        wide_low, wide_high = widened(samples, teeth, name)
        assert wide_low <= low
        assert wide_high >= high
        assert wide_high - wide_low > high - low


def test_ends_of_products_against_many_products():
    """Samples times drawn ratios, 400,000 of them, with the ratios cut at 1 on the other side."""
    rng = np.random.default_rng(3)
    values = np.exp(rng.normal(1.0, 0.3, 1024))
    ratios = np.exp(np.array([-0.2, -0.1, -0.05, 0.0, 0.02, 0.1, 0.15, 0.24]))
    low, high = widened(samples_of(values), teeth_of(ratios), "bearing_rms")
    logs = np.log(ratios)
    spread = logs.std(ddof=1) * math.sqrt(9.0 / 8.0)
    many = np.exp(logs.mean() + spread * rng.standard_t(7, 400_000))
    products = rng.choice(values, many.size)
    assert low == pytest.approx(np.percentile(products * np.minimum(many, 1.0), 5.0), rel=0.01)
    assert high == pytest.approx(np.percentile(products * np.maximum(many, 1.0), 95.0), rel=0.01)


def test_a_dynamic_factor_is_not_below_one():
    samples = samples_of(np.linspace(1.02, 1.1, 32))
    assert widened(samples, teeth_of([0.8] * 8), "dynamic_factor")[0] == 1.0
    assert widened(samples, teeth_of([0.8] * 8), "tooth_load")[0] < 0.9


@pytest.mark.parametrize("teeth", [teeth_of([1.5, 1.6]), teeth_of([1.5, math.nan, 1.6, 1.7])])
def test_too_few_machines_and_missing_ratios_change_nothing(teeth):
    samples = samples_of(np.linspace(2.0, 3.0, 32))
    low, _, high = samples["tooth_load_percentile"].to_numpy()
    assert widened(samples, teeth, "tooth_load") == (low, high)
    assert has_range(teeth) == (teeth.attrs["samples"] >= 3)


def test_inputs_as_given_differ_in_the_teeth_alone(monkeypatch):
    machines = list[lumped.GearPair]()
    monkeypatch.setattr(module, "_beside_twin", lambda one: machines.append(one) or [1e-5, 1, 1, 1, 0])
    teeth = assumed_teeth(PAIR, None, 8)
    assert {one.operating.pinion_torque for one in machines} == {PAIR.operating.pinion_torque}
    seeds = [(one.pinion.deviations.seed, one.gear.deviations.seed) for one in machines]
    assert len({*seeds}) == 8
    assert len({seed for both in seeds for seed in both}) == 16
    assert (teeth.attrs["inputs"], teeth.attrs["taken"], teeth.attrs["period"]) == (
        "as given", 8, math.lcm(PAIR.pinion.teeth, PAIR.gear.teeth),
    )  # fmt: skip
    swings = {"dte_peak_to_peak_swing": (("input", "end"), [[1.0, 2.0]])}
    varied = xr.Dataset(swings, {"input": ["operating.pinion_torque"]}, {"seed": 1})
    machines.clear()
    assert assumed_teeth(PAIR, varied, 8).attrs["inputs"] == "varied"
    torques = [one.operating.pinion_torque / PAIR.operating.pinion_torque for one in machines]
    assert len({*torques}) == 8
    assert 0.96 <= min(torques) < 0.99 < 1.01 < max(torques) <= 1.04


def test_without_time_there_is_no_range():
    teeth = assumed_teeth(PAIR, None, 8, 1e-9)
    assert (teeth.attrs["taken"], teeth.attrs["samples"], teeth.attrs["asked"]) == (0, 0, 8)
    assert not has_range(teeth)


def test_ratios_are_those_of_the_linear_motion():
    """Another form of the model, nearly equal where contact is kept."""
    machine = with_assumed_class(PAIR)
    swing, *ratios, lost = module._beside_twin(machine)
    drawn, perfect = (
        measured(one, lumped.steady_state(one, samples_per_cycle=512), Motion.LINEAR)
        for one in (machine, PAIR)
    )
    assert (lost, drawn.contact_lost) == (0.0, False)
    assert swing == pytest.approx(drawn.peak_to_peak, rel=0.02)
    assert drawn.peak_to_peak > 2.0 * perfect.peak_to_peak
    for name, ratio in zip(WIDENED, ratios, strict=True):
        assert ratio == pytest.approx(drawn.numbers[name] / perfect.numbers[name], rel=0.015), name
    # By the tolerances of the class: F_p of both gears, and the swing of a mesh cycle.
    allowed = sum(
        lumped.flank_tolerances(gear.teeth, PAIR.basic_rack.module, 6)["F_p"]
        for gear in (PAIR.pinion, PAIR.gear)
    )
    assert 0.3 * allowed < swing < 1.15 * allowed + perfect.peak_to_peak
    three = teeth_of([1.0] * 3).assign({REVOLUTION: ("machine", [swing, 1.1 * swing, 1.21 * swing])})
    low, middle, high = revolution_range(three)
    assert middle == pytest.approx(1.1 * swing)
    assert low < middle < high


@pytest.mark.parametrize("name", ["larger_gear_drives_contact_lost", "rack_25_degrees_always_pushing"])
def test_long_steps_change_little(name):
    """RK4 with a quarter of the steps: teeth that touch inside a step are what is left, 0.2 % of these."""
    machine = with_assumed_class(unlike_pair(name))
    exact = predicted(machine)
    rough = predicted_by_long_steps(machine, module.STEP_FACTOR)
    for result in WIDENED:
        assert rough.numbers[result] == pytest.approx(exact.numbers[result], rel=5e-3), result
    assert rough.peak_to_peak == pytest.approx(exact.peak_to_peak, rel=1e-3)
    assert rough.peak_to_peak != exact.peak_to_peak  # the steps are longer
    assert rough.contact_lost is exact.contact_lost
