"""Is a heading understood as its author means it, and is what leaves a doubt not understood?"""

import pytest

from validation.check.quantities import QUANTITIES
from validation.check.reading.meaning import abscissa_of, understood, value_over_speed

UNDERSTOOD = {
    "DTE [um]": ("dte", "um"), "TE_um": ("dte", "um"), "delta": ("dte", None), "δ (µm)": ("dte", "µm"),
    "Transmission Error [µm]": ("dte", "µm"), "Drehwegabweichung in µm": ("dte", "µm"),
    "d/dt TE [mm/s]": ("dte_dot", "mm/s"), "delta_ddot": ("dte_ddot", None),
    "x1": ("x_p", None), "X1 (m)": ("x_p", "m"), "y2_um": ("y_g", "um"), "u_x1": ("x_p", None),
    "displacement pinion along line of action": ("x_p", None), "pinion OLOA displacement [um]": ("y_p", "um"),
    "gear displacement off the line of action [mm]": ("y_g", "mm"), "pinion.x": ("x_p", None),
    "x_p(t) [mm]": ("x_p", "mm"),
    "vx1": ("x_p_dot", None), "ax2 [m/s^2]": ("x_g_ddot", "m/s^2"),
    "a_x1": ("x_p_ddot", None), "accelerometer pinion y [g]": ("y_p_ddot", "g"), "xddot1": ("x_p_ddot", None),
    "theta1": ("theta_p", None), "φ_p [mrad]": ("theta_p", "mrad"), "gear 1 angle": ("theta_p", None),
    "gear 2 rotation": ("theta_g", None), "omega_p": ("theta_p_dot", None),
    "n1 [rpm]": ("theta_p_dot", "rpm"),
    "Drehzahl Rad [1/min]": ("theta_g_dot", "1/min"), "angular velocity pinion": ("theta_p_dot", None),
    "Angular acceleration of the gear [rad/s^2]": ("theta_g_ddot", "rad/s^2"),
    "thetadot1": ("theta_p_dot", None),
    "Fm": ("mesh_force", None), "contact force [kN]": ("mesh_force", "kN"), "F_mesh_kN": ("mesh_force", "kN"),
    "Zahnkraft / kN": ("mesh_force", "kN"), "friction force": ("friction", None),
    "Fbx1": ("bearing_force_x_p", None), "F_bx1": ("bearing_force_x_p", None),
    "bearingForceXPinion": ("bearing_force_x_p", None), "Lagerkraft y Rad [N]": ("bearing_force_y_g", "N"),
    "loa bearing force gear": ("bearing_force_x_g", None),
    "mesh torque pinion [N m]": ("mesh_torque_p", "N m"),
    "k_mesh": ("mesh_stiffness", None), "mesh stiffness [N/um]": ("mesh_stiffness", "N/um"),
}  # fmt: skip
#: One sign more or a missing word leaves open which quantity it is.
NOT_UNDERSTOOD = (
    "theta_rad", "Channel 1 x", "phi rad",
    "x", "F", "M1", "torque", "Fx1", "force pinion", "alpha1", "pinion gear x", "x_y_p", "angle", "foo",
    "dte_ddddot",
    "normal", "bearing force pinion", "1", "", "H1", "dte rms",
)  # fmt: skip


@pytest.mark.parametrize("heading", UNDERSTOOD)
def test_a_heading_is_understood_with_its_unit(heading):
    result = understood(heading)
    assert (result.meaning.quantity, result.heading.unit) == UNDERSTOOD[heading]


@pytest.mark.parametrize("heading", NOT_UNDERSTOOD)
def test_a_heading_that_leaves_a_doubt_is_not_understood(heading):
    assert understood(heading) is None


@pytest.mark.parametrize("name", QUANTITIES)
def test_every_quantity_is_understood_by_its_name_and_by_its_words(name):
    quantity = QUANTITIES[name]
    label = "_A" if quantity.of_tooth_pair else ""
    assert understood(f"{name}{label} [{quantity.unit}]").meaning == understood(f"{name}{label}").meaning
    assert understood(f"{name}{label}").meaning.quantity == name
    assert understood(f"{name}{label}").meaning.assumption == ""


@pytest.mark.parametrize(("heading", "kind", "unit"), [
    ("t / s", "time", "s"), ("Time_s", "time", "s"),
    ("Zeit [ms]", "time", "ms"), ("X_Value", "time", None), ("t(s)", "time", "s"),
    ("mesh phase [-]", "mesh_phase", "-"), ("t/T_m", "mesh_phase", None), ("n [1/min]", "speed", "1/min"),
    ("pinion speed (rpm)", "speed", "rpm"), ("Raddrehzahl", "gear_speed", None), ("Ordnung", "order", None),
    ("speed_rpm", "speed", "rpm"), ("pinion angle [deg]", "pinion_angle", "deg"),
])  # fmt: skip
def test_an_abscissa_is_recognised(heading, kind, unit):
    found = abscissa_of(heading)
    assert (found[0], found[1].unit) == (kind, unit)


@pytest.mark.parametrize(("words", "value"), [
    ("dte peak-to-peak", ("peak_to_peak", 0.0, "dte")), ("TE pk-pk", ("peak_to_peak", 0.0, "TE")),
    ("dte_peak_to_peak", ("peak_to_peak", 0.0, "dte")), ("x_p rms", ("rms", 0.0, "x p")),
    ("H1", ("order", 1.0, "")), ("dte order 2 amplitude", ("order", 2.0, "dte")),
    ("3rd harmonic of TE", ("order", 3.0, "of TE")), ("Mittelwert Fm", ("mean", 0.0, "Fm")),
])  # fmt: skip
def test_a_value_over_speed_is_recognised(words, value):
    assert tuple(value_over_speed(words)) == value
    assert value_over_speed("dte") is None
