"""Does everything that the documentation tells a reader to type do what it says?"""

import inspect
import re
import shlex
import shutil
import subprocess
import tomllib
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest
import scipy.io
import yaml
from typer.main import get_command
from typer.testing import CliRunner

import lumped
from tests.docs.own_models import write_own_models, write_record
from validation.check.reading.description import described
from validation.cli import app
from validation.commands import response
from validation.cross_check import comparison
from validation.exchange import write_results, write_rexs, write_state_space
from validation.interactive import write_interactive_page
from validation.interactive.results import Sampling

#: Commands that take longer than a few seconds or need a cluster: only their arguments are checked. That
#: reports are written and compared, and that records calibrate a pair, is tested in tests/validation.
NOT_RUN = re.compile(r"spurcheck ((report|figures|interactive|calibrate) |sweep .*--cluster)")
#: What makes a stability chart small: tests/validation/commands judges the numbers, here the words matter.
SMALL = {"speed_rpm": "speed_rpm=16000:19000:9", "damping_ratio": "damping_ratio=0:0.02:5"}
AXES_OF_VIEW = {"chart": SMALL, "campbell": ["speed_rpm"], "boundaries": ["speed_rpm"]}
#: Commands that are meant to be refused.
REFUSED = re.compile(r"centre_distance=80$")
#: What makes an interactive page small: tests/validation/interactive judges it.
COARSE = Sampling(speeds=5, dampings=2, slices=2, sweep_speeds=3)
COMMAND = get_command(app)
CLUSTER = "docs/how_to/cluster.md"


def parsed(line: str) -> None:
    """Let the command's own parser read a line; it raises a usage error for what it does not know."""
    name, *arguments = shlex.split(line)[1:]
    command = COMMAND.commands[name]
    command.make_context(name, arguments)


def inline_commands(page: Path, blocks) -> list[str]:
    """Commands in running text, and those of workflow files."""
    text = page.read_text(encoding="utf-8")
    found = re.findall(r"`(spurcheck [a-z][^`\n]*)`", re.sub(r"^```.*?^```$", "", text, flags=re.M | re.S))
    for block in blocks(page):
        if block.language == "yaml":
            steps = [step for job in yaml.safe_load(block.text)["jobs"].values() for step in job["steps"]]
            runs = [step["run"].replace("${{ matrix.pair }}", "mypair") for step in steps if "run" in step]
            found += [run for run in runs if run.startswith("spurcheck")]
    return [line for line in found if "COMMAND" not in line and "<" not in line]


def test_commands_in_running_text_are_understood(page, blocks):
    for line in inline_commands(page, blocks):
        try:
            parsed(line)
        except Exception as error:
            # Prose may name a command or an option without its value.
            if type(error).__name__ != "MissingParameter" and "requires an argument" not in str(error):
                raise


@pytest.fixture(scope="session")
def belongings(tmp_path_factory, root, blocks) -> Path:
    """What pages take for granted: the reader's parameter file, his gear program's file, his study."""
    folder = tmp_path_factory.mktemp("belongings")
    # With its relief contact would be lost, which the cross-check does not confirm.
    pair = lumped.load_gear_pair("nasa_28_28").with_(mesh__relief="ignored")
    (folder / "mypair.toml").write_text(pair.to_toml())
    (folder / "my_pair.toml").write_text(pair.to_toml())
    write_rexs(
        lumped.load_gear_pair("fzg_c"), folder / "gearbox.rexs"
    )  # a pair that the cross-check confirms
    write_state_space(pair, folder / "averaged.npz")
    np.savez(folder / "rotor.npz", M=1.0, C=0.1, K=100.0, K_cos_1=0.1, period=0.2)
    write_record(pair, folder)
    write_own_models(pair, folder)
    (folder / "study-sweep").mkdir()
    for result in ("run.nc", "study-sweep/results.nc"):
        write_results(lumped.simulate(pair, cycles=1), folder / result)
    (study,) = (b.text for b in blocks(root / CLUSTER) if b.text.startswith("# study.toml"))
    (folder / "study.toml").write_text(study)
    return folder


@pytest.fixture(scope="session")
def done() -> set[str]:
    """Cross-checks of the reader's pair, which is the preset: several pages show them, one runs them."""
    return set()


