"""Is the range of speeds of charts read as a user writes it, kept, and refused where it can be none?"""

import math

import pytest

from lumped import ParameterError, load_gear_pair
from lumped.schema.pair import stated_unit

RPM = math.pi / 30.0


@pytest.mark.parametrize("written", [
    "600..3000",
    "600 .. 3000 rpm",
    "10..50 Hz",
    "600 1/min..50 Hz",
    "6e2..3.0e3",
    [600, 3000],
    ("600 rpm", "50 Hz"),
    ["62.83185307179586 rad/s", 3000.0],
])  # fmt: skip
def test_as_people_write_it(nasa, written):
    pair = nasa.with_(operating__speed_range=written)
    low, high = pair.operating.speed_range
    assert (low, high) == pytest.approx((600.0 * RPM, 3000.0 * RPM), rel=1e-14)
    assert low.unit == high.unit == "rad/s"
    assert nasa.with_(operating__speed_range=pair.operating.speed_range) == pair
    assert load_gear_pair(pair.to_mapping()) == pair


def test_a_file_holds_it_and_none_is_the_default(nasa, tmp_path):
    assert nasa.operating.speed_range is None
    pair = nasa.with_(operating__speed_range="200..3000")
    path = tmp_path / "pair.toml"
    path.write_text(pair.to_toml(), encoding="utf-8")
    assert load_gear_pair(path).operating == pair.operating
    assert pair.with_(operating__speed_range=None).operating == nasa.operating
    assert stated_unit("operating.speed_range") == "rpm"


@pytest.mark.parametrize(("written", "message"), [
    ("200", "two increasing values FROM..TO"),
    ("200..300..400", "two increasing values FROM..TO"),
    ("3000..200", "two increasing values FROM..TO"),
    ("3000..3000", "two increasing values FROM..TO"),
    ([1, 2, 3], "two increasing values FROM..TO"),
    (5, "two increasing values FROM..TO"),
    ("200..300000", "<= 200000 rpm"),
    ("0..300", "> 0 rpm"),
    ("200,5..300", "write '200.5'"),
    ("50..60 mm", "not a rotational speed"),
    ("..300", "has no number"),
])  # fmt: skip
def test_what_is_no_range_is_refused_by_name(nasa, written, message):
    with pytest.raises(ParameterError) as refusal:
        nasa.with_(operating__speed_range=written)
    assert "operating.speed_range" in str(refusal.value)
    assert message in str(refusal.value)
