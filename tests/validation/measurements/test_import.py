"""Is a record read with the right units, signs and order, and are unusable files refused by name?"""

import numpy as np
import pytest

from lumped.errors import ParameterError
from lumped.outcomes import Absent, Outcome
from tests.unlike_pairs import unlike_pair
from validation.measurements import load_measurement
from validation.measurements.model_error import ModelError, measured_peak_to_peak, model_error
from validation.measurements.record import Measurement, MeasurementSpec

TEXT = """# strain-gauge record
t;N A;F A [kN]
10,0;1500,0;0,050
10,5;1510,0;0,051
11,0;1520,0;0,052
11,5;1530,0;0,053
12,0;1540,0;0,054
12,5;1550,0;0,055
13,0;1560,0;0,056
13,5;1570,0;0,057
"""


def description(data, **changes):
    return {
        "name": "record",
        "data": str(data),
        "source": "made up for a test",
        "delimiter": ";",
        "decimal": ",",
        "pinion_speed": 800,
        "pinion_torque": "79.1 N*m",
        "abscissa": {"kind": "time", "column": "t", "unit": "ms"},
        "channel": [
            {
                "name": "normal", "column": "N A", "quantity": "normal_load", "unit": "N", "pair": "A",
                "noise": 5.0,
            },
            {
                "name": "friction", "column": "F A [kN]", "quantity": "friction_force", "unit": "kN",
                "pair": "A", "gain": -1.0, "zero": 0.05, "noise": 0.002,
            },
        ],
    } | changes  # fmt: skip


@pytest.fixture
def csv(tmp_path):
    path = tmp_path / "record.csv"
    path.write_text(TEXT)
    return path


def test_units_gain_and_zero_reach_si(csv):
    record = load_measurement(description(csv))
    assert record.spec.pinion_speed == pytest.approx(800 * np.pi / 30, rel=1e-15)
    np.testing.assert_allclose(record.abscissa, 1e-3 * np.arange(10, 14, 0.5), rtol=1e-14)
    np.testing.assert_allclose(record.channels["normal"], np.arange(1500, 1580, 10), rtol=1e-14)
    # physical value = gain * (cell - zero): -1 * (0.05 - 0.05 ... 0.057 - 0.05) kN; atol: last digit of 57 N
    np.testing.assert_allclose(record.channels["friction"], -np.arange(8.0), atol=1e-12)
    assert record.noise == {"normal": 5.0, "friction": pytest.approx(2.0, rel=1e-14)}


def test_sampling_rate_stands_for_a_time_column(csv):
    sampled = description(csv, abscissa={"kind": "sampled", "sampling_rate": "20 kHz"})
    np.testing.assert_allclose(load_measurement(sampled).abscissa, np.arange(8) / 20e3, rtol=1e-15)


def changed_channel(place, **changes):
    channels = [dict(c) for c in description("")["channel"]]
    channels[place] |= changes
    return {"channel": channels}


@pytest.mark.parametrize(("changes", "named"), [
    ({"pinion_speed": -5}, "pinion_speed"),
    ({"abscissa": {"kind": "time"}}, "abscissa"),
    ({"abscissa": {"kind": "sampled", "sampling_rate": "20 kg"}}, "sampling_rate"),
    (changed_channel(0, column="missing"), "missing"),
    (changed_channel(0, unit="m"), "channel.normal.unit"),
    (changed_channel(0, unit=None), "unit"),
    ({"abscissa": {"kind": "time", "column": "t", "unit": "s", "sampling_rate": "2 Hz"}}, "sampling_rate"),
    (changed_channel(0, pair=None), "pair"),
    (changed_channel(0, gain=0.0), "gain"),
    (changed_channel(0, gain=1e308), "channel.normal"),
    (changed_channel(0, zero=-1e200), "channel.normal"),
    ({"recurrence": 10**400}, "recurrence"),
    (changed_channel(1, name="normal"), "channel.name"),
    ({"delimeter": ";"}, "Did you mean 'delimiter'"),
    (changed_channel(0, colunm="N A"), r"channel\.0\.colunm .* Did you mean 'column'"),
    ({"abscissa": None}, "abscissa = None"),
    ({"decimal": ";"}, "decimal"),
])  # fmt: skip
def test_a_wrong_description_is_refused_by_field(csv, changes, named):
    with pytest.raises(ParameterError, match=named):
        load_measurement(description(csv, **changes))


@pytest.mark.parametrize(("old", "new", "named"), [
    ("11,5;1530,0", "11,5;", "number"),
    ("11,5;1530,0", "11,5;nan", "row 4"),
    ("11,5;1530,0", "11,0;1530,0", "row 4"),
    ("13,5;1570,0;0,057\n", "", "8 rows"),
])  # fmt: skip
def test_a_bad_cell_is_refused_with_its_row(csv, old, new, named):
    csv.write_text(TEXT.replace(old, new))
    with pytest.raises(ParameterError, match=named):
        load_measurement(description(csv))


@pytest.mark.parametrize("cell", ["abc", "True", "0x10"])
def test_a_cell_that_is_no_number_is_named_by_value_row_and_column(tmp_path, cell):
    path = tmp_path / "record.csv"
    path.write_text(TEXT.replace("1530,0", cell))
    with pytest.raises(ParameterError, match=rf"data = {cell} in row 4 after the headings, column N A"):
        load_measurement(description(path))


PAIR = unlike_pair("larger_gear_drives_contact_lost")
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
    own = {"pinion_speed": repr(PAIR.operating.pinion_speed), "pinion_torque": PAIR.operating.pinion_torque}
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
