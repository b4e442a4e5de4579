"""Is a function of the parameters run with what it needs, and is a wrong one refused by what to write?"""

import numpy as np
import pandas as pd
import pytest

from lumped.errors import ParameterError
from tests.validation.check.known_curves import OTHER, PAIR
from validation.check.curves import Curves
from validation.check.reading.other_model import other_model, parameters_of
from validation.check.reading.reader import read

MODULE = '''
"""A model of two lines."""
import numpy
from beside import AMPLITUDE


def stage(parameters, refine=1):
    import beside  # a module of the folder, imported as the function runs

    steps = 64 * refine
    period = parameters["geometry"]["mesh_period"]
    s = numpy.arange(2 * steps) / steps
    return {"t": s * period, "dte [um]": AMPLITUDE * numpy.cos(2 * numpy.pi * s)}


def _helper(x, y):
    return x
'''


@pytest.fixture
def module(tmp_path):
    (tmp_path / "beside.py").write_text("AMPLITUDE = 3.0\n")
    (tmp_path / "theirs.py").write_text(MODULE)
    return tmp_path / "theirs.py"


def cosine(parameters):
    s = np.arange(33) / 32
    force = parameters["si"]["pinion_torque"] / parameters["geometry"]["base_radius_pinion"]
    return {"mesh cycles": s, "Fm": force * (1.0 + 0.1 * np.cos(2 * np.pi * s))}


@pytest.mark.parametrize("pair", [PAIR, OTHER])
def test_a_function_gets_the_parameters_of_the_pair(pair):
    model = other_model(cosine)
    assert (model.name, model.can_refine) == ("cosine", False)
    curves = model.curves(pair)
    assert isinstance(curves, Curves)
    static = pair.operating.pinion_torque / pair.geometry.base_radius_pinion
    assert curves.of_quantity("mesh_force")[0].values[0] == pytest.approx(1.1 * static, rel=1e-14)
    assert read(cosine, pair).name == "cosine"


def test_parameters_are_those_of_the_file_and_three_sections_in_si():
    parameters = parameters_of(OTHER)
    assert parameters["pinion"]["teeth"] == OTHER.pinion.teeth
    assert parameters["operating"]["pinion_speed"] == pytest.approx(OTHER.operating.pinion_speed * 30 / np.pi)
    assert parameters["si"]["pinion_speed"] == OTHER.operating.pinion_speed
    assert parameters["bodies"]["inertia_gear"] > 0.0
    assert parameters["geometry"]["mesh_period"] == OTHER.geometry.mesh_period


def test_a_function_of_a_module_file_runs_and_divides_its_step(module):
    model = other_model(f"{module}:stage")
    assert model.can_refine
    coarse, fine = (model.curves(PAIR, refine=n).channels[0].values for n in (1, 4))
    assert fine.size == 4 * coarse.size
    np.testing.assert_allclose(fine[::4], coarse, atol=1e-20)
    assert coarse[0] == pytest.approx(3e-6, rel=1e-15)


def test_data_are_no_model(module, tmp_path):
    for data in ("curves.csv", tmp_path / "x.mat", {"time": [1.0]}, pd.DataFrame(), "C:\\models\\out.csv"):
        assert other_model(data) is None


class Returned:
    """Callable object with what it returns."""

    def __init__(self, result):
        self.result = result

    def __call__(self, parameters):
        if isinstance(self.result, Exception):
            raise self.result
        return self.result


def _no_arguments():
    return {}


def _two_arguments(parameters, step):
    return {}


@pytest.mark.parametrize(("theirs", "words"), [
    (Returned(None), "Return {'time': t, 'dte': dte}"),
    (Returned(cosine), "Return {'time': t, 'dte': dte}"),
    (Returned(3.0), "a mapping from names to arrays"),
    (Returned({}), "a column with one of time"),
    (Returned(KeyError("pinion_teeth")), "KeyError: 'pinion_teeth'"),
    (_no_arguments, "Write def f(parameters)"),
    (_two_arguments, "Write def f(parameters)"),
])  # fmt: skip
def test_a_wrong_function_is_refused_with_what_to_write(theirs, words):
    with pytest.raises(ParameterError) as refused:
        read(theirs, PAIR)
    assert words in str(refused.value)


@pytest.mark.parametrize(("end", "words"), [
    (":stge", "Did you mean 'stage'?"),
    (":_nothing", "one of stage"),
    ("", "theirs.py:stage"),
])  # fmt: skip
def test_a_wrong_name_of_a_function_is_refused_with_the_names(module, end, words):
    with pytest.raises(ParameterError) as refused:
        read(f"{module}{end}", PAIR)
    assert words in str(refused.value)


def test_modules_that_cannot_be_imported_are_refused(tmp_path):
    (tmp_path / "broken.py").write_text("import nothing_of_this_name\n")
    with pytest.raises(ParameterError, match="No module named 'nothing_of_this_name'"):
        read(f"{tmp_path / 'broken.py'}:f", PAIR)
    with pytest.raises(ParameterError, match="a Python file that exists"):
        read(f"{tmp_path / 'none.py'}:f", PAIR)


def test_a_step_cannot_be_divided_without_the_keyword():
    with pytest.raises(ParameterError, match="refine=1"):
        other_model(cosine).curves(PAIR, refine=2)
