"""Are the published files those of the program, and do the stated discrepancies hold?"""

import hashlib
import tomllib

import numpy as np
import pytest
import tomli_w

import lumped
import spurcheck
from lumped.errors import ParameterError, StorageError
from validation.check.curves import Curves
from validation.reference_cases import files
from validation.reference_cases.case import reference, reference_names
from validation.reference_cases.definitions import DEFINITIONS
from validation.reference_cases.discrepancy import Discrepancy, discrepancy_of, rounded_up
from validation.reference_cases.files import DATA, INDEX, column_unit, curves_text, index, read_curves
from validation.reference_cases.make import compute, make, statement_of
from validation.signals.complex_orders import common_shift, orders_of_period

BY_NAME = {one.name: one for one in DEFINITIONS}
NAMES = tuple(BY_NAME)


def test_all_cases_are_there_with_licence_and_layout():
    assert spurcheck.reference() == spurcheck.reference_names() == reference_names() == NAMES
    for name in NAMES:
        case = reference(name)
        assert (case.licence, case.schema_version) == ("CC0-1.0", 1)
        assert (case.pair is None) != (case.equation is None)
        assert isinstance(case.curves, Curves)
        assert {one.name for one in case.curves.channels} == set(case.discrepancy)
        assert case.curves.places.size == case.samples_per_cycle * case.mesh_cycles
    assert (DATA / "LICENSE").read_text(encoding="utf-8").startswith("Creative Commons Legal Code\n\nCC0 1.0")


def test_every_file_is_in_the_index_with_its_checksum():
    there = {path.name for path in DATA.iterdir()}
    assert there == {INDEX, *index()}
    for file, digits in index().items():
        assert hashlib.sha256((DATA / file).read_bytes()).hexdigest() == digits, file
    assert sum(path.stat().st_size for path in DATA.iterdir()) < 6.3e6


def test_a_changed_file_is_refused(tmp_path, monkeypatch):
    for path in DATA.iterdir():
        (tmp_path / path.name).write_bytes(path.read_bytes())
    text = (DATA / "mathieu.csv").read_text(encoding="utf-8")
    (tmp_path / "mathieu.csv").write_text(text.replace("6.", "7.", 1), encoding="utf-8")
    monkeypatch.setattr(files, "DATA", tmp_path)
    with pytest.raises(StorageError, match=r"mathieu\.csv was changed"):
        reference("mathieu")


def test_an_unknown_name_is_refused_with_the_nearest():
    with pytest.raises(ParameterError, match=r"reference case = matieu: .*Did you mean 'mathieu'"):
        spurcheck.reference("matieu")
    with pytest.raises(ParameterError, match="reference case = 3: allowed one of meissner"):
        spurcheck.reference(3)


@pytest.mark.slow
@pytest.mark.parametrize("name", NAMES)
def test_a_case_computed_again_keeps_its_stated_discrepancies(name):
    """Curves of the file against every way computed again: the statement rounds up, so no more than stated.

    Another processor or library may round otherwise: 2 % of the discrepancy and the least that is stated.
    """
    case = reference(name)
    computed = compute(BY_NAME[name])
    for channel in case.curves.channels:
        curve = channel.values[:: computed.stride]
        static = computed.static.of_unit(channel.kind.unit.removesuffix("/s"))
        stated = case.discrepancy[channel.name]
        assert any(value is not None for value in vars(stated).values())
        for program, value in vars(stated).items():
            if value is None:
                assert channel.name not in computed.others.get(program, {})
                continue
            other = computed.others[program][channel.name]
            measured = discrepancy_of(curve, other, static, computed.period)
            assert measured <= 1.02 * value + 1e-8, (channel.name, program)
            # The statement is no empty bound: it is what was measured, with two digits.
            assert measured >= 0.85 * value or value < 1e-4, (channel.name, program)
    for variable, value in computed.start.items():
        assert case.start[variable] == pytest.approx(value, rel=1e-6, abs=1e-9)


#: Largest share of the amplitude by which the transmission errors of both programs may differ in a case.
@pytest.mark.parametrize("name", [one.name for one in DEFINITIONS if one.contact])
def test_both_programs_agree_on_the_transmission_error_and_its_phase(name):
    """Half a degree of the first order is a shift of 1/720 cycle: references elsewhere are off by more."""
    assert reference(name).discrepancy["dte"].multibody < 0.04


@pytest.mark.parametrize("name", [one.name for one in DEFINITIONS if one.contact])
def test_time_zero_is_a_tooth_pair_at_A(name):
    """The momentary position of the pair behind is at A at t = 0, by the geometry of the file alone."""
    case = reference(name)
    g = case.pair.geometry
    assert case.mesh_period == pytest.approx(
        2 * np.pi / case.pair.operating.pinion_speed / case.pair.pinion.teeth
    )
    contact = case.pair.mesh.contact
    if contact == "prescribed":  # the stiffness falls where the pair ahead leaves at D
        (stiffness,) = case.curves.of_quantity("mesh_stiffness")
        falls = case.curves.places[1:][np.diff(stiffness.values) < 0.0] / case.mesh_period
        assert falls == pytest.approx([g.contact_ratio - 1.0], abs=1.0 / 4096.0)
    motion = lumped.steady_state(case.pair.healthy, samples_per_cycle=8, supports="springs")
    positions = motion["position"].to_numpy()[:, 0]
    assert np.abs(positions - g.L_XA).min() < 1e-12


