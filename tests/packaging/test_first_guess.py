"""Does what a newcomer types in Python work, or say what to type instead?"""

from __future__ import annotations

import pickle
import pydoc
import sys
import tomllib
from pathlib import Path

import control
import matplotlib.pyplot as plt
import numpy as np
import pandas as pd
import pytest
import xarray as xr
from pydantic import BaseModel

import spurcheck
from validation.interactive import page
from validation.reporting.page import limits

ROOT = Path(__file__).parents[2]
DRAWING = {"module": 2.5, "face_width": 20, "speed": 1450, "torque": 80}


@pytest.fixture(scope="module")
def pair() -> spurcheck.GearPair:
    return spurcheck.new_pair("19/41", **DRAWING)


def test_a_new_pair_is_what_the_drawing_says(pair: spurcheck.GearPair) -> None:
    assert (pair.pinion.teeth, pair.gear.teeth) == (19, 41)
    assert pair.basic_rack.module == pytest.approx(2.5e-3)
    assert pair.pinion.face_width == pair.gear.face_width == pytest.approx(0.02)
    assert pair.operating.pinion_speed == pytest.approx(1450 * 2 * np.pi / 60)
    assert dict(pair.sources)["pinion.teeth"] == "given by the user"
    assert pair.assumed["mesh.damping_ratio"] == 0.05
    assert "pinion.teeth" not in pair.assumed
    shifted = spurcheck.new_pair(
        "13/41", **DRAWING, changes={"oil": "vg220", "law": "coulomb", "pinion.profile_shift": 0.4}
    )
    assert (shifted.pinion.profile_shift, shifted.friction.law) == (0.4, "coulomb")


def test_numbers_of_a_pair_by_their_names(pair: spurcheck.GearPair) -> None:
    found = spurcheck.predict(pair)
    assert found.dynamic_factor == spurcheck.dynamic_factor(pair)
    load = found.cycle["normal_load"].sum("pair").to_numpy()
    assert found.static_force == pytest.approx(80 / pair.geometry.base_radius_pinion)
    assert found.mean_force == pytest.approx(np.mean(load))
    assert found.dynamic_factor == pytest.approx(np.max(load) / np.mean(load))
    # The trace of M^-1 K is the sum of the squared natural frequencies.
    frequencies = spurcheck.natural_frequencies(pair).to_numpy()
    system = spurcheck.periodic_system(pair, "elastic")
    m = len(system.coordinates)
    mean = system.matrices(np.linspace(0.0, system.period, 20001)[:-1] + system.period / 40000).mean(axis=0)
    assert np.sum((2 * np.pi * frequencies) ** 2) == pytest.approx(-np.trace(mean[m:, :m]), rel=2e-4)


def test_the_multibody_model_has_the_law_of_the_user(pair: spurcheck.GearPair) -> None:
    formula = pair.with_(law="coulomb", friction__coefficient=0.05)
    laws = (formula, pair.with_(law=lambda xi: 0.05))
    a, b = (spurcheck.multibody.simulate(one, cycles=2)["y_p"].to_numpy() for one in laws)
    assert np.abs(a - b).max() < 1e-6 * np.ptp(a)


_LINES = Path(__file__).with_name("guesses.txt").read_text(encoding="utf-8").splitlines()


@pytest.mark.parametrize("line", [line for line in _LINES if not line.startswith("#")])
def test_a_guess_works_or_is_told_the_right_one(line: str, pair: spurcheck.GearPair) -> None:
    typed, _, answer = line.partition(" => ")
    names = {"pair": pair, "spurcheck": spurcheck, "np": np, "pd": pd, "pickle": pickle}
    if answer in ("True", "pair"):
        assert eval(typed, names) == (True if answer == "True" else pair)
    else:
        with pytest.raises((spurcheck.ParameterError, TypeError, AttributeError, KeyError)) as refusal:
            eval(typed, names)
        assert answer in str(refusal.value)
    plt.close("all")


