"""Are shafts refused that no machine has, each by its field? Do pairs without shafts stay as they were?"""

import pytest

from lumped import ParameterError
from lumped.schema.files import preset_text


@pytest.fixture(scope="module")
def pair(nasa, shaft_tables):
    return nasa.with_(shafts=shaft_tables)


@pytest.mark.parametrize(("changes", "field", "allowed"), [
    ({"shafts.pinion.gear_position": 271}, "shafts.pinion.gear_position", "from 0 to 270.3 mm"),
    ({"shafts.gear.bearings.0.position": 151}, "shafts.gear.bearings.0.position", "from 0 to 150 mm"),
    ({"shafts.motor.position": 271}, "shafts.motor.position", "from 0 to 270.3 mm"),
    ({"shafts.load.position": 151}, "shafts.load.position", "from 0 to 150 mm"),
    ({"shafts.pinion.segments.1.bore": 28.3}, "shafts.pinion.segments.1.bore", "a wall of 1%"),
    ({"shafts.pinion.bearings": []}, "shafts.pinion.bearings", "at least 1 item"),
    ({"shafts.gear.bearings.0.tilt_stiffness": 0}, "shafts.gear.bearings", "two bearings at least"),
    ({"shafts.pinion.bearings.1.position": 30.1}, "shafts.pinion.bearings", "two bearings at least"),
    ({"shafts.gear.segments.0.diameter": 0.1}, "shafts.gear.segments", "length over diameter"),
    ({"shafts.pinion": None}, "shafts.pinion", "the pinion's shaft"),
    ({"shafts.pinion.segments": 30}, "shafts.pinion.segments", "a list of tables"),
    ({"shafts.pinion.segments": [30]}, "shafts.pinion.segments.0", "a table of keys and values"),
])  # fmt: skip
def test_no_shaft_at_all(pair, changes, field, allowed):
    with pytest.raises(ParameterError) as caught:
        pair.with_(changes)
    (problem,) = caught.value.problems
    assert problem.field == field
    assert allowed in problem.allowed
    assert problem.value
    assert problem.action


def test_pairs_without_shafts_have_no_word_of_them(nasa):
    assert nasa.shafts is None
    assert "shafts" not in nasa.to_toml()
    assert "shafts" not in preset_text("nasa_28_28")
