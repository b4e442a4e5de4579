"""Is a record read with the right units, signs and order, and are unusable files refused by name?"""

import numpy as np
import pytest

from lumped.errors import ParameterError
from validation.measurements import load_measurement

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
