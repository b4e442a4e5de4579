"""Does ``spurcheck reference`` list and write the cases, and refuse what it must not write?"""

import hashlib

import pytest
from typer.testing import CliRunner

import lumped
from validation.cli import app
from validation.reference_cases.case import reference, reference_names
from validation.reference_cases.files import index

RUNNER = CliRunner()


def run(*arguments):
    return RUNNER.invoke(app, ["reference", *arguments], env={"COLUMNS": "200"})


@pytest.mark.parametrize("arguments", [(), ("--list",)])
def test_all_cases_are_listed(arguments):
    result = run(*arguments)
    assert result.exit_code == 0
    for name in reference_names():
        assert name in result.output


def test_a_case_is_described_with_its_discrepancies():
    result = run("contact_lost_43_22")
    assert result.exit_code == 0
    assert "multibody" in result.output
    assert "closed form" not in result.output
    assert f"{100 * reference('contact_lost_43_22').discrepancy['dte'].multibody:.2g} %" in result.output
    assert "< 0.001 %" in result.output


@pytest.mark.parametrize("name", ["tip_relief_33_35", "sliding_friction"])
def test_a_case_is_written_and_not_written_over(name, tmp_path):
    folder = tmp_path / "new" / "case"
    result = run(name, "-o", str(folder))
    assert result.exit_code == 0, result.output
    written = {path.name for path in folder.iterdir()}
    with_pair = {f"{name}.toml"} if reference(name).pair is not None else set()
    assert written == {f"{name}.case.toml", f"{name}.csv", f"{name}.svg", "LICENSE"} | with_pair
    for file in written - {f"{name}.svg"}:
        assert hashlib.sha256((folder / file).read_bytes()).hexdigest() == index()[file]
    for file in with_pair:
        assert lumped.load_gear_pair(folder / file) == reference(name).pair
    assert run(name, "-o", str(folder)).exit_code == 2
    assert "--force" in run(name, "-o", str(folder)).output
    (folder / f"{name}.csv").write_text("changed")
    assert run(name, "-o", str(folder), "--force").exit_code == 0
    assert hashlib.sha256((folder / f"{name}.csv").read_bytes()).hexdigest() == index()[f"{name}.csv"]


def test_mistakes_are_refused(tmp_path):
    unknown = run("own_teeth")
    assert unknown.exit_code == 2
    assert "Did you mean 'own_teeth_20_30'" in unknown.output
    nameless = run("-o", str(tmp_path / "case"))
    assert nameless.exit_code == 2
    assert "NAME" in nameless.output
    file = tmp_path / "file"
    file.write_text("")
    assert run("mathieu", "-o", str(file)).exit_code == 2
