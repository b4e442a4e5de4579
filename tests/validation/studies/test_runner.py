"""Does a sweep compute every case once, whatever the cases do, and wherever they run?"""

import errno
import threading
import warnings
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from lumped import LawRangeWarning, NumericalError, geometry, load_gear_pair, speed_sweep
from lumped.errors import ParameterError, StorageError
from lumped.model.results import cycle_peak_to_peak
from lumped.schema.pair import field_at
from validation.studies import Status, StoreError, read_results, run_sweep, workers
from validation.studies import store as stores
from validation.studies.store import provenance


def constant(**values):
    return {"contact_ratio": 1.5, "mesh_frequency": 2.0} | values


def speed_of(variation):
    return round(variation.pair.operating.pinion_speed * 30 / np.pi, 6)


def test_the_result_is_labelled_and_right(study, tmp_path):
    summary = run_sweep(study, tmp_path / "out")
    assert (summary.cases, summary.computed, summary.before) == (120, 120, 0)
    with xr.open_dataset(summary.results, engine="h5netcdf") as result:
        assert result.contact_ratio.dims == ("operating_pinion_speed", "face_width", "centre_distance")
        assert result.operating_pinion_speed.attrs["units"] == "rpm"
        assert (
            result.operating_pinion_speed.attrs["long_name"] == field_at("operating.pinion_speed").description
        )
        assert result.face_width.attrs["field"] == "pinion.face_width, gear.face_width"
        pair = load_gear_pair("nasa_28_28")
        for distance in (88.9, 89.4):
            for speed in result.operating_pinion_speed.to_numpy():
                case = result.sel(operating_pinion_speed=speed, face_width=6.0, centre_distance=distance)
                g = geometry(pair.with_(centre_distance=distance, operating__pinion_speed=speed))
                assert float(case.contact_ratio) == g.contact_ratio
                assert float(case.mesh_frequency) == g.mesh_frequency
                assert int(case.status) == Status.OK


def test_failed_cases_are_recorded_and_the_others_go_on(study, tmp_path):
    summary = run_sweep(study, tmp_path / "out")
    result = read_results(tmp_path / "out")
    wedged = result.sel(centre_distance=88.5)
    assert (wedged.status == Status.REFUSED).all()
    assert wedged.contact_ratio.isnull().all()
    assert (result.sel(centre_distance=[88.9, 89.0, 89.2, 89.4]).status == Status.OK).all()
    assert result.sizes["failure"] == summary.failed == 24
    assert all("wedge" in str(text) for text in result.failure_message.to_numpy())
    assert result.failed_case.to_numpy().tolist() == list(range(0, 120, 5))


@pytest.mark.parametrize(("raised", "status"), [
    (NumericalError("raise rtol"), Status.NUMERICAL),
    (ZeroDivisionError("a defect"), Status.UNEXPECTED),
    (MemoryError("too large"), Status.UNEXPECTED),
    (RecursionError("too deep"), Status.UNEXPECTED),
])  # fmt: skip
def test_any_error_of_a_case_is_its_own(study, tmp_path, replace_analysis, raised, status):
    def analysis(variation, settings):
        if speed_of(variation) == 500.0:
            raise raised
        return constant()

    replace_analysis(analysis)
    run_sweep(study, tmp_path / "out")
    result = read_results(tmp_path / "out").sel(centre_distance=88.9)
    assert (result.sel(operating_pinion_speed=500.0).status == status).all()
    assert int((result.status == Status.OK).sum()) == 7 * 3


@pytest.mark.parametrize("value", [float("nan"), float("inf")])
def test_a_number_that_is_not_finite_is_a_failure(study, tmp_path, replace_analysis, value):
    replace_analysis(lambda variation, settings: constant(mesh_frequency=value))
    summary = run_sweep(study, tmp_path / "out")
    assert dict(summary.statuses)[Status.NUMERICAL] == 96
    assert "not finite: mesh_frequency" in dict(summary.failures)[1]


def test_a_law_outside_its_range_is_flagged(study, tmp_path, replace_analysis):
    def analysis(variation, settings):
        warnings.warn("outside", LawRangeWarning, stacklevel=1)
        return constant()

    replace_analysis(analysis)
    summary = run_sweep(study, tmp_path / "out")
    assert dict(summary.statuses)[Status.OUTSIDE_LAW_RANGE] == 96
    assert int(read_results(tmp_path / "out").contact_ratio.notnull().sum()) == 96


