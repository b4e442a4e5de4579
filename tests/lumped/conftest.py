"""Gear pairs and schema introspection shared by the tests of the lumped model."""

import copy
import math
from typing import get_origin

import numpy as np
import pytest

from lumped import load_gear_pair
from lumped.fields.units import Quantity
from tests.unlike_pairs import unlike_pair


def _quantities(model, prefix=""):
    """Every quantity field of the schema, through unions, as (dotted path, Quantity)."""
    from lumped.fields.refusals import models_in

    for name, info in model.model_fields.items():
        quantity = next((m for m in info.metadata if type(m) is Quantity), None)
        if quantity is not None:
            yield f"{prefix}{name}", quantity
        entry = "0." if get_origin(info.annotation) is tuple else ""
        for inner in models_in(info.annotation):
            yield from _quantities(inner, f"{prefix}{name}.{entry}")


@pytest.fixture(scope="session")
def nasa():
    """The default pair with involute flanks: what these tests know of it has no relief."""
    return load_gear_pair("nasa_28_28").with_(mesh__contact="prescribed", mesh__relief="ignored")


def as_published(name, **changes):
    """One of the unlike pairs as the literature models it: like teeth without relief, prescribed contact."""
    published = {"mesh.contact": "prescribed", "mesh.relief": "ignored", "shafts": None}
    return unlike_pair(name).healthy.with_(published | changes)


@pytest.fixture(scope="session")
def published(unlike):
    """Each unlike pair in the form of the literature, with its own stiffness model and law of friction."""
    return as_published(unlike.name)


@pytest.fixture(scope="session")
def coulomb_pair():
    """43 teeth drive 22, law I with a round coefficient."""
    return as_published("larger_gear_drives_contact_lost", friction={"law": "coulomb", "coefficient": 0.05})


@pytest.fixture(scope="session")
def unequal():
    """23/38 from a 25-degree rack: no two numbers of pinion and gear are alike."""
    return as_published(
        "rack_25_degrees_always_pushing",
        **{"friction": {"law": "coulomb", "coefficient": 0.08}, "mesh.stiffness": {"model": "parabolic"}},
    )


@pytest.fixture(scope="session")
def high_contact():
    """46/61 with a contact ratio of 2.28 on springs, law I."""
    return as_published("contact_ratio_2_3_on_shafts", friction={"law": "coulomb", "coefficient": 0.05})


@pytest.fixture(scope="session")
def shaft_tables():
    """Shafts in file units: every field is there, and no two of a kind are alike."""
    pinion = {
        "segments": [{"length": 40.3, "diameter": 30, "bore": 10}, {"length": 230, "diameter": 28.3}],
        "gear_position": 90.1,
        "bearings": [{"position": 30.1, "loa_stiffness": 2e8, "oloa_stiffness": 1.7e8, "loa_damping": 50.3},
         {"position": "15.1 cm", "loa_stiffness": 3e8, "oloa_stiffness": 2.3e8, "oloa_damping": 30}],
    }  # fmt: skip
    one = {"position": 7.3, "loa_stiffness": 1e8, "oloa_stiffness": "100 N/um", "tilt_stiffness": 2e4}
    steel = {"youngs_modulus": 210, "poisson_ratio": 0.29, "density": 7800.1}
    gear = {"segments": [{"length": 150, "diameter": 50.3}], "gear_position": 77, "bearings": [one]} | steel
    motor = {"position": 0, "inertia": 0.0113, "coupling_stiffness": 1.1e5, "coupling_damping": 0.3}
    load = {"position": 150, "inertia": 0.31, "coupling_stiffness": "2.3 kN*m/deg"}
    modes = {"damping_ratio": 0.013, "max_frequency": "5 kHz"}
    return modes | {"pinion": pinion, "gear": gear, "motor": motor, "load": load}


@pytest.fixture(scope="session")
def edited(nasa):
    """Function: the default pair's file data with one field replaced (or deleted by ``...``)."""

    def edit(path, value):
        data = copy.deepcopy(nasa.to_mapping())
        *parents, leaf = path.split(".")
        node = data
        for part in parents:
            node = node.setdefault(part, {})
        if value is ...:
            node.pop(leaf)
        else:
            node[leaf] = value
        return data

    return edit


@pytest.fixture(scope="session")
def written_out():
    """Function: accelerations of eqs. 1 to 9 (docs/theory/equations.md), typed in here, one line each."""

    def accelerations(pair, geometry, masses, t, state, elements, torque, brake):
        """Elements are k, c, mu, e over xi; state is theta_p, theta_g, x_p, x_g, y_p, y_g and rates."""
        k = elements.stiffness
        c = elements.damping
        mu = elements.friction
        e = elements.error
        e_slope = e.slope
        th_p, th_g, x_p, x_g, y_p, y_g, dth_p, dth_g, dx_p, dx_g, dy_p, dy_g = state
        r_bp = geometry.base_radius_pinion
        r_bg = geometry.base_radius_gear
        lam = geometry.base_pitch
        omega = geometry.omega_pinion
        delta = r_bp * th_p - r_bg * th_g + x_p - x_g
        rate = r_bp * dth_p - r_bg * dth_g + dx_p - dx_g
        n = math.floor(geometry.contact_ratio)
        sum_n = sum_f = sum_pf = sum_gf = 0.0
        for i in range(n + 1):
            xi = geometry.L_XA + (n - i) * lam + (omega * r_bp * t) % lam
            if not geometry.L_XA <= xi <= geometry.L_XD:
                continue
            error_rate = float(e_slope(xi)) * omega * r_bp
            load = float(k(xi)) * (delta - float(e(xi))) + float(c(xi)) * (rate - error_rate)
            force = float(mu(xi)) * load
            sum_n += load
            sum_f += force
            sum_pf += xi * force
            sum_gf += (geometry.L_XY - xi) * force
        m_p, m_g, j_p, j_g = masses

        def support_force(gear, direction, mass, x, rate):
            """Force of a bearing on its gear."""
            b = getattr(pair.bearings, gear)
            stiffness = getattr(b, f"{direction}_stiffness")
            ratio = getattr(b, f"{direction}_damping_ratio")
            return -2 * ratio * math.sqrt(stiffness * mass) * rate - stiffness * x

        return np.array(
            [
                (torque - r_bp * sum_n - sum_pf) / j_p,
                (-brake + r_bg * sum_n + sum_gf) / j_g,
                (support_force("pinion", "loa", m_p, x_p, dx_p) - sum_n) / m_p,
                (support_force("gear", "loa", m_g, x_g, dx_g) + sum_n) / m_g,
                (support_force("pinion", "oloa", m_p, y_p, dy_p) + sum_f) / m_p,
                (support_force("gear", "oloa", m_g, y_g, dy_g) - sum_f) / m_g,
            ]
        )

    return accelerations


def pytest_generate_tests(metafunc):
    """Parametrise ``quantity_field`` over every quantity of the schema."""
    if "quantity_field" in metafunc.fixturenames:
        from lumped import GearPair

        fields = list(dict(_quantities(GearPair)).items())
        metafunc.parametrize("quantity_field", fields, ids=[path for path, _ in fields])