def test_contact_is_lost_where_the_name_says_so():
    for name in NAMES:
        (force,) = reference(name).curves.of_quantity("mesh_force")
        share = np.mean(force.values == 0.0)
        assert (share > 0.05) == name.startswith("contact_lost"), name
        assert force.values.min() >= 0.0, name


def test_4096_samples_give_order_40_also_of_a_signal_that_jumps():
    """The orders of a rectangle of the share s are (1 - exp(-2 pi i m s))/(i pi m)."""
    case = reference("meissner")
    (stiffness,) = case.curves.of_quantity("mesh_stiffness")
    share = 0.57
    orders = orders_of_period(stiffness.values / 3.1e8, 40)
    m = orders.orders
    exact = (1.0 - np.exp(-2j * np.pi * m * share)) / (1j * np.pi * m)
    error = np.linalg.norm(orders.values - exact) / np.linalg.norm(exact)
    assert error < 5e-3
    coarse = orders_of_period(stiffness.values[::32] / 3.1e8, 40)  # 128 samples a cycle
    assert np.linalg.norm(coarse.values - exact) / np.linalg.norm(exact) > 10.0 * error


@pytest.mark.parametrize("name", NAMES)
def test_a_curve_shifted_by_a_hundredth_of_a_cycle_is_told(name):
    """The discrepancy sees a phase, and the phase comes back from the curves."""
    case = reference(name)
    (dte,) = case.curves.of_quantity("dte")
    shift = round(0.01 * case.samples_per_cycle)
    shifted = np.roll(dte.values, shift)
    static = abs(dte.values.mean())
    assert discrepancy_of(dte.values, shifted, static, case.mesh_cycles) > 1e-3
    signal, other = (orders_of_period(one, 12, case.mesh_cycles) for one in (dte.values, shifted))
    back = common_shift([signal], [other], [signal.size])
    assert back == pytest.approx(shift / case.samples_per_cycle, abs=1e-4)


def test_a_discrepancy_is_rounded_up_to_two_digits():
    assert [rounded_up(one) for one in (0.03412, 0.0999, 1.21e-5, 2e-9, 0.0)] == [
        0.035,
        0.1,
        1.3e-5,
        1e-8,
        1e-8,
    ]


def test_a_table_of_curves_keeps_eight_digits_of_the_swing():
    time = np.arange(9) * 1.25e-7 / 3.0
    swing = 1e-6 * np.sin(np.arange(9) + 0.1)
    channels = {"dte": swing, "theta_p": 5e-3 - 1e-2 * swing, "mesh_stiffness": np.full(9, 4e8 / 3.0)}
    curves = read_curves(curves_text(time, channels), "test")
    np.testing.assert_allclose(curves.places, time, rtol=1e-9)
    for channel in curves.channels:
        exact = channels[channel.name]
        size = np.ptp(exact) or exact.max()
        np.testing.assert_allclose(channel.values, exact, rtol=0, atol=0.51e-7 * size)
    assert column_unit("mesh_stiffness") == "N/um"


@pytest.mark.parametrize("name", ["meissner", "paper_28_28_law_3"])
def test_making_a_case_again_gives_the_published_bytes(name, tmp_path):
    """On the machine that made them. Elsewhere the last digits may differ: then the numbers are compared."""
    for path in DATA.iterdir():
        (tmp_path / path.name).write_bytes(path.read_bytes())
    make([name], tmp_path)
    curves = files.curves_file(name)
    again, published = ((folder / curves).read_text(encoding="utf-8") for folder in (tmp_path, DATA))
    if again != published:
        ours, theirs = (read_curves(text, name) for text in (again, published))
        for one, other in zip(ours.channels, theirs.channels, strict=True):
            np.testing.assert_allclose(one.values, other.values, rtol=0, atol=1e-6 * np.ptp(other.values))
    stated = statement_of(BY_NAME[name], compute(BY_NAME[name]))
    assert (
        tomllib.loads(tomli_w.dumps(stated)).keys()
        == tomllib.loads((DATA / files.case_file(name)).read_text(encoding="utf-8")).keys()
    )
    made = tomllib.loads((tmp_path / INDEX).read_text(encoding="utf-8"))["sha256"]
    assert made.keys() == index().keys()
    assert made[curves] == hashlib.sha256((tmp_path / curves).read_bytes()).hexdigest()


def test_a_discrepancy_names_its_way():
    case = reference("shafts_46_61")
    assert isinstance(case.discrepancy["x_p"], Discrepancy)
    assert case.discrepancy["x_p"].closed_form is None
    assert reference("mathieu").discrepancy["dte"].closed_form is not None


def test_the_figure_has_a_panel_for_each_channel():
    for name in ("meissner", "own_teeth_20_30"):
        case = reference(name)
        axes = [ax for ax in case.plot().axes if ax.get_visible()]
        assert [ax.get_ylabel().split(" [")[0] for ax in axes] == [one.name for one in case.curves.channels]
        for ax, channel in zip(axes, case.curves.channels, strict=True):
            assert ax.lines[0].get_xdata().size == channel.values.size
