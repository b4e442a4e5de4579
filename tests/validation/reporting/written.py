"""Reports of two unequal pairs, one that keeps contact and one that loses it, read again from their files."""

import html
import inspect
import json
import re
import shutil
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cache, cached_property
from pathlib import Path

import pandas as pd
import pytest
import xarray as xr
from matplotlib.figure import Figure

import lumped
from validation.cross_check import comparison
from validation.exchange.new_pair_file import new_pair_text
from validation.plots.style import save
from validation.reporting import build
from validation.reporting.effort import Effort
from validation.reporting.results import Results

#: Few samples and speeds: what is tested is what is done with them.
SMALL = Effort(16, 4, 9, 32, 101, 21, 9, 30.0, 0, "small report")


def pair(name: str, teeth: str, speed: float, torque: float, **more: object) -> lumped.GearPair:
    """A pair whose gears, speed and torque all differ."""
    request = {
        "teeth": teeth, "basic_rack.module": 3.0, "pinion.face_width": 26.0, "gear.face_width": 25.0,
        "operating.pinion_speed": speed, "operating.pinion_torque": torque,
        "mesh.stiffness.model": "rectangular",
    }  # fmt: skip
    return lumped.load_gear_pair(tomllib.loads(new_pair_text(name, request | more)))


#: Materials and shifts in which gear and pinion differ.
UNLIKE_GEARS = {
    "gear.youngs_modulus": 172.0, "gear.poisson_ratio": 0.26, "gear.density": 7200.0,
    "pinion.roughness": 0.3, "gear.roughness": 0.7,
}  # fmt: skip
#: From a 25-degree rack, with large shifts against each other: contact is kept. And a pinion with more teeth
#: than the gear, which it drives far above its resonance: contact is lost.
PAIRS = {
    "calm": lambda: pair("calm", "19/41", 1450.0, 80.0).with_(
        UNLIKE_GEARS
        | {"pinion.profile_shift": 0.31, "gear.profile_shift": -0.12}
        | {"basic_rack.pressure_angle": 25.0, "basic_rack.fillet_radius_coefficient": 0.22}
    ),
    "lost": lambda: pair("lost", "57/31", 6500.0, 275.0).with_(
        UNLIKE_GEARS
        | {"pinion.profile_shift": -0.14, "gear.profile_shift": 0.22, "friction.law": "xu_kahraman"}
    ),
}


@dataclass(frozen=True)
class Printed:
    """A table as the page shows it."""

    caption: str
    headings: list[str]
    rows: list[list[str]]


@dataclass(frozen=True)
class Written:
    """A report in its folder, with its files read again, and its figures as they were drawn."""

    folder: Path
    result: build.Report
    document: dict
    page: str
    figures: Mapping[str, Figure] = field(default_factory=dict)
    loaded: dict[str, xr.Dataset] = field(default_factory=dict)

    def data(self, name: str) -> xr.Dataset:
        """A dataset of the folder data/."""
        if name not in self.loaded:
            self.loaded[name] = xr.load_dataset(self.folder / "data" / f"{name}.nc", engine="h5netcdf")
        return self.loaded[name]

    @cached_property
    def parameters(self) -> dict:
        """The parameter file of the report, as plain data."""
        return tomllib.loads((self.folder / "data" / "parameters.toml").read_text(encoding="utf-8"))

    def table(self, name: str) -> list[dict]:
        """A table of report.json."""
        return next(c[name] for c in self.document["chapters"].values() if name in c.get("tables", {}))

    def headings(self, name: str) -> dict[str, str]:
        """Column of a table -> heading on the page."""
        return dict(zip(self.table(name)[0], self.printed[name].headings, strict=True))

    def curves(self, name: str, number: int = 1) -> pd.DataFrame:
        """What a figure draws, from its CSV; ``number`` of its datasets."""
        suffix = f"_{number}" if number > 1 else ""
        return pd.read_csv(self.folder / "tables" / f"figure_{name}{suffix}.csv")

    @property
    def sentences(self) -> dict[str, str]:
        """Chapter -> its result in a sentence."""
        return {key: chapter["text"][0][0] for key, chapter in self.document["chapters"].items()}

    @cached_property
    def printed(self) -> dict[str, Printed]:
        """The tables of the page: of page 1 under "numbers", of the chapters under their names."""
        tables = {}
        for name, inside in re.findall(r'<table class="([\w ]+)">(.*?)</table>', self.page, flags=re.DOTALL):
            head, _, body = inside.partition("</thead>")
            caption = "".join(re.findall(r"<caption>(.*?)</caption>", head, flags=re.DOTALL))
            rows = re.findall(r"<tr>(.*?)</tr>", body, flags=re.DOTALL)
            tables[name.split()[0]] = Printed(
                plain(re.sub(r"<b>.*?</b>", "", caption)),
                [plain(cell) for cell in re.findall(r"<th[^>]*>(.*?)</th>", head, flags=re.DOTALL)],
                [[plain(c) for c in re.findall(r"<td[^>]*>(.*?)</td>", r, flags=re.DOTALL)] for r in rows],
            )
        return tables


def plain(markup: str) -> str:
    """The text of some HTML, with ordinary spaces and minus signs."""
    text = html.unescape(re.sub(r"<[^>]+>", " ", markup))
    return " ".join(text.replace("\u00a0", " ").replace("\u2212", "-").split())


def without_variant(patch: pytest.MonkeyPatch) -> None:
    """Cross-checks leave out the variant, half their work: tests/validation/cross_check judges it."""
    patch.setitem(inspect.unwrap(comparison.crosscheck).__kwdefaults__, "variant", False)


@cache
def known(name: str) -> Results:
    """Shared results of a pair, computed as far as they were asked for."""
    return Results(PAIRS[name](), SMALL, name)


def write_report(
    name: str,
    folder: Path,
    *,
    drawn: bool = True,
    results: Results | None = None,
    same: Written | None = None,
) -> Written:
    """Write the report of a pair with few samples, and read it."""
    figures: dict[str, Figure] = {}

    def keep(figure: Figure, path: Path, *, new: bool = False) -> None:
        figures[path.stem] = figure
        if drawn:
            save(figure, path, new=new)
        else:
            path.write_bytes(b"<svg/>")

    with pytest.MonkeyPatch.context() as patch:
        without_variant(patch)
        patch.setattr(build, "FULL", SMALL)
        patch.setattr("validation.plots.style.save", keep)
        if results is not None:
            patch.setattr(build, "Results", lambda *_, **__: results)
        if same is not None:
            patch.setattr(build, "_write_data", lambda _, data: shutil.copytree(same.folder / "data", data))
        result = build.report(PAIRS[name](), folder)
    document = json.loads((folder / "report.json").read_text(encoding="utf-8"))
    page = (folder / "index.html").read_text(encoding="utf-8")
    return Written(folder, result, document, page, figures, {} if same is None else same.loaded)
