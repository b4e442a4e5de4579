"""Do both routes to the multipliers agree, and does an error of 1 % in one coefficient part them?"""

import dataclasses

import pytest

import lumped
import multibody
from tests.evidence import stability_routes as routes
from tests.evidence.stability_routes import fit_bound, stability_routes


@pytest.fixture(scope="module")
def flow(pair):
    return multibody.monodromy(pair, fidelity="linear")


@pytest.fixture
def one_flow(flow, monkeypatch):
    """The flow map of the multibody model, run once."""
    monkeypatch.setattr(multibody, "monodromy", lambda *_, **__: flow)


def of_gains(name):
    def changed(block):
        values = getattr(block.gains, name).copy()
        values[:, 1] *= 1.01  # on the pinion's centre
        return dataclasses.replace(block, gains=dataclasses.replace(block.gains, **{name: values}))

    return changed


def of_block(name, place):
    def changed(block):
        values = getattr(block, name).copy()
        values[place] *= 1.01
        return dataclasses.replace(block, **{name: values})

    return changed


COEFFICIENTS = {
    "bearing stiffness": of_block("stiffness", 1), "bearing damping": of_block("damping", 2),
    "lever of the transmission error": of_block("v", 0), "mesh stiffness over mass": of_gains("w"),
    "mesh damping over mass": of_gains("wd"),
}  # fmt: skip


@pytest.mark.parametrize("name", COEFFICIENTS)
def test_one_percent_of_one_coefficient_of_the_kernel_is_seen(pair, one_flow, monkeypatch, name):
    true = routes.gear_block
    monkeypatch.setattr(routes, "gear_block", lambda pair: COEFFICIENTS[name](true(pair)))
    whole, compiled, *_ = stability_routes(pair)
    assert whole.passes
    assert compiled.value > 10 * compiled.limit


def test_one_percent_of_the_lumped_masses_is_seen_in_the_whole_matrix(pair, one_flow, monkeypatch):
    true = routes.gear_pair_system

    def heavier(pair, form):
        mass = pair.with_({"pinion.mass": 1.01 * lumped.bodies(pair).mass_pinion})
        return true(mass, form)

    monkeypatch.setattr(routes, "gear_pair_system", heavier)
    whole, compiled, *_ = stability_routes(pair)
    assert whole.value > 10 * whole.limit
    assert compiled.passes


def test_a_bound_without_the_misfit_of_the_polynomials_is_exceeded(pair, monkeypatch):
    assert 0.01 < fit_bound(pair).value <= 1.0
    true = routes.gear_block

    def without(pair):
        block = true(pair)
        none = dataclasses.replace(block.gains, fit_errors=0.0 * block.gains.fit_errors)
        return dataclasses.replace(block, gains=none)

    monkeypatch.setattr(routes, "gear_block", without)
    assert not fit_bound(pair).passes
