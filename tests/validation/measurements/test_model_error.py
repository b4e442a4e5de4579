"""The prediction against a record whose offset is known (ASME V&V 20-2009, eqs. 1-5-2 to 1-5-5)."""

import numpy as np
import pytest

import lumped
from lumped.errors import ParameterError
from lumped.outcomes import Absent, Outcome
from validation.measurements.model_error import ModelError, measured_peak_to_peak, model_error
from validation.measurements.record import Measurement, MeasurementSpec

PAIR = lumped.load_gear_pair("nasa_28_28")
#: Of the record: two waves, whose peak to peak is known, and noise [m].
AMPLITUDES, NOISE, CYCLES, SAMPLES = (2e-6, 0.5e-6), 0.1e-6, 40, 60.3
PHASES = np.arange(4096) / 4096


def wave(cycles):
    return sum(a * np.cos(2.0 * np.pi * m * cycles + m) for m, a in enumerate(AMPLITUDES, 1))


def record(offset=0.0, noise=NOISE, quantity="dte", seed=1, **changes):
    """A record of ``wave`` at the pair's own speed and torque, every amplitude larger by ``offset``."""
    cycles = np.arange(int(CYCLES * SAMPLES)) / SAMPLES
    values = (1.0 + offset) * wave(cycles + 0.3) + noise * np.random.default_rng(seed).normal(
        size=cycles.size
    )
    own = {
        "pinion_speed": repr(PAIR.operating.pinion_speed),
        "pinion_torque": PAIR.operating.pinion_torque,
    }
    spec = MeasurementSpec.model_validate(
        {
            "name": "two waves", "source": "computed", "data": "none.csv", **(own | changes),
            "abscissa": {"kind": "time", "column": "t", "unit": "s"},
            "channel": [{"name": "te", "column": "te", "quantity": quantity, "unit": "um"}],
        }
    )  # fmt: skip
    return Measurement(spec, cycles * PAIR.geometry.mesh_period, {"te": values}, {"te": None})


def test_the_error_is_the_offset_of_the_record():
    simulated = float(np.ptp(wave(PHASES)))
    found = model_error(record(offset=0.2), PAIR, simulated, 0.0, Absent(Outcome.NOT_ASKED))
    # S is 1 over 1.2 of D: E is negative. Noise leaves u_D, four of which hold all but 6e-5.
    assert found.error == pytest.approx(-0.2 * simulated, abs=4.0 * found.record)
    assert 0.0 < found.record < 0.03 * simulated
    assert not found.explained
    assert model_error(record(), PAIR, simulated, 0.1e-6, Absent(Outcome.NOT_ASKED)).explained


def test_the_uncertainty_of_the_record_is_the_scatter_of_repeated_records():
    found = [measured_peak_to_peak(record(seed=seed), PAIR) for seed in range(24)]
    sizes, stated = np.array(found).T
    # 24 values give a deviation to 15 %. Both extremes share errors, so the stated one is a bound.
    assert 0.3 * stated.mean() < sizes.std(ddof=1) < 1.3 * stated.mean()


def test_samples_at_other_phases_in_each_cycle_show_high_orders(monkeypatch):
    # 12 waves in a mesh cycle of 20.3 samples, fewer than two in a wave: phases fill in over the cycles.
    monkeypatch.setitem(globals(), "SAMPLES", 20.3)
    monkeypatch.setitem(globals(), "AMPLITUDES", (0.0,) * 11 + (1e-6,))
    size, _ = measured_peak_to_peak(record(noise=0.0), PAIR)
    assert size == pytest.approx(2e-6, rel=1e-3)  # 2048 phases miss an extreme by (12 pi/2048)^2/2 at most


def test_three_uncertainties_add_as_squares():
    found = ModelError(5e-6, 4e-6, numerical=1e-7, inputs=2e-7, record=2e-7)
    assert found.error == pytest.approx(1e-6)
    assert found.uncertainty == pytest.approx(3e-7)


@pytest.mark.parametrize(("changes", "match"), [
    ({"quantity": "x_p"}, "quantity dte"),
    ({"pinion_speed": "3000 rpm"}, "pinion_speed"),
    ({"pinion_torque": 80.0}, "pinion_torque"),
])  # fmt: skip
def test_a_record_of_something_else_is_refused(changes, match):
    with pytest.raises(ParameterError, match=match):
        measured_peak_to_peak(record(**changes), PAIR)
