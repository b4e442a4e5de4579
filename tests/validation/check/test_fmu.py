"""Is a functional mock-up unit simulated until it repeats, with its names and units?"""

import importlib.util
import sys

import numpy as np
import pytest

from lumped.errors import ParameterError
from tests.validation.check.known_curves import OTHER, PAIR
from validation.check.reading import fmu
from validation.check.reading.reader import read

#: Co-simulation of a transmission error that settles with a time constant of 15 mesh cycles.
SLAVE = """
import math
from pythonfmu import Fmi2Causality, Fmi2Slave, Real

class Stage(Fmi2Slave):
    def __init__(self, **keywords):
        super().__init__(**keywords)
        self.dte_um = 0.0
        self.phi_p = 0.0
        self.oil = 0.0
        for name in ("dte_um", "phi_p", "oil"):
            self.register_variable(Real(name, causality=Fmi2Causality.output))

    def do_step(self, time, step):
        cycles = (time + step) / {period}
        self.dte_um = 5.0 + 2.0 * math.cos(2.0 * math.pi * cycles) + 3.0 * math.exp(-cycles / 15.0)
        self.phi_p = {omega} * (time + step)
        self.oil = 70.0
        return True
"""


def _needs(*names):
    missing = [name for name in names if importlib.util.find_spec(name) is None]
    return pytest.mark.skipif(bool(missing), reason=f"{', '.join(missing)}: not installed, extra test")


@pytest.fixture
def stage(tmp_path, request):
    from pythonfmu.builder import FmuBuilder

    pair = request.param
    g = pair.geometry
    script = tmp_path / "stage.py"
    script.write_text(SLAVE.format(period=float(g.mesh_period), omega=float(g.omega_pinion)))
    return pair, FmuBuilder.build_FMU(script, dest=tmp_path)


@_needs("fmpy", "pythonfmu")
@pytest.mark.parametrize("stage", [PAIR, OTHER], indirect=True)
def test_an_fmu_is_simulated_until_its_motion_repeats(stage):
    pair, path = stage
    curves = read(path, pair)
    g = pair.geometry
    cycles = curves.places / g.mesh_period
    assert [one.quantity for one in curves.channels] == ["dte", "theta_p"]
    # 3 um exp(-32/15) is more than a thousandth of 4 um, 3 um exp(-128/15) is not.
    assert "over 256 mesh cycles, of which the last 16 are read." in curves.remarks[0]
    assert cycles[-1] == pytest.approx(256.0, rel=1e-9)
    assert cycles[-1] - cycles[0] == pytest.approx(16.0, rel=1e-3)
    # FMPy reads after each communication step; 3 um exp(-240/15) is 3e-13 m.
    expected = 5e-6 + 2e-6 * np.cos(2.0 * np.pi * cycles)
    np.testing.assert_allclose(curves.channels[0].values, expected, atol=1e-12)
    np.testing.assert_allclose(curves.channels[1].values, g.omega_pinion * curves.places, rtol=1e-9)


@_needs("fmpy", "pythonfmu")
@pytest.mark.parametrize("stage", [PAIR], indirect=True)
def test_a_description_names_variables_of_an_fmu(stage):
    pair, path = stage
    text = f"""
name = "stage"
role = "model"
data = "{path.name}"
abscissa = {{ kind = "time", column = "time", unit = "s" }}
channel = [{{ name = "te", column = "dte_um", quantity = "dte", unit = "um", gain = -1 }}]
"""
    description = path.with_suffix(".toml")
    description.write_text(text)
    curves = read(description, pair)
    assert curves.channels[0].values.mean() == pytest.approx(-5e-6, rel=1e-3)
    description.write_text(text.replace('"dte_um"', '"dte_mm"'))
    with pytest.raises(ParameterError, match="Did you mean 'dte_um'"):
        read(description, pair)


@_needs("fmpy")
@pytest.mark.parametrize("content", [b"", b"no archive", b"PK\x05\x06" + bytes(18)])
def test_what_is_no_fmu_is_refused(tmp_path, content):
    (tmp_path / "x.fmu").write_bytes(content)
    with pytest.raises(ParameterError, match="an FMU"):
        read(tmp_path / "x.fmu", PAIR)


def test_without_fmpy_the_refusal_says_what_to_install(tmp_path, monkeypatch):
    (tmp_path / "x.fmu").write_bytes(b"")
    monkeypatch.setitem(sys.modules, "fmpy", None)
    monkeypatch.setattr(fmu.importlib.util, "find_spec", lambda name: None)
    with pytest.raises(ParameterError, match=r"pip install 'spurcheck\[fmu\]'"):
        read(tmp_path / "x.fmu", PAIR)