def test_stopping_and_resuming_gives_the_same_bytes(study, tmp_path, undisturbed, replace_analysis):
    class Stop(Exception):
        pass

    def stop_at(number):
        def progress(done, total, failed):
            if done >= number:
                raise Stop

        return progress

    out = tmp_path / "out"
    computed = []
    for number in (1, 30, 50):
        with pytest.raises(Stop):
            run_sweep(study, out, resume=True, progress=stop_at(number))
        computed.append(int((read_results(out).status != Status.MISSING).sum()))
    summary = run_sweep(study, out, resume=True)
    assert computed == sorted(set(computed))
    assert summary.before == computed[-1]
    assert summary.before + summary.computed == 120
    assert summary.results.read_bytes() == undisturbed
    again = run_sweep(study, out, resume=True)
    assert (again.computed, again.before) == (0, 120)
    assert again.results.read_bytes() == undisturbed


def test_failed_cases_are_computed_again_on_request(
    study, tmp_path, undisturbed, replace_analysis, monkeypatch
):
    out = tmp_path / "out"
    replace_analysis(lambda variation, settings: constant(contact_ratio=np.nan))
    assert run_sweep(study, out).failed == 120
    monkeypatch.undo()
    assert run_sweep(study, out, resume=True).computed == 0
    summary = run_sweep(study, out, resume=True, retry_failed=True)
    assert (summary.computed, summary.failed) == (120, 24)
    assert summary.results.read_bytes() == undisturbed


def test_a_full_disk_under_the_result_is_told_and_the_store_keeps_all(study, tmp_path, undisturbed):
    def full(path, content):
        raise OSError(errno.ENOSPC, "No space left on device")

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Path, "write_bytes", full)
        with pytest.raises(StorageError, match=r"results\.nc.*No space left.*Free space"):
            run_sweep(study, tmp_path / "out")
    assert [path.name for path in (tmp_path / "out").iterdir()] == ["store.sqlite"]
    summary = run_sweep(study, tmp_path / "out", resume=True)
    assert summary.computed == 0
    assert summary.results.read_bytes() == undisturbed


def test_a_store_is_not_overwritten_by_accident(study, make_study, tmp_path):
    out = tmp_path / "out"
    before = run_sweep(study, out).results.read_bytes()
    with pytest.raises(ParameterError, match="--resume"):
        run_sweep(study, out)
    with pytest.raises(ParameterError, match=r"this very study.*study was changed"):
        run_sweep(make_study(outputs=["base_pitch"]), out, resume=True)
    assert (out / "results.nc").read_bytes() == before


def test_a_second_run_into_the_folder_is_refused(study, tmp_path, undisturbed):
    out = tmp_path / "out"

    def second(done, total, failed):
        if done == 1:
            with pytest.raises(StoreError, match=r"another run is writing.*another --output"):
                run_sweep(study, out, resume=True)

    assert run_sweep(study, out, progress=second).results.read_bytes() == undisturbed


def test_code_that_was_changed_is_refused_unless_told(study, tmp_path, monkeypatch):
    out = tmp_path / "out"

    def stop(done, total, failed):
        if done >= 50:
            raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        old = provenance()._replace(code="0" * 64)
        for module in (workers, stores):
            patch.setattr(module, "provenance", lambda: old)
        with pytest.raises(KeyboardInterrupt):
            run_sweep(study, out, progress=stop)
    with pytest.raises(ParameterError, match="very code"):
        run_sweep(study, out, resume=True)
    assert read_results(out).attrs["code_sha256"] == "0" * 64


def test_a_folder_with_other_things_is_left_alone(study, tmp_path):
    (tmp_path / "thesis.tex").write_text("years of work")
    with pytest.raises(ParameterError, match=r"thesis\.tex"):
        run_sweep(study, tmp_path)
    assert [p.name for p in tmp_path.iterdir()] == ["thesis.tex"]
    (tmp_path / "thesis.tex").rename(tmp_path / "study.toml")
    with pytest.raises(ParameterError, match=r"It holds study\.toml"):
        run_sweep(study, tmp_path)
    assert (tmp_path / "study.toml").read_text() == "years of work"
    (tmp_path / "study.toml").rename(tmp_path / "thesis.tex")
    with pytest.raises(ParameterError, match="A file has that name"):
        run_sweep(study, tmp_path / "thesis.tex")
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / "store.sqlite").touch()
    (tmp_path / "out" / "results.nc").write_text("of somebody else")
    with pytest.raises(ParameterError, match=r"results\.nc of something else"):
        run_sweep(study, tmp_path / "out", resume=True)


