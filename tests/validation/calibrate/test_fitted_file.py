"""The fitted file: read again it is the same pair, and its ranges are those of the posterior."""

import json
from dataclasses import replace

import numpy as np
import pytest
from typer.testing import CliRunner

import spurcheck
from lumped.schema.assumed import State
from tests.validation.calibrate.rig import RANGES, rig_pair
from tests.validation.reporting.written import SMALL
from validation.cli import app
from validation.prediction.compare import compare
from validation.prediction.inputs import uncertain_inputs
from validation.prediction.motion import predicted
from validation.prediction.uncertainty import uncertainty
from validation.reporting.page_one import measurement_words
from validation.reporting.results import Results

RUNNER = CliRunner()


@pytest.fixture(scope="module")
def fitted(one_run, tmp_path_factory):
    path = tmp_path_factory.mktemp("fitted") / "fitted.toml"
    path.write_text(one_run.text(), encoding="utf-8")
    return path


@pytest.fixture(scope="module")
def samples(fitted):
    return uncertainty(str(fitted), samples=64, progress=False)


def test_the_file_read_again_is_the_fitted_pair(one_run, fitted):
    assert spurcheck.load_gear_pair(fitted) == one_run.pair


def test_the_file_has_the_best_fit(one_run, fitted):
    pair = spurcheck.load_gear_pair(fitted)
    best = dict(zip((one.field for one in one_run.inputs), one_run.machines.z[0], strict=True))
    for one in one_run.inputs:
        from scipy.special import ndtr

        assert dict(pair.posterior)[one.field][0] == pytest.approx(
            one.parts[0].at(float(ndtr(best[one.field]))), rel=1e-6
        )
    assert predicted(pair).peak_to_peak == pytest.approx(
        one_run.machines.numbers[0]["dte_peak_to_peak"], rel=1e-3
    )


def test_known_inputs_name_their_record_and_the_others_stay_assumed(one_run, fitted):
    pair = spurcheck.load_gear_pair(fitted)
    assert pair.state("mesh.stiffness_factor") is State.KNOWN
    assert dict(pair.sources)["mesh.stiffness_factor"].startswith("from record run 1450 rpm")
    assert pair.state("bearings.pinion.oloa_damping_ratio") is State.ASSUMED


def test_the_machines_are_the_only_input_of_fitted_fields(fitted):
    inputs = uncertain_inputs(spurcheck.load_gear_pair(fitted))
    assert [one.field for one in inputs] == ["records"]
    assert {part.field for part in inputs[0].parts} == set(RANGES)


def test_samples_of_the_file_are_the_machines_of_the_posterior(one_run, samples):
    for name in ("dte_peak_to_peak", "dynamic_factor", "bearing_rms"):
        machines = np.sort(one_run.results[name].to_numpy())
        # 64 points of one Sobol dimension: each of the 32 machines twice. The file has 7 digits.
        np.testing.assert_allclose(np.sort(samples[name].to_numpy())[::2], machines, rtol=1e-5)
        np.testing.assert_allclose(np.sort(samples[name].to_numpy())[1::2], machines, rtol=1e-5)


def test_the_range_has_the_error_of_the_model(one_run, samples):
    errors = one_run.machines.errors["bearing_rms"][1:]
    # Nobody measured the bearing force: the half-normal prior of 5 % has the root mean square 5 %, which 32
    # draws know to about 20 %.
    assert 0.02 < errors.std() < 0.10
    plain = np.array([one["bearing_rms"] for one in one_run.machines.numbers[1:]])
    expected = np.hypot(plain.std(), errors.std() * plain.mean())
    assert samples["bearing_rms"].to_numpy().std() == pytest.approx(expected, rel=0.3)
    assert expected > 1.05 * plain.std()


def test_a_value_that_was_changed_afterwards_is_kept(fitted):
    pair = spurcheck.load_gear_pair(fitted).with_({"mesh.damping_ratio": 0.03})
    records = uncertain_inputs(pair)[0]
    assert "mesh.damping_ratio" not in {part.field for part in records.parts}
    assert "mesh.damping_ratio" not in records.changes(0.3)


def test_variants_of_a_fitted_pair_run_in_the_same_machines(fitted):
    pair = spurcheck.load_gear_pair(fitted)
    found = compare(pair, pair.with_(torque=60.0), samples=16, progress=False)
    assert [str(one) for one in found["input"].to_numpy()] == ["records"]


