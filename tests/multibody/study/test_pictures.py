"""Do the pictures show the teeth that the model computes with, and do they need a display?"""

from __future__ import annotations

import matplotlib
import numpy as np
import pytest

import lumped
import multibody
from multibody.study.outline import gear_outline
from multibody.study.pictures import gear_picture

PAIR = lumped.load_gear_pair("fzg_c")


def inside(points, polygon):
    return matplotlib.path.Path(polygon).contains_points(points)


def placed(outline, angle, centre):
    c, s = np.cos(angle), np.sin(angle)
    return outline @ np.array([[c, s], [-s, c]]) + centre


@pytest.mark.parametrize("name", ["fzg_c", "nasa_28_28", "nasa_art_25_31"])
def test_drawn_teeth_touch_but_do_not_cut(name):
    """At nominal rotation no drawn point lies in the other gear beyond the polygons' own error."""
    pair = lumped.load_gear_pair(name)
    g = lumped.geometry(pair)
    outlines = [gear_outline(pair, which, points=60) for which in ("pinion", "gear")]
    centres = (np.array([0.0, -g.base_radius_pinion]), np.array([g.L_XY, g.base_radius_gear]))
    for phase in (0.1, 0.45, 0.8):
        t = phase * g.mesh_period
        pinion, gear = (
            placed(o, a, c)
            for o, a, c in zip(outlines, (-g.omega_pinion * t, g.omega_gear * t), centres, strict=True)
        )
        # Moved apart by 2 um along the line of action, nothing overlaps; pushed together by 10 um, it does.
        assert not inside(gear + np.array([2e-6, 0.0]), pinion).any()
        assert not inside(pinion - np.array([2e-6, 0.0]), gear).any()
        assert (
            inside(gear - np.array([1e-5, 0.0]), pinion).any()
            or inside(pinion + np.array([1e-5, 0.0]), gear).any()
        )


def test_outline_is_closed_and_has_every_tooth():
    g = lumped.geometry(PAIR)
    outline = gear_outline(PAIR, "gear")
    radius = np.hypot(*outline.T)
    assert radius.max() == pytest.approx(g.tip_radius_gear, rel=1e-12)
    assert radius.min() == pytest.approx(g.root_radius_gear, rel=1e-12)
    turned = np.unwrap(np.arctan2(outline[:, 1], outline[:, 0]))
    assert turned[-1] - turned[0] == pytest.approx(2 * np.pi, rel=0.01)
    at_tip = radius > g.tip_radius_gear * (1 - 1e-12)
    assert np.sum(at_tip & ~np.roll(at_tip, 1)) == PAIR.gear.teeth


def test_picture_needs_no_display(monkeypatch, tmp_path):
    monkeypatch.delenv("DISPLAY", raising=False)
    run = multibody.simulate(PAIR, 1, samples_per_cycle=16)
    figure = gear_picture(PAIR, run, 4)
    figure.savefig(tmp_path / "gears.png")
    assert (tmp_path / "gears.png").stat().st_size > 10_000
    arrows = [a for a in figure.axes[1].texts if a.arrow_patch is not None]
    assert len(arrows) == 2 * int(run["contact"][:, 4].sum())
    # Every force is written beside its arrow, with the value of the run.
    written = sorted(t.get_text() for t in figure.axes[1].texts if t.get_text())
    touching = run["contact"][:, 4].to_numpy() > 0
    forces = [np.abs(run[name][:, 4].to_numpy()[touching]) for name in ("normal_load", "friction_force")]
    assert written == sorted(f"{force:.0f} N" for force in np.concatenate(forces))
    with pytest.raises(lumped.ParameterError, match="index"):
        gear_picture(PAIR, run, 17)


def test_arrows_point_where_the_gear_is_pushed_and_to_scale():
    run = multibody.simulate(PAIR, 1, samples_per_cycle=16)
    axes = gear_picture(PAIR, run, 4).axes[1]
    factor = float(axes.get_legend().get_texts()[1].get_text().split("arrows ")[1].split(" times")[0])
    tips = [np.subtract(a.xy, a.xyann) for a in axes.texts if a.arrow_patch is not None]
    load, friction = (run[name][:, 4].to_numpy() for name in ("normal_load", "friction_force"))
    touching = run["contact"][:, 4].to_numpy() > 0
    # Normal loads push the gear along +x, friction pushes it against the pinion's F.
    scale = tips[0][0] / load[touching][0]
    expected = []
    for n, f in zip(load[touching], friction[touching], strict=True):
        expected += [(scale * n, 0.0), (0.0, -factor * scale * f)]
    assert scale > 0
    np.testing.assert_allclose(tips, expected, rtol=1e-12, atol=1e-12)