def test_a_sweep_runs_outside_the_main_thread(study, tmp_path, undisturbed):
    thread = threading.Thread(target=run_sweep, args=(study, tmp_path / "out"))
    thread.start()
    thread.join(60)
    assert (tmp_path / "out" / "results.nc").read_bytes() == undisturbed


def test_the_lumped_analysis_is_the_speed_sweep(make_study, tmp_path):
    speeds = [1000.0, 2000.0]
    names = ["dte_peak_to_peak", "dte_rms", "normal_load_max", "mesh_efficiency"]
    axis = {"field": "speed_rpm", "values": speeds}
    study = make_study(analysis="lumped", outputs=[*names, "error_estimate"], axes=[axis])
    assert run_sweep(study, tmp_path / "out").failed == 0
    result = read_results(tmp_path / "out")
    expected = speed_sweep(load_gear_pair("nasa_28_28"), speeds)
    for name in names:
        np.testing.assert_array_equal(result[name], expected[name])
    assert (result.error_estimate < 1e-6).all()


def test_the_multibody_analysis_is_the_end_of_the_transient(make_study, tmp_path):
    from multibody import simulate

    names = [
        "dte_rms", "x_p_peak_to_peak", "normal_load_max", "friction_force_peak_to_peak",
        "friction_power_mean",
    ]  # fmt: skip
    study = make_study(
        analysis="multibody",
        outputs=names,
        settings={"cycles": 4, "kept_cycles": 2, "samples_per_cycle": 32},
        axes=[{"field": "speed_rpm", "values": [4000.0]}],
    )
    assert run_sweep(study, tmp_path / "out").failed == 0
    result = read_results(tmp_path / "out").isel(speed_rpm=0)
    pair = load_gear_pair("nasa_28_28").with_(operating__pinion_speed="4000 rpm")
    run = simulate(pair, 4, samples_per_cycle=32, initial="periodic")
    period = geometry(pair).mesh_period
    # Two whole cycles: the sample at the very end is the start of a third one.
    last = run.isel(time=(run.time > 1.99 * period) & (run.time < 3.99 * period))
    assert last.sizes["time"] == 64
    friction = last.friction_force.sum("pair")
    expected = [
        np.sqrt(((last.dte - last.dte.mean()) ** 2).mean()),
        cycle_peak_to_peak(run.isel(time=slice(-65, None)), "x_p"),
        last.normal_load.where(last.contact > 0).max(),
        friction.max() - friction.min(),
        last.friction_power.sum("pair").mean(),
    ]
    # The sum of 64 numbers in another order; the trajectory itself is deterministic.
    assert [float(result[name]) for name in names] == pytest.approx([float(x) for x in expected], rel=1e-12)


def test_the_floquet_analysis_is_the_stability_chart(make_study, tmp_path):
    from floquet import gear_pair_multipliers, scan
    from floquet.gear.axes import vary

    grid = {"speed_rpm": [4000.0, 6000.0], "stiffness_variation": [0.5, 1.0]}
    axes = [{"field": name, "values": values} for name, values in grid.items()]
    study = make_study(
        analysis="floquet", outputs=["spectral_radius", "spectral_radius_error", "verdict"], axes=axes
    )
    assert run_sweep(study, tmp_path / "out").failed == 0
    result = read_results(tmp_path / "out")
    pair = load_gear_pair("nasa_28_28")
    chart = scan(lambda point: gear_pair_multipliers(vary(pair, point), method="gauss"), grid)
    # The analysis takes the compiled route, this chart the general engine: equal to their bounds.
    np.testing.assert_allclose(result.spectral_radius, chart.spectral_radius, rtol=1e-11)
    assert float(result.spectral_radius_error.max()) < 1e-8
    np.testing.assert_array_equal(result.verdict, chart.verdict)
