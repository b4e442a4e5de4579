"""Does the command write every figure, its data, the claims and the errata?"""

import json

import xarray as xr
from matplotlib.figure import Figure

from reproductions.he_cho_singh_2008 import DRAW
from reproductions.he_cho_singh_2008 import __main__ as command
from reproductions.he_cho_singh_2008.records import ClaimsTable, ErrataChapter, FigureRecord


def test_everything_is_written(tmp_path, monkeypatch, capsys):
    records = [FigureRecord(n, "t", "", {}, {"a": xr.Dataset({"x": ("t", [1.0])})}) for n in DRAW]
    made = {
        "law_runs": None, "figure_records": records,
        "errata_chapter": ErrataChapter("", {}, (), xr.Dataset()), "claims": ClaimsTable("", {}, 0, 0, 0, ()),
        "draw_errata": Figure(),
    }  # fmt: skip
    for name, value in made.items():
        monkeypatch.setattr(command, name, lambda *_, value=value, **__: value)
    monkeypatch.setattr(command, "DRAW", {n: lambda _: Figure() for n in DRAW})
    command.main(tmp_path / "out")
    names = {path.relative_to(tmp_path / "out").as_posix() for path in (tmp_path / "out").rglob("*.*")}
    drawn = [*(f"figure{n}" for n in DRAW), "errata"]
    assert {f"{n}.svg" for n in drawn} | {f"pictures/{n}.png" for n in drawn} <= names
    assert {"claims.json", "errata.json", "data/figure7_a.nc", "data/figure7_a.csv"} <= names
    assert json.loads((tmp_path / "out" / "claims.json").read_text())["samples"] == 0
    assert "figure 7" in capsys.readouterr().out
