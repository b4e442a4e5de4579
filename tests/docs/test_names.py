"""Is every variable of a result on the page of names, with its unit? Do the places that it names exist?"""

import re
from dataclasses import dataclass
from functools import cache

import pytest

import floquet
import lumped
import multibody
from tests.docs.conftest import ROOT
from tests.unlike_pairs import unlike_pair
from validation.prediction.motion import predict

PAGE = "docs/reference/names.md"
#: "| symbol | `name` (dimensions) | unit | meaning | `file`, `function` |"; a name may be two, `a`, `b`.
_ROW = re.compile(
    r"^\|(?P<symbol>[^|]*)\| (?P<names>`[^|]+) \| (?P<unit>[^|]+) \| (?P<meaning>(?:\\\||[^|])+) "
    r"\| `(?P<file>[^`]+)`, `(?P<function>\w+)` \|$"
)


@dataclass(frozen=True)
class Row:
    """A row of the page."""

    names: tuple[str, ...]
    unit: str
    file: str
    function: str
    line: int


@cache
def rows() -> tuple[Row, ...]:
    result = []
    for number, line in enumerate((ROOT / PAGE).read_text(encoding="utf-8").splitlines(), 1):
        if not line.startswith("|") or line.startswith(("| symbol", "|---")):
            continue
        match = _ROW.match(line)
        assert match, (
            f"{PAGE}, line {number}: write | symbol | `name` | unit | meaning | `file`, `function` |"
        )
        names = tuple(re.findall(r"`(\w+)`", match["names"]))
        result.append(Row(names, match["unit"].strip(), match["file"], match["function"], number))
    return tuple(result)


def test_every_file_and_function_of_the_page_exists():
    wrong = []
    for row in rows():
        place = f"{PAGE}, line {row.line}: {', '.join(row.names)}"
        path = ROOT / row.file
        if not path.exists():
            wrong.append(f"{place}: {row.file} is gone; write the file that makes the quantity now")
            continue
        made = rf"^\s*(?:def|class) {row.function}\b|^{row.function}\b.*="
        if not re.search(made, path.read_text(encoding="utf-8"), re.MULTILINE):
            wrong.append(f"{place}: {row.file} has no `{row.function}`; write its new name or its new file")
    assert not wrong, "\n".join(wrong)


def of_chart(pair):
    """With the cells of a proof and the regions of a chart. Friction that does not move is proven soonest."""
    pair = pair.with_({"friction.law": "coulomb", "friction.coefficient": 0.05})
    axes = {"speed_rpm": [1000.0, 1200.0], "damping_ratio": [0.05, 0.1]}
    proven = floquet.stability_chart(pair, axes, refine=False, prove=True)
    names = {*proven.variables}
    assert {"cell_verdict", "region_label"} <= names
    return proven


DATASETS = {
    "lumped.steady_state": lumped.steady_state,
    "lumped.simulate": lambda pair: lumped.simulate(pair, cycles=1),
    "predict().cycle": lambda pair: predict(pair).cycle,
    "multibody.simulate": lambda pair: multibody.simulate(pair, cycles=1),
    "floquet.stability_chart": of_chart,
    "lumped.static_transmission_error": lumped.static_transmission_error,
}


@pytest.mark.parametrize("function", DATASETS)
def test_every_variable_of_a_result_is_on_the_page_with_its_unit(function):
    data = DATASETS[function](unlike_pair("rack_25_degrees_always_pushing"))
    on_page = {(name, row.unit) for row in rows() for name in row.names}
    wrong = []
    for name, variable in data.variables.items():
        unit = variable.attrs.get("units", "text")
        if (name, unit) not in on_page:
            units = sorted(other for one, other in on_page if one == name)
            now = f"has the unit {' and '.join(units)} there" if units else "is missing there"
            wrong.append(f"{name} [{unit}] of {function} {now}")
    advice = f"Add or mend its row in {PAGE}: | symbol | `name` | unit | meaning | `file`, `function` |."
    assert not wrong, "\n".join([*wrong, advice])