def test_several_results_share_one_axes(pair: spurcheck.GearPair) -> None:
    runs = [
        spurcheck.steady_state(pair, samples_per_cycle=16).assign_attrs(),
        spurcheck.steady_state(pair.with_(torque=40), samples_per_cycle=16),
    ]
    figure, ax = plt.subplots()
    assert spurcheck.plot(runs, ax=ax, labels=["80 N m", "40 N m"]) is figure
    drawn = [line.get_ydata() for line in ax.lines]
    for line, run in zip(drawn, runs, strict=True):
        np.testing.assert_allclose(line, 1e6 * run["dte"])
    assert [text.get_text() for text in ax.get_legend().get_texts()] == ["80 N m", "40 N m"]
    plt.close(figure)


def test_a_star_imports_every_public_name() -> None:
    names: dict[str, object] = {}
    exec("from spurcheck import *", names)
    assert set(dir(spurcheck)) - {"__version__"} == set(names) - {"__builtins__"}
    assert names["predict"] is spurcheck.predict


def test_a_pair_shows_names_for_users_alone(pair: spurcheck.GearPair) -> None:
    """None of the schema library's own, 31 of them, at any level."""
    library = {name for name in dir(BaseModel) if not name.startswith("_")}
    for section in (pair, pair.pinion, pair.operating, pair.mesh, pair.friction):
        assert library.isdisjoint(dir(section))
        assert set(type(section).model_fields) <= set(dir(section))
    assert {"with_", "to_toml", "geometry", "operating"} <= set(dir(pair))


def test_natural_frequencies_say_what_they_are(pair: spurcheck.GearPair) -> None:
    frequencies = spurcheck.natural_frequencies(pair)
    assert frequencies.attrs["units"] == "Hz"
    assert frequencies.attrs["gear_pair"] == pair.name
    np.testing.assert_allclose(
        60 * frequencies / 19, frequencies["resonant_speed_rpm"]
    )  # mesh = speed x teeth
    natural, damping, _ = control.damp(spurcheck.averaged_state_space(pair), doprint=False)
    order = np.argsort(natural)[::2]  # two poles a mode
    np.testing.assert_allclose(frequencies, natural[order] / (2 * np.pi), rtol=1e-9)
    np.testing.assert_allclose(frequencies["damping_ratio"], damping[order], rtol=1e-6)


def test_methods_of_a_cross_check_are_the_functions_of_the_multibody_model(
    pair: spurcheck.GearPair,
) -> None:
    check = spurcheck.crosscheck(pair, cycles=8, samples_per_cycle=32, variant=False)
    balance = check.power_balance(2)
    assert balance == spurcheck.multibody.power_balance(pair, 2)
    assert abs(balance.residual) < 1e-6 * balance.driving
    causes = check.attribution(progress=False)
    assert set(causes["cause"].values) >= {"all", "contact"}
    xr.testing.assert_identical(
        causes["alone"], spurcheck.multibody.attribution(pair, progress=False)["alone"]
    )


def test_help_is_short_and_dir_has_only_names_for_users() -> None:
    text = pydoc.render_doc(spurcheck)
    assert len(text.splitlines()) < 200
    assert not [name for name in dir(spurcheck) if name.startswith("_") and name != "__version__"]
    assert all(name in text for name in dir(spurcheck) if name not in ("__version__", "GearPair"))


def test_a_parameter_file_says_its_format(pair: spurcheck.GearPair) -> None:
    text = pair.to_toml()
    assert text.startswith("format = 2\n")
    data = tomllib.loads(text)
    old = {key: value for key, value in data.items() if key != "format"}
    assert spurcheck.load_gear_pair(old) == spurcheck.load_gear_pair(data) == pair
    with pytest.raises(spurcheck.ParameterError, match=r"format = 3.*later release"):
        spurcheck.load_gear_pair(data | {"format": 3})


def test_the_interactive_page_says_how_to_get_what_it_needs(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "plotly", None)
    with pytest.raises(spurcheck.ParameterError, match=r"spurcheck\[interactive\]"):
        page.plotly()


def test_page_and_documentation_have_the_same_limits() -> None:
    shown = limits()
    assert len(shown) > 5
    assert all(text[0].isupper() and text.endswith(".") and "\n" not in text for text in shown)
    assert "templates/limits.md" in (ROOT / "docs/limits.md").read_text(encoding="utf-8")
