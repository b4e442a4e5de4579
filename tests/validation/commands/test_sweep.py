"""Does ``spurcheck sweep`` do what its options say, and does its exit code?"""

import pytest

from validation.studies import read_results, runner

from .conftest import run as invoke

OK = 0
FAILED = 1
REFUSED = 2
STOPPED = 3
INTERRUPTED = 130

STUDY = """
name = "command [red]"
gear_pair = "nasa_28_28"
analysis = "geometry"
outputs = ["contact_ratio"]
[[axes]]
field = "centre_distance"
values = {values}
"""


@pytest.fixture
def command(tmp_path, monkeypatch):
    """Run the command on a study with the given distances; returns exit code and what was printed."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "study.toml").write_text(STUDY.format(values=[88.9, 89.0, 89.1]))

    def run(values=None, **options):
        if values is not None:
            (tmp_path / "study.toml").write_text(STUDY.format(values=values))
        words = ["sweep", "study.toml"]
        for name, value in ({"workers": 0} | options).items():
            if value is None:
                continue
            words += [f"--{name.replace('_', '-')}", *([] if value is True else [str(value)])]
        result = invoke(*words)
        return result.exit_code, result.output

    return run


def test_a_study_is_counted_computed_and_resumed(command, tmp_path):
    code, text = command(dry_run=True)
    assert (code, "command [red]: 3 cases, geometry" in text) == (OK, True)
    assert "hours in all on 1 worker" in text
    assert sorted(p.name for p in tmp_path.iterdir()) == ["study.toml"]
    code, text = command()
    assert code == OK
    assert "3 computed, 0 kept from before" in text
    assert read_results(tmp_path / "study-sweep").contact_ratio.notnull().all()
    code, text = command()
    assert (code, "--resume" in text) == (REFUSED, True)
    code, text = command(resume=True)
    assert code == OK
    assert "0 computed, 3 kept from before" in text


def test_a_failed_case_is_1_and_listed(command):
    code, text = command([88.5, 88.9])
    assert code == FAILED
    assert "case 0: " in text
    assert "refused" in text


@pytest.mark.parametrize("options", [{"workers": 1025}, {"case_seconds": 1e-9}])
def test_refused_options_leave_the_folder_free(command, options):
    assert command(**options)[0] == REFUSED
    assert command()[0] == OK


@pytest.mark.parametrize(("options", "words"), [
    ({"cluster": "head"}, "--cluster = head: allowed tcp://HOST:PORT"),
    ({"cluster": "local:2", "workers": 2}, "--workers = 2: allowed none with --cluster"),
    ({"wait_seconds": 5}, "--wait-seconds = 5.0: allowed none without --cluster"),
])  # fmt: skip
def test_a_refused_cluster_leaves_no_folder(command, tmp_path, options, words):
    code, text = command(**{"workers": None} | options)
    assert code == REFUSED
    assert words in text
    assert not (tmp_path / "study-sweep").exists()


def test_a_store_that_cannot_be_written_is_3(command, tmp_path):
    (tmp_path / "out" / "store.sqlite").mkdir(parents=True)
    code, text = command(output=tmp_path / "out", resume=True)
    assert code == STOPPED
    assert "unable to open" in text


def test_ctrl_c_is_130_and_says_how_to_go_on(command):
    def interrupt(*arguments, **options):
        raise KeyboardInterrupt

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(runner, "chunks_of", interrupt)
        code, text = command()
    assert code == INTERRUPTED
    assert "--resume" in text
    assert command(resume=True)[0] == OK
