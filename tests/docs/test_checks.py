"""Do the recipes of the pages on checks see what is wrong in the reader's model?"""

from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

import lumped
import spurcheck
from tests.docs.own_models import write_own_models
from validation.check.check import Rung

PAIR = "nasa_28_28"


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("models")
    pair = lumped.load_gear_pair(PAIR).with_(mesh__relief="ignored")
    (folder / "mypair.toml").write_text(pair.to_toml())
    write_own_models(pair, folder)
    return folder


@pytest.fixture
def session(folder, monkeypatch, blocks, root):
    """The function that runs the blocks of a page, with a change of their text, and returns their names."""
    monkeypatch.chdir(folder)
    monkeypatch.syspath_prepend(folder)

    def run(page: str, before: str = "", after: str = ""):
        text = "\n".join(b.text for b in blocks(root / "docs/how_to" / page) if b.language == "python")
        assert before in text
        names: dict[str, object] = {}
        exec(compile(text.replace(before, after) if before else text, page, "exec"), names)
        return SimpleNamespace(**names)

    return run


@pytest.mark.slow
def test_what_differs_in_a_mesh_of_ross_is_named(session):
    names = session("check_ross.md")
    assert names.result.agrees
    assert len(names.result.static.rows) == 11  # contact ratio, 2 x 3 of the gears, 4 of the stiffness
    assert names.pair.gear.teeth == 60
    softer = SimpleNamespace(**vars(names.mesh))
    softer.stiffness_range = 0.8 * np.asarray(names.mesh.stiffness_range)
    softer.contact_ratio = 1.6
    softer.driven_gear = SimpleNamespace(**vars(names.mesh.driven_gear))
    softer.driven_gear.Ip = 1.1 * names.mesh.driven_gear.Ip
    result = spurcheck.check(*names.of_ross(softer, speed=1500, torque=50))
    assert {row.name for row in result.static.wrong} == {
        "contact ratio", "moment of inertia of the gear",
        *(f"mesh stiffness, {which}" for which in ("mean", "largest", "smallest")),
    }  # fmt: skip
    assert result.failed is Rung.STATIC
    fewer = SimpleNamespace(**vars(names.mesh))
    fewer.driven_gear = SimpleNamespace(**vars(names.mesh.driven_gear))
    fewer.driven_gear.n_teeth = 59
    assert not spurcheck.check(*names.of_ross(fewer, speed=1500, torque=50)).agrees


@pytest.mark.slow
@pytest.mark.parametrize(("before", "after", "channel"), [
    ('-run["GEAR.RZ [deg]"]', 'run["GEAR.RZ [deg]"]', "theta_g"),
    ("x = X * np.sin(angle) + Y * np.cos(angle)", "x = X", "x_p"),
    ("y = X * np.cos(angle) - Y * np.sin(angle)", "y = -X * np.cos(angle) + Y * np.sin(angle)", "y_p"),
])  # fmt: skip
def test_a_sign_or_an_axis_that_is_not_turned_round_differs(session, before, after, channel):
    assert session("check_multibody.md").result.misfit < 1e-3
    wrong = session("check_multibody.md", before, after).result
    assert not wrong.agrees
    by_name = {row.channel.channel.name: row.total for row in wrong.nearer.channels}
    assert by_name[channel] > 0.05


@pytest.mark.slow
def test_an_averaged_model_has_the_frequencies_and_not_the_motion(session):
    names = session("check_statespace.md")
    frequencies = [row for row in names.result.static.rows if row.name.startswith("natural frequency")]
    assert len(frequencies) == 5
    assert all(row.agrees for row in frequencies)
    assert names.result.failed is Rung.MOTION
    assert Path("averaged.png").is_file()
    heavier = session(
        "check_statespace.md", "m_q = 1 / (rb1**2 / j1", "m_q = 1 / (rb1**2 / (1.3 * j1)"
    ).result
    assert {row.name for row in heavier.static.wrong} == {"natural frequency 5"}
