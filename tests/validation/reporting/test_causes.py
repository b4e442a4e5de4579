"""Does the cross-check chapter show the teeth and say why the models differ?"""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
import xarray as xr

from multibody.study.causes import CAUSES
from validation.reporting import results
from validation.reporting.blocks import Table, plain
from validation.reporting.chapters.causes import causes, meshing_teeth

QUANTITIES = ("dte", "x_p", "y_p", "theta_p")


@pytest.fixture
def attributed():
    shape = (len(CAUSES) + 1, len(QUANTITIES))
    values = np.arange(1.0, 1.0 + np.prod(shape)).reshape(shape)
    values[0, 2] = np.nan  # y without friction
    return xr.Dataset(
        {"alone": (("cause", "quantity"), values), "without": (("cause", "quantity"), 100.0 * values)},
        coords={"cause": [*CAUSES, "all"], "quantity": list(QUANTITIES)},
        attrs={"largest": "entry_shift"},
    )


def test_the_table_has_every_cause_and_its_numbers(attributed):
    text, table = causes(SimpleNamespace(causes=attributed))
    assert isinstance(table, Table)
    assert len(table.rows) == len(CAUSES) + 1
    keys = list(table.columns)
    row = dict(zip(keys, table.rows[2], strict=True))
    assert row["dte_alone"] == float(attributed["alone"].sel(cause="entry_shift", quantity="dte"))
    assert row["y_p_without"] == float(attributed["without"].sel(cause="entry_shift", quantity="y_p"))
    assert table.marked == {2}
    assert row["cause"] in text.text
    everything = dict(zip(keys, map(plain, table.rows[-1]), strict=True))
    assert everything["dte_without"] is None  # all but all is the lumped motion: nothing to state
    assert dict(zip(keys, table.rows[0], strict=True))["y_p_alone"] is None


def test_a_quick_report_leaves_the_attribution_out():
    assert results.FULL.attribution
    assert not results.QUICK.attribution
    assert causes(SimpleNamespace(causes=None)) == []


def test_the_picture_shows_a_loaded_instant_of_the_exact_model(pair, check):
    picture = meshing_teeth(SimpleNamespace(pair=pair, check=check))
    figure = picture.draw()
    assert figure.get_suptitle().startswith(pair.name)
    phase = float(figure.get_suptitle().split(" ")[-3])  # "after 3.25 mesh cycles"
    # A quarter of the way into the last cycle: two pairs of the 28/28 pair touch up to 0.638.
    assert phase == pytest.approx(check.cycles - 1 + 0.25)
    arrows = [text for text in figure.axes[1].texts if text.arrow_patch is not None]
    assert len(arrows) == 4


def test_a_pair_without_multibody_motion_has_no_causes(pair, monkeypatch):
    def fail(*_, **__):
        raise results.NumericalError("No periodic multibody motion.")

    monkeypatch.setattr(results.multibody, "attribution", fail)
    assert results._causes(pair) is None
