"""Reports of two unequal pairs, one that keeps contact and one that loses it, written once."""

import json
import tomllib
from dataclasses import dataclass
from pathlib import Path

import pytest
import xarray as xr

import lumped
from validation.exchange.new_pair_file import new_pair_text
from validation.reporting import build
from validation.reporting.results import Effort

#: Few samples and speeds: what is tested is what is done with them.
SMALL = Effort(16, 4, 9, 32, 101, 21, 9, full=False)


@dataclass(frozen=True)
class Written:
    """A report in its folder, with its files read again."""

    folder: Path
    result: build.Report
    document: dict
    page: str

    def data(self, name: str) -> xr.Dataset:
        """A dataset of the folder data/."""
        return xr.load_dataset(self.folder / "data" / f"{name}.nc", engine="h5netcdf")

    @property
    def parameters(self) -> dict:
        """The parameter file of the report, as plain data."""
        return tomllib.loads((self.folder / "data" / "parameters.toml").read_text(encoding="utf-8"))


def pair(name: str, teeth: str, speed: float, torque: float, **more: object) -> lumped.GearPair:
    """A pair whose gears, speed and torque all differ."""
    request = {
        "teeth": teeth, "basic_rack.module": 3.0, "pinion.face_width": 26.0, "gear.face_width": 25.0,
        "operating.pinion_speed": speed, "operating.pinion_torque": torque,
        "mesh.stiffness.model": "rectangular",
    }  # fmt: skip
    return lumped.load_gear_pair(tomllib.loads(new_pair_text(name, request | more)))


PAIRS = {
    "calm": lambda: pair("calm", "19/41", 1450.0, 80.0),
    "lost": lambda: pair("lost", "31/57", 12000.0, 150.0),
}


@pytest.fixture(scope="session", params=list(PAIRS))
def written(request, tmp_path_factory) -> Written:
    """The report of each pair."""
    folder = tmp_path_factory.mktemp(request.param) / "report"
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(build, "FULL", SMALL)
        result = build.report(PAIRS[request.param](), folder)
    document = json.loads((folder / "report.json").read_text(encoding="utf-8"))
    return Written(folder, result, document, (folder / "index.html").read_text(encoding="utf-8"))
