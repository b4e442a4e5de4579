"""Does a stated power give the torque, at the speed of the file, and only there?"""

from __future__ import annotations

import copy
import math
import tomllib

import pytest

import lumped
from lumped.errors import ParameterError
from tests.unlike_pairs import unlike_pair
from validation.exchange import new_pair


@pytest.fixture(params=["rack_25_degrees_always_pushing", "larger_gear_drives_contact_lost"])
def pair(request: pytest.FixtureRequest) -> lumped.GearPair:
    return unlike_pair(request.param)


@pytest.mark.parametrize(("power", "watts"), [
    (5, 5000.0), ("5 kW", 5000.0), ("750 W", 750.0), ("10 hp", 7456.998715822702),
])  # fmt: skip
def test_power_over_speed_is_the_torque(pair: lumped.GearPair, power: str, watts: float) -> None:
    """P = T omega; one mechanical horsepower is 550 ft lbf/s."""
    loaded = pair.with_(power=power)
    assert loaded.operating.pinion_torque * loaded.operating.pinion_speed == pytest.approx(watts, rel=1e-12)
    assert loaded.operating.pinion_speed == pair.operating.pinion_speed
    assert loaded.operating.pinion_power.to("kW") == pytest.approx(1e-3 * watts, rel=1e-12)


def test_speed_and_power_of_one_request_belong_together(pair: lumped.GearPair) -> None:
    both = pair.with_(speed=1234, power="3 kW")
    assert both.operating.pinion_torque == pytest.approx(3000.0 / (1234 * math.pi / 30.0), rel=1e-12)
    assert pair.with_(power="3 kW", speed=1234) == both


def test_the_torque_stays_where_the_speed_is_varied(pair: lumped.GearPair) -> None:
    loaded = pair.with_(power="3 kW")
    rpm = 0.5 * loaded.operating.pinion_speed.to("rpm")
    for other in (loaded.with_(speed=rpm), loaded.at_speed(rpm)):
        assert other.operating.pinion_torque == loaded.operating.pinion_torque
        assert other.operating.pinion_power == pytest.approx(1500.0, rel=1e-9)


def test_a_file_with_a_power_is_read_and_written_back(pair: lumped.GearPair) -> None:
    data = copy.deepcopy(pair.to_mapping())
    torque = data["operating"].pop("pinion_torque")
    speed = pair.operating.pinion_speed
    data["operating"]["pinion_power"] = 1e-3 * pair.operating.pinion_torque * speed
    by_power = lumped.load_gear_pair(data)
    assert by_power.operating.pinion_torque == pytest.approx(pair.operating.pinion_torque, rel=1e-12)
    assert lumped.load_gear_pair(tomllib.loads(by_power.to_toml())) == by_power
    assert "pinion_power" not in by_power.to_mapping()["operating"]
    assert "operating.pinion_power" not in by_power.assumed
    data["operating"]["pinion_torque"] = torque
    with pytest.raises(ParameterError, match=r"operating\.pinion_power.*without pinion_torque"):
        lumped.load_gear_pair(data)


@pytest.mark.parametrize(("power", "words"), [
    (0, "0 kW: allowed > 0 kW"), (-2, "-2 kW: allowed > 0 kW"), (2e10, "<= 1e.10 kW"),
    ("5 N*m", "is not a power"), ("much", "has no number"), (math.nan, "allowed > 0 kW"), (True, "allowed"),
])  # fmt: skip
def test_a_power_that_is_none_is_refused_by_its_name(
    pair: lumped.GearPair, power: object, words: str
) -> None:
    with pytest.raises(ParameterError, match=words) as refused:
        pair.with_(power=power)
    names = {problem.field for problem in refused.value.problems}
    assert "operating.pinion_power" in names


def test_the_later_one_of_torque_and_power_counts_and_both_at_once_are_refused(pair: lumped.GearPair) -> None:
    assert pair.with_(power="5 kW").with_(torque=33).operating.pinion_torque == 33.0
    assert pair.with_(torque=33).with_(power="5 kW") == pair.with_(power="5 kW")
    with pytest.raises(ParameterError, match="Leave one of them out"):
        pair.with_(power="5 kW", torque=33)


def test_a_new_pair_of_a_power_is_that_of_its_torque() -> None:
    """The assumed bearings too, which follow from the torque."""
    drawing = {"module": 2.5, "face_width": 20, "speed": 1450}
    torque = float(f"{4000.0 / (1450 * math.pi / 30.0):.15g}")
    by_power = new_pair("19/41", **drawing, power="4 kW")
    assert by_power == new_pair("19/41", **drawing, torque=torque)
    assert dict(by_power.sources)["operating.pinion_torque"] == "given by the user"
    with pytest.raises(ParameterError, match="torque = missing"):
        new_pair("19/41", **drawing)


def test_the_schema_asks_for_one_of_both() -> None:
    section = lumped.json_schema()["$defs"]["OperatingPoint"]
    assert section["oneOf"] == [{"required": ["pinion_torque"]}, {"required": ["pinion_power"]}]
    assert section["required"] == ["pinion_speed"]
    assert section["properties"]["pinion_power"]["unit"] == "kW"