def test_report_reads_the_file(fitted, tmp_path):
    written = spurcheck.report(str(fitted), tmp_path / "report", quick=True, progress=False)
    assert not written.failed
    page = " ".join(json.loads((tmp_path / "report" / "report.json").read_text(encoding="utf-8"))["how_sure"])
    said = (
        "Compared with a measurement? Not beside this prediction; inputs and their ranges are fitted to "
        "records: run 1450 rpm (1450 rpm, 80 N m)."
    )
    assert said in page
    parameters = (tmp_path / "report" / "tables" / "parameters.csv").read_text(encoding="utf-8")
    line = next(one for one in parameters.splitlines() if one.startswith("mesh.stiffness_factor"))
    assert "by records" in line
    assert "from record" in line


def test_page_1_has_the_ranges_of_the_machines(one_run, fitted):
    # ``spread`` is the range of a row of page 1 over its value.
    results = Results(spurcheck.load_gear_pair(fitted), replace(SMALL, samples=64))
    for name in ("dte_peak_to_peak", "dynamic_factor", "bearing_rms"):
        # 64 samples: each of the 32 machines twice. The file has 7 digits.
        machines = np.repeat(one_run.results[name].to_numpy(), 2)
        value = results.prediction.numbers[name]
        ends = [value * (1.0 + end) for end in results.spread(name)]
        assert ends == pytest.approx(list(np.percentile(machines, [5.0, 95.0])), rel=1e-5)
        assert value == pytest.approx(one_run.machines.numbers[0][name], rel=1e-3)


def test_many_records_are_named_by_the_first_ones(fitted):
    pair = spurcheck.load_gear_pair(fitted)
    rows = [f"run {j} ({j}00 rpm, 80 N m)" for j in range(1, 8)]

    def said(count):
        source = f"from record {', '.join(rows[:count])}"
        return measurement_words(Results(pair.with_({"sources": {"gear.mass": source}}), SMALL), None)

    start = "Not beside this prediction; inputs and their ranges are fitted to records"
    assert said(4) == f"{start}: {', '.join(rows[:4])}"
    assert said(7) == f"{start}: {', '.join(rows[:3])} and 4 more"
    without = Results(pair.with_({"sources": {"gear.mass": "drawing"}}), SMALL)
    assert measurement_words(without, None) == start
    assert measurement_words(Results(rig_pair(), SMALL), None) == "No"


def _written(folder, truth_values):
    """Data file and description of a record."""
    values = "\n".join(f"{t:.9g},{1e6 * v:.9g}" for t, v in truth_values)
    (folder / "run.csv").write_text(f"t,te\n{values}\n", encoding="utf-8")
    (folder / "run.toml").write_text(
        'name = "run"\nsource = "computed"\ndata = "run.csv"\npinion_speed = 1450\npinion_torque = 80\n'
        '[abscissa]\nkind = "time"\n'
        'column = "t"\nunit = "s"\n[[channel]]\nname = "te"\ncolumn = "te"\nquantity = "dte"\nunit = "um"\n',
        encoding="utf-8",
    )


def test_the_command_writes_the_file_and_says_what_is_not_known(truth, tmp_path, monkeypatch):
    from tests.validation.calibrate.rig import rig_record

    record = rig_record(truth)
    _written(tmp_path, zip(record.places, record.channels[0].values, strict=True))
    (tmp_path / "pair.toml").write_text(rig_pair().to_toml(), encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    line = ["calibrate", "pair.toml", "run.toml", "-o", "fitted.toml", "--machines", "16"]
    result = RUNNER.invoke(app, line)
    assert result.exit_code == 0, result.output
    assert "They do not know: bearings.pinion.oloa_damping_ratio" in " ".join(result.output.split())
    assert "Next test: transmission error" in " ".join(result.output.split())
    assert spurcheck.load_gear_pair("fitted.toml").posterior
    assert "Next test: transmission error" in (tmp_path / "fitted.toml").read_text(encoding="utf-8")
    numbers = json.loads(
        RUNNER.invoke(app, ["calibrate", "pair.toml", "run.toml", "--machines", "16", "--json"]).stdout
    )
    assert len(numbers["next_tests"]) == 20
    assert numbers["next_tests"][0]["left"]["bearing_rms"] < 1.0
    again = RUNNER.invoke(app, line)
    assert again.exit_code == 2
    assert "--force" in again.output
    missing = RUNNER.invoke(app, ["calibrate", "pair.toml"])
    assert missing.exit_code == 2
    assert "at least one record" in missing.output
