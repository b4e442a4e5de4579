"""Does a tabulated stiffness come back, per pair and in total, and is a wrong table refused?"""

import numpy as np
import pytest

from lumped import GearPair, ParameterError, geometry, load_gear_pair
from lumped.fields.tables import read_columns
from lumped.path_of_contact import pair_stiffness
from lumped.stiffness.table import STIFFNESS


def curve(xi, g):
    """A smooth pair stiffness [N/m]."""
    return 8e7 * (1.0 - 0.3 * ((xi - g.L_XP) / (g.L_XD - g.L_XA)) ** 2 + 0.02 * np.sin(xi / 1e-3))


def periodic(xi, g):
    """A smooth total stiffness with the period of a mesh cycle [N/m]."""
    turn = 2 * np.pi * (xi - g.L_XA) / g.base_pitch
    return 1.4e8 + 2e7 * np.cos(turn) + 5e6 * np.sin(3 * turn)


def pair_with(**table):
    return load_gear_pair("nasa_28_28").with_(mesh__stiffness={"model": "table", **table})


def pair_table(points, axis="position_mm", **more):
    g = geometry(load_gear_pair("nasa_28_28"))
    xi = np.linspace(g.L_XA, g.L_XD, points)
    place = {
        "position_mm": xi * 1e3,
        "roll_angle_deg": np.rad2deg(xi / g.base_radius_pinion),
        "phase": (xi - g.L_XA) / g.base_pitch,
    }[axis]
    return pair_with(axis=axis, points=place.tolist(), stiffness=curve(xi, g).tolist(), **more)


@pytest.mark.parametrize("axis", ["position_mm", "roll_angle_deg", "phase"])
def test_every_axis_gives_the_same_curve(axis):
    pair = pair_table(41, axis)
    g = geometry(pair)
    xi = np.linspace(g.L_XA, g.L_XD, 41)
    assert pair_stiffness(pair)(xi) == pytest.approx(curve(xi, g), rel=1e-9)  # interpolation meets its points
    assert pair_stiffness(pair).switches.size == 0


@pytest.mark.parametrize(("interpolation", "order"), [("monotone", 2.0), ("cubic", 4.0)])
def test_order_of_interpolation(interpolation, order):
    g = geometry(load_gear_pair("nasa_28_28"))
    xi = np.linspace(g.L_XA, g.L_XD, 3001)[1:-1]
    errors = []
    for points in (81, 161):
        pair = pair_table(points, interpolation=interpolation)
        errors.append(np.abs(pair_stiffness(pair)(xi) - curve(xi, g)).max())
    # Monotone interpolation falls to second order at the curve's own extremes.
    assert np.log2(errors[0] / errors[1]) > order - 0.5


def total_pair(phase, **more):
    pair = load_gear_pair("nasa_28_28")
    g = geometry(pair)
    total = periodic(g.L_XA + phase * g.base_pitch, g)
    return pair_with(kind="total", axis="phase", points=phase.tolist(), stiffness=total.tolist(), **more)


SAMPLINGS = {
    "one period, open": np.arange(60) / 60,
    "one period, closed": np.linspace(0.0, 1.0, 61),
    "two periods, shifted": np.linspace(-0.3, 1.7, 121),
    "uneven": np.sort(np.mod(0.618033988749895 * np.arange(120), 1.0)),
}


@pytest.mark.parametrize("phase", SAMPLINGS.values(), ids=SAMPLINGS.keys())
@pytest.mark.parametrize("ramp", [0.0, 0.8])
def test_pairs_add_up_to_the_total_at_any_sampling(phase, ramp):
    pair = total_pair(phase, interpolation="cubic", ramp_length=ramp)
    g = geometry(pair)
    k = pair_stiffness(pair)
    tau = np.linspace(0.0, g.base_pitch, 501)[1:-1]
    total = sum(k(g.L_XA + i * g.base_pitch + tau) for i in range(g.pairs))
    # Cubic splines of 60 points on the third harmonic: (2 pi 3/60)^4/384 of 5e6, plus uneven gaps.
    assert total == pytest.approx(periodic(g.L_XA + tau, g), rel=2e-5)
    assert np.all(k(np.linspace(g.L_XA, g.L_XD, 300)[1:-1]) > 0.0)
    single = np.linspace(g.L_XB, g.L_XC, 20)[1:-1]  # one pair alone carries the total
    assert k(single) == pytest.approx(periodic(single, g), rel=2e-5)


