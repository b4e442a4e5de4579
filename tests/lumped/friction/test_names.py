"""Is a law found under every name that tables, reports and people give it, and refused under any other?"""

import pytest

import floquet
from lumped.errors import ParameterError
from lumped.friction.registry import LAWS, law_named

NAMES = [
    (law.name, spelled)
    for law in LAWS.values()
    for text in (law.name, law.label, law.numeral, law.title)
    for spelled in (text, text.upper(), text.lower(), text.replace("-", " "), f"law {text}")
    if text
]


@pytest.mark.parametrize(("name", "spelled"), NAMES)
def test_a_law_is_found_as_tables_and_reports_call_it(nasa, name, spelled):
    assert law_named(spelled) is LAWS[name]
    assert nasa.with_(friction__law=spelled).friction.law == name


@pytest.mark.parametrize("text", ["VI", "", "2", "coulombs law of 1785", "friction"])
def test_any_other_name_is_refused_with_the_list(nasa, text):
    with pytest.raises(ParameterError, match="one of none, coulomb"):
        nasa.with_(friction__law=text)


def test_charts_take_every_name_too(nasa):
    axes = {"speed_rpm": [4000.0, 5000.0]}
    chart = floquet.stability_chart(nasa, axes, friction_law="II")
    assert chart.attrs["friction_law"] == "benedict_kelley"
