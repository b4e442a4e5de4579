"""Do the results of a prediction carry their pair, so that figures, spectra and files can be made of them?"""

import tomllib

import pytest
import xarray as xr

import spurcheck
from lumped.labelling import parameters_hash
from tests.unlike_pairs import unlike_pair

#: Motions that come from different programs inside: linear, unilateral, on shafts, from a settled run.
MOTIONS = {
    "linear": ("rack_25_degrees_always_pushing", {"mesh.contact": "prescribed", "friction.law": "none"}),
    "contact lost": ("larger_gear_drives_contact_lost", {}),
    "relieved": ("heavily_relieved_under_load", {}),
    "on shafts": ("contact_ratio_2_3_on_shafts", {}),
    "prescribed, unilateral": ("contact_ratio_1_1_large_shifts", {"mesh.contact": "prescribed"}),
}


@pytest.mark.parametrize("name", MOTIONS)
def test_a_prediction_is_drawn_analysed_and_written(name, tmp_path):
    pair_name, changes = MOTIONS[name]
    pair = unlike_pair(pair_name).with_(changes)
    found = spurcheck.predict(pair)
    assert spurcheck.plot(found).axes
    assert spurcheck.order_spectrum(found.cycle, shaft="pinion").sizes["order"] > 1
    spurcheck.write_results(found.cycle, tmp_path / "motion.nc")
    with xr.open_dataset(tmp_path / "motion.nc") as written:
        assert spurcheck.load_gear_pair(tomllib.loads(written.attrs["parameters"])) == pair
        assert written.attrs["parameters_sha256"] == parameters_hash(pair)