def write(tmp_path, text):
    (tmp_path / "curve.csv").write_text(text, encoding="utf-8")
    return tmp_path / "curve.csv"


def test_csv_beside_the_parameter_file(tmp_path):
    g = geometry(load_gear_pair("nasa_28_28"))
    xi = np.linspace(g.L_XA, g.L_XD, 30)
    rows = "\n".join(f"{k / 1e6:.12g}, {x / 0.0254:.12g}" for x, k in zip(xi, curve(xi, g), strict=True))
    write(tmp_path, f"# from finite elements\nstiffness [N/um], position [inch]\n{rows}\n")
    base = load_gear_pair("nasa_28_28").with_(mesh__stiffness={"model": "rectangular"}, name="with table")
    text = base.to_toml()
    cut = text.index("[mesh.stiffness]")
    end = text.index("\n[", cut + 1)
    section = '[mesh.stiffness]\nmodel = "table"\nfile = "curve.csv"\n'
    (tmp_path / "pair.toml").write_text(text[:cut] + section + text[end:], encoding="utf-8")
    pair = load_gear_pair(tmp_path / "pair.toml")
    assert pair.mesh.stiffness.axis == "position_mm"
    assert pair_stiffness(pair)(xi) == pytest.approx(curve(xi, g), rel=1e-9)
    # The pair carries the table itself: the round trip needs no file, and the hash covers the numbers.
    again = GearPair.model_validate(pair.to_mapping())
    assert again == pair
    assert hash(again) == hash(pair)


@pytest.mark.parametrize(("text", "match"), [
    ("", "two columns"),
    ("a,b\n1,2\n", "header"),
    ("position [mm], stiffness [kg]\n1,2\n3,4\n", "stiffness with its unit"),
    ("position [N], stiffness [N/m]\n1,2\n3,4\n", "position with its unit"),
    ("phase [mm], stiffness [N/m]\n1,2\n3,4\n", "phase without a unit"),
    ("position [mm], stiffness [N/m]\n1,two\n", "pair of numbers"),
    ("position [mm], stiffness [N/m]\n1,2,3\n1,2\n", "pair of numbers"),
    ("position [mm], stiffness [N/m]\n1,2,3\n1,2,3\n", "pair of numbers"),
    ("position [mm], stiffness [N/m]\n", "two columns"),
])  # fmt: skip
def test_wrong_files_are_refused(tmp_path, text, match):
    with pytest.raises(ParameterError, match=match):
        read_columns(write(tmp_path, text).name, tmp_path, STIFFNESS)


def test_missing_file_is_refused(tmp_path):
    with pytest.raises(ParameterError, match="CSV file that exists"):
        read_columns("none.csv", tmp_path, STIFFNESS)


def test_wrong_numbers_are_refused():
    good = {"axis": "phase", "points": [0.0, 0.5, 1.0, 1.638], "stiffness": [1e8] * 4}
    for change, match in (
        ({"points": [0.0, 1.0, 0.5, 1.638]}, "increasing"),
        ({"stiffness": [1e8, -1e8, 1e8, 1e8]}, "-1e\\+08 N/m"),
        ({"stiffness": [1e8, 1e15, 1e8, 1e8]}, "1e\\+15 N/m"),
        ({"stiffness": [1e8] * 5}, "one per point"),
    ):
        with pytest.raises(ParameterError, match=match):
            pair_with(**{**good, **change})


def test_tables_that_do_not_cover_the_path_are_refused():
    short = pair_with(axis="phase", points=[0.0, 0.2, 0.4, 0.6, 0.8], stiffness=[1e8] * 5)
    with pytest.raises(ParameterError, match="A to D"):
        pair_stiffness(short)
    sparse = pair_with(kind="total", axis="phase", points=[0.0, 0.1, 0.2, 0.3], stiffness=[1e8] * 4)
    with pytest.raises(ParameterError, match="gap"):
        pair_stiffness(sparse)
    points = np.arange(20) / 10.0
    other = pair_with(
        kind="total", axis="phase", points=points.tolist(), stiffness=(1e8 * (1 + points)).tolist()
    )
    with pytest.raises(ParameterError, match="one base pitch"):
        pair_stiffness(other)
