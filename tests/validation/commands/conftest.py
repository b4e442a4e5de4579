"""Parameter files shared by the tests of the commands."""

import pytest

import lumped


@pytest.fixture(scope="session")
def shafted_file(tmp_path_factory):
    """A file of a pair on two equal shafts, gears in the middle."""
    bearings = [{"position": z, "loa_stiffness": 2e8, "oloa_stiffness": 1.5e8} for z in (20, 120)]
    shaft = {"segments": [{"length": 140, "diameter": 30}], "gear_position": 70, "bearings": bearings}
    pair = lumped.load_gear_pair("nasa_28_28").with_(
        mesh__relief="ignored", shafts={"damping_ratio": 0.02, "pinion": shaft, "gear": shaft}
    )
    path = tmp_path_factory.mktemp("shafted") / "shafted.toml"
    path.write_text(pair.to_toml())
    return path