#: Files that a page says it writes, and a number that it says it prints.
SAID = {
    "docs/tutorial/in_python.md": ({"steady.png", "chart.png", "waterfall.png"}, "4875.0"),
    "docs/tutorial/own_system.md": (
        {"mathieu.png", "blade.png", "blade_multipliers.png", "crack.png"}, "-0.5",
    ),
}  # fmt: skip

#: Pages on checks: each line of a block of text is the beginning of an answer that is printed.
CHECKS = (
    "check_your_model.md", "check_matlab.md", "check_multibody.md", "check_ross.md", "check_statespace.md",
)  # fmt: skip


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore::lumped.LawRangeWarning")
def test_a_page_works_from_top_to_bottom(page, blocks, root, tmp_path, monkeypatch, capsys, belongings, done):
    """Blocks run in order, in one folder and one Python session, as a reader would."""
    if not any(block.language in ("sh", "python") for block in blocks(page)):
        return
    shutil.copytree(belongings, tmp_path, dirs_exist_ok=True)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setitem(inspect.unwrap(write_interactive_page).__kwdefaults__, "sampling", COARSE)
    monkeypatch.setattr(response, "_LINEAR_SPEEDS", 9)
    # The variant is judged in tests/validation/cross_check.
    monkeypatch.setitem(inspect.unwrap(comparison.crosscheck).__kwdefaults__, "variant", False)
    monkeypatch.syspath_prepend(tmp_path)
    session: dict[str, object] = {}
    printed = ""
    for block in blocks(page):
        if block.language == "sh":
            printed += "".join(run(line, root, done) for line in block.commands)
        elif block.language == "python":
            if name := re.match(r"# (\w+\.py)\n", block.text):
                Path(name[1]).write_text(block.text)
            exec(compile(block.text, str(page), "exec"), session)
        elif block.language == "toml" and (name := re.match(r"# (\w+\.toml)\n", block.text)):
            Path(name[1]).write_text(block.text)
    printed += capsys.readouterr().out
    files, number = SAID.get(page.relative_to(root).as_posix(), (set(), ""))
    assert files <= {path.name for path in tmp_path.iterdir()}
    assert number in printed
    if page.name in CHECKS:
        answers = [
            line for block in blocks(page) if block.language == "text" for line in block.text.splitlines()
        ]
        words = " ".join(printed.replace("\u00a0", " ").split())
        assert answers
        assert [answer for answer in answers if answer not in words] == []


def shortened(arguments: list[str]) -> list[str]:
    """The same line with less to compute.

    A stability chart has a few nodes on every axis, a cross-check runs for fewer cycles, a sweep starts no
    processes, branches of motions and jump maps cover a small range, few samples are predicted.
    """
    quicker = {"crosscheck": ["--cycles", "8", "--samples", "64"], "sweep": ["--workers", "0"]}
    quicker["uncertainty"] = quicker["compare"] = ["--samples", "16"]
    quicker["check"] = ["--budget", "2"]
    quicker["response"] = ["--periods", "1", "--seeds", "0", "--speeds", "3", "--range", "12000..12100"]
    most = 2 if arguments[0] in ("response", "floquet") else 5
    arguments = [
        re.sub(r"(?<=:)\d+$", lambda nodes: str(min(int(nodes[0]), most)), word) if "=" in word else word
        for word in arguments
    ]
    extra = quicker.get(arguments[0], [])
    if arguments[0] == "stability" and "--speed" not in arguments:
        view = arguments[arguments.index("--view") + 1] if "--view" in arguments else "chart"
        given = {axis.split("=")[0] for axis in arguments if "=" in axis and ":" in axis}
        axes = AXES_OF_VIEW.get(view, []) if view in ("campbell", "boundaries") or not given else []
        return arguments + [word for axis in axes if axis not in given for word in ("--axis", SMALL[axis])]
    return arguments + [word for word in extra if extra[0] not in arguments]


