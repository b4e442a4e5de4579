"""Is described data read with the right units, signs and order, and are unusable files refused by name?"""

import numpy as np
import pytest
import scipy.io
import tomli_w

from lumped.errors import ParameterError
from tests.validation.check.known_curves import PAIR, Known, rows
from validation.check.curves import ValuesOverSpeed
from validation.check.reading.reader import read

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
TEETH = PAIR.pinion.teeth


def description(**changes):
    return {
        "name": "record",
        "data": "record.csv",
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
def described(tmp_path):
    """Read a description beside a data file of text."""

    def reading(text=TEXT, **changes):
        data = {key: value for key, value in description(**changes).items() if value is not None}
        data["channel"] = [{k: v for k, v in c.items() if v is not None} for c in data["channel"]]
        if text is not None:
            (tmp_path / "record.csv").write_text(text)
        (tmp_path / "record.toml").write_text(tomli_w.dumps(data), encoding="utf-8")
        return read(tmp_path / "record.toml", PAIR)

    return reading


def channel(name, quantity, column, unit, **further):
    return {"name": name, "quantity": quantity, "column": column, "unit": unit} | further


def test_units_gain_and_zero_reach_si(described):
    record = described()
    assert (record.name, record.role, record.recurrence) == ("record", "measurement", None)
    assert record.pinion_speed == pytest.approx(800 * np.pi / 30, rel=1e-15)
    assert record.pinion_torque == 79.1
    np.testing.assert_allclose(record.places, 1e-3 * np.arange(10, 14, 0.5), rtol=1e-14)
    normal, friction = record.channels
    np.testing.assert_allclose(normal.values, np.arange(1500, 1580, 10), rtol=1e-14)
    # physical value = gain * (cell - zero): -1 * (0.05 - 0.05 ... 0.057 - 0.05) kN; atol: last digit of 57 N
    np.testing.assert_allclose(friction.values, -np.arange(8.0), atol=1e-12)
    assert (normal.noise, friction.noise) == (5.0, pytest.approx(2.0, rel=1e-14))
    assert (normal.name, normal.tooth_pair, friction.quantity) == ("normal", "A", "friction_force")


def test_sampling_rate_stands_for_a_time_column(described):
    record = described(abscissa={"kind": "sampled", "sampling_rate": "20 kHz"})
    np.testing.assert_allclose(record.places, np.arange(8) / 20e3, rtol=1e-15)


def test_separators_are_recognised_where_they_are_not_stated(described):
    stated = described()
    recognised = described(delimiter=None, decimal=None)
    for one, other in zip(stated.channels, recognised.channels, strict=True):
        np.testing.assert_array_equal(one.values, other.values)


ANY = Known()
NAMES = "s;dte;x acceleration\n"


@pytest.mark.parametrize(("abscissa", "places", "expected"), [
    ({"kind": "pinion_angle", "unit": "deg"}, 360.0 * ANY.s / TEETH, ANY.s),
    ({"kind": "gear_angle", "unit": "rad"}, 2.0 * np.pi * ANY.s / PAIR.gear.teeth, ANY.s),
    ({"kind": "mesh_phase", "unit": "rad"}, 2.0 * np.pi * ANY.s, ANY.s),
    ({"kind": "mesh_phase"}, ANY.s, ANY.s),
])  # fmt: skip
def test_angles_and_phases_become_mesh_cycles_and_every_quantity_is_known(
    described, abscissa, places, expected
):
    text = NAMES + rows(places, 1e6 * ANY.dte, ANY.x_p_ddot, delimiter=";", decimal=",")
    columns = [
        channel("te", "dte", "dte", "um"), channel("acc", "x_p_ddot", "x acceleration", "m/s^2"),
    ]  # fmt: skip
    model = described(
        text, role="model", source=None, pinion_speed=None, pinion_torque=None,
        abscissa=abscissa | {"column": "s"}, channel=columns,
    )  # fmt: skip
    assert (model.role, model.abscissa, model.pinion_speed) == ("model", "mesh_cycles", None)
    np.testing.assert_allclose(model.places, expected, rtol=1e-8, atol=1e-9)
    np.testing.assert_allclose(model.channels[0].values, ANY.dte, rtol=1e-8)
    np.testing.assert_allclose(model.channels[1].values, ANY.x_p_ddot, rtol=1e-8, atol=1e-6)


def test_values_over_speed(described):
    text = "n;pp;h2\n" + rows([3000.0, 1000.0], [5.0, 3.0], [1.5, 0.5], delimiter=";", decimal=",")
    columns = [
        channel("pp", "dte", "pp", "um", value="peak_to_peak"),
        channel("h2", "dte", "h2", "um", value="order", order=2),
    ]
    record = described(
        text, abscissa={"kind": "speed", "column": "n", "unit": "rpm"}, pinion_speed=None, channel=columns
    )
    assert isinstance(record, ValuesOverSpeed)
    np.testing.assert_allclose(record.speeds, np.array([1000.0, 3000.0]) * np.pi / 30, rtol=1e-12)
    assert [(one.statistic, one.order) for one in record.columns] == [("peak_to_peak", 0.0), ("order", 2.0)]
    np.testing.assert_allclose([one.values for one in record.columns], [[3e-6, 5e-6], [0.5e-6, 1.5e-6]])


def test_amplitudes_and_phases_over_order(described):
    text = "m;a;p\n" + rows([1, 3], [2.0, 0.5], [30.0, -90.0], delimiter=";", decimal=",")
    columns = [
        channel("a", "dte", "a", "um", part="amplitude"), channel("p", "dte", "p", "deg", part="phase"),
    ]  # fmt: skip
    record = described(text, abscissa={"kind": "order", "column": "m"}, channel=columns)
    phase = 2.0 * np.pi * record.places
    motion = 2e-6 * np.cos(phase + np.pi / 6) + 0.5e-6 * np.cos(3 * phase - np.pi / 2)
    np.testing.assert_allclose(record.channels[0].values, motion, atol=1e-14)


def test_data_of_another_kind_of_file(described, tmp_path):
    scipy.io.savemat(tmp_path / "run.mat", {"zeit": ANY.time * 1e3, "kanal_7": ANY.x_g * 1e6})
    record = described(
        None, data="run.mat", abscissa={"kind": "time", "column": "zeit", "unit": "ms"},
        channel=[channel("x", "x_g", "kanal_7", "um", gain=-1.0)],
    )  # fmt: skip
    np.testing.assert_allclose(record.channels[0].values, -ANY.x_g, rtol=1e-13)
    np.testing.assert_allclose(record.places, ANY.time, rtol=1e-13)


def changed_channel(place, **changes):
    channels = [dict(c) for c in description()["channel"]]
    channels[place] |= changes
    return {"channel": channels}


@pytest.mark.parametrize(("changes", "named"), [
    ({"pinion_speed": -5}, "pinion_speed"),
    ({"pinion_speed": None}, "pinion_speed = missing"),
    ({"source": None}, "source = missing"),
    ({"role": "record"}, "role"),
    ({"abscissa": {"kind": "time"}}, "abscissa"),
    ({"abscissa": {"kind": "sampled", "sampling_rate": "20 kg"}}, "sampling_rate"),
    ({"abscissa": {"kind": "pinion_angle", "column": "t", "unit": "ms"}}, "abscissa.unit"),
    (changed_channel(0, column="missing"), "missing"),
    (changed_channel(0, unit="m"), r"channel.normal: unit"),
    (changed_channel(0, unit=None), "unit"),
    ({"abscissa": {"kind": "time", "column": "t", "unit": "s", "sampling_rate": "2 Hz"}}, "sampling_rate"),
    (changed_channel(0, pair=None), "pair"),
    (changed_channel(0, gain=0.0), "gain"),
    (changed_channel(0, gain=1e308), "channel.normal"),
    (changed_channel(0, zero=-1e200), "channel.normal"),
    (changed_channel(0, value="rms"), "channel.normal.value"),
    (changed_channel(0, part="phase"), "channel.normal.part"),
    (changed_channel(0, order=2), "order"),
    (changed_channel(0, quantity="normal_lod"), "Did you mean 'normal_load'"),
    (changed_channel(1, name="normal"), "channel.name"),
    ({"delimeter": ";"}, "Did you mean 'delimiter'"),
    (changed_channel(0, colunm="N A"), r"channel\.0\.colunm .* Did you mean 'column'"),
    ({"abscissa": None}, "abscissa"),
    ({"decimal": ";"}, "decimal"),
    ({"data": None}, "the data file"),
    ({"data": "none.csv"}, "exists"),
])  # fmt: skip
def test_a_wrong_description_is_refused_by_field(described, changes, named):
    with pytest.raises(ParameterError, match=named):
        described(**changes)


@pytest.mark.parametrize(("old", "new", "named"), [
    ("11,5;1530,0", "11,5;", "an empty cell in row 4"),
    ("11,5;1530,0", "11,5;nan", "nan in row 4"),
    ("11,5;1530,0", "11,0;1530,0", "row 4 is not beyond"),
    ("13,5;1570,0;0,057\n", "", "8 rows"),
    ("1530,0", "abc", "abc in row 4 after the headings, column N A"),
    ("1530,0", "True", "True in row 4 after the headings, column N A"),
    ("1530,0", "0x10", "0x10 in row 4 after the headings, column N A"),
    ("N A", "F A [kN]", "a heading of one column"),
    ("t;N A;F A [kN]\n", "", "no headings"),
])  # fmt: skip
def test_a_bad_cell_is_refused_with_its_row(described, old, new, named):
    changes = changed_channel(0, column="F A [kN]") if new == "F A [kN]" else {}
    with pytest.raises(ParameterError, match=named):
        described(TEXT.replace(old, new), **changes)