def run(line: str, root: Path, done: set[str]) -> str:
    """Run one line and return its output; what is not the program's own is checked as far as possible."""
    program, *arguments = shlex.split(line)
    if program == "spurcheck":
        parsed(line)
        same = line.replace("mypair.toml", "nasa_28_28 --set mesh.relief=ignored")
        if NOT_RUN.search(line) or same in done:
            return ""
        if arguments[0] == "crosscheck":
            done.add(same)
        force = ["--force"] if arguments[0] in ("init", "simulate", "stability", "floquet", "export") else []
        result = CliRunner().invoke(app, shortened(arguments) + force)
        # 4: the models differ, a finding about the model.
        differ = arguments[0] in ("crosscheck", "check")
        expected = (2,) if REFUSED.search(line) else (0, 4) if differ else (0,)
        assert result.exit_code in expected, f"{line}\n{result.output}\n{result.exception!r}"
        return result.output
    elif program == "make":
        subprocess.run(["make", "-n", *arguments], cwd=root, check=True, capture_output=True)
    elif program in ("python", "python3", "pytest"):
        if "-m" in arguments:
            assert find_spec(arguments[arguments.index("-m") + 1]), line
        for path in (a.split("::")[0] for a in arguments if a.endswith(".py") or a.startswith("tests/")):
            assert (root / path).exists(), line
    else:
        known = (".", "export", "git", "pip", "ruff", "mypy", ".ci/run")
        assert program in known, f"nobody checks {line!r}"
    return ""


def test_the_stiffness_table_of_the_guide_is_read(blocks, root, tmp_path):
    page = blocks(root / "docs/how_to/own_laws.md")
    (table,) = (b.text for b in page if "stiffness [N/um]" in b.text)
    (section,) = (b.text for b in page if "[mesh]" in b.text)
    (tmp_path / "curve.csv").write_text(table)
    data = lumped.load_gear_pair("nasa_28_28").to_mapping()
    data["mesh"] |= tomllib.loads(section)["mesh"]
    data["mesh"]["stiffness"]["file"] = str(tmp_path / "curve.csv")
    pair = lumped.load_gear_pair(data)
    # The printed peak, 90.4 N/um at 15.2 mm, in SI.
    assert max(pair.mesh.stiffness.stiffness) == pytest.approx(90.4e6)


def test_the_table_of_the_guide_is_what_its_lines_print(blocks, root, tmp_path, monkeypatch, capsys):
    page = blocks(root / "docs/how_to/from_the_drawing.md")
    monkeypatch.chdir(tmp_path)
    (line,) = (line for b in page if b.language == "sh" for line in b.commands)
    run(line, root, set())
    session: dict[str, object] = {}
    printed = []
    for block in (b for b in page if b.language == "python"):
        capsys.readouterr()
        exec(compile(block.text, "from_the_drawing", "exec"), session)
        printed.append(capsys.readouterr().out)
    (table,) = (b.text for b in page if b.language == "text")
    assert printed[0].strip() == table.strip()
    (said,) = (re.findall(r"# (0\.\d+)$", b.text, re.M) for b in page if "shift_from_balls(" in b.text)
    assert [f"{float(value):.4f}" for value in printed[1].split()] == said
    (limits,) = (tomllib.loads(b.text) for b in page if b.language == "toml")
    pair = lumped.load_gear_pair("sun_planet.toml").with_(limits)
    assert dict(pair.uncertainty) == limits["uncertainty"]


def test_the_record_of_the_guide_is_valid(blocks, root):
    page = blocks(root / "docs/how_to/measured_data.md")
    (text,) = (b.text for b in page if b.language == "toml")
    assert described(tomllib.loads(text), "page").channel[0].quantity == "normal_load"


def test_the_variables_that_matlab_saves_are_those_of_the_file_that_is_checked(blocks, root, belongings):
    page = [b.text for b in blocks(root / "docs/how_to/check_matlab.md") if b.language == "matlab"]
    saved = [re.findall(r"'(\w[\w ]*)'", line) for text in page for line in re.findall(r"save\((.*)\)", text)]
    names = [name for name, _, _ in scipy.io.whosmat(belongings / "model.mat")]
    assert sorted(saved[0]) == sorted(names)
    assert scipy.io.whosmat(belongings / "simulink.mat")[0][0] in saved[1]


def test_the_design_of_the_guide_is_valid(blocks, root):
    from validation.studies import load_study

    page = [b.text for b in blocks(root / CLUSTER) if b.language == "toml"]
    study, design = (tomllib.loads(text) for text in page)
    study["axes"] = study["axes"][:1]  # indices need numbers that can be sampled
    study["axes"][0].pop("count", None)
    assert load_study(study | design).design.sensitivity


def test_shell_blocks_are_found(blocks, root):
    """An extraction that finds nothing would pass every page."""
    readme = [line for b in blocks(root / "README.md") if b.language == "sh" for line in b.commands]
    assert any(line.startswith("spurcheck report") for line in readme)
