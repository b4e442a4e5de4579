"""Faults in the multibody model: drawing, kinematics, own laws, own damping, records."""

from validation.faults.fault import Fault

_DRAWING, _MACHINE = "multibody.contact.drawing", "multibody.contact.machine:machine"
_KINEMATICS, _KERNELS = "multibody.contact.kinematics", "multibody.contact.kernels"
_LAWS, _PARAMETERS = "multibody.contact.friction", "multibody.contact.friction_parameters:fill_friction"
_STATIC = {"mesh.relief": "static"}

MULTIBODY = (
    Fault(
        "mb_line",
        "line of action turned the wrong way",
        f"{_KINEMATICS}:line_of_action",
        "length * dx + flank * base_sum * dy",
        "length * dx - flank * base_sum * dy",
    ),
    Fault(
        "mb_moving_line",
        "gear centres move the line of action the wrong way",
        f"{_KERNELS}:mesh_position",
        "px + q[0], py + q[1], gx + q[3], gy + q[4]",
        "px - q[0], py - q[1], gx - q[3], gy - q[4]",
    ),
    Fault(
        "mb_back_side",
        "back sides touch half the backlash early",
        _MACHINE,
        "p[kn.CHI_P] + math.pi + base_tooth_angle(pair, pair.pinion, r_p)",
        "p[kn.CHI_P] + math.pi + base_tooth_angle(pair, pair.pinion, r_p) + 2.0 * pair.mesh.backlash / r_p",
    ),
    Fault(
        "mb_sliding",
        "sliding velocity: sign of the centres' part and the arms exchanged",
        f"{_KINEMATICS}:sliding_velocity",
        "(omega_p * arm_p + omega_g * arm_g)",
        "(omega_p * arm_g + omega_g * arm_p)",
    ),
    Fault(
        "mb_friction_sign",
        "friction on the pinion in the wrong direction",
        f"{_KINEMATICS}:add_wrench",
        "-normal * ex + friction * nx, -normal * ey + friction * ny",
        "-normal * ex - friction * nx, -normal * ey - friction * ny",
    ),
    Fault(
        "mb_friction_arm",
        "friction moment with the gear's arm",
        f"{_KINEMATICS}:add_wrench",
        "arm_p * friction",
        "arm_g * friction",
    ),
    Fault(
        "mb_overlap_rate",
        "rate of the overlap without the centres",
        f"{_KINEMATICS}:overlap_rate",
        "ex * vx + ey * vy - flank",
        "-flank",
    ),
    Fault(
        "mb_entry",
        "teeth enter at the pinion's tip",
        f"{_KINEMATICS}:pairs_in_contact",
        "0.0 <= rho_g <= tip_g",
        "0.0 <= rho_g <= 0.97 * tip_g",
    ),
    Fault(
        "mb_linear_arm",
        "linear mesh: friction arm of the gear",
        "multibody.contact.kernels_linear:linear_forces",
        "rp * normal + xi * friction",
        "rp * normal + (p[kn.L_XY] - xi) * friction",
    ),
    Fault(
        "mb_linear_rate",
        "linear mesh: sign of the rate of relief",
        "multibody.contact.kernels_linear:linear_forces",
        "rate - slope * speed",
        "rate + slope * speed",
        _STATIC,
    ),
    Fault(
        "mb_relief",
        "own relief: gear's roll angle from X",
        f"{_KERNELS}:relief_at",
        "(p[L_XY] - xi) / p[RADIUS_G]",
        "xi / p[RADIUS_G]",
        _STATIC,
    ),
    Fault(
        "mb_law_sign",
        "own friction with its sign reversed",
        f"{_KERNELS}:signed_friction",
        "return math.copysign(mu, slide)",
        "return -math.copysign(mu, slide)",
    ),
    Fault(
        "mb_law_iii",
        "own law III with v_e, not its half",
        f"{_LAWS}:xu_kahraman",
        "math.log(0.5 * rolling)",
        "math.log(rolling)",
    ),
    Fault(
        "mb_law_ii",
        "own law II: natural logarithm",
        f"{_LAWS}:benedict_kelley",
        "math.log10(number)",
        "math.log(number)",
        {"friction.law": "benedict_kelley"},
    ),
    Fault(
        "mb_law_load",
        "own friction: nominal load with the reference radius",
        _PARAMETERS,
        "/ p[kn.RADIUS_P] / width",
        "/ p[kn.RADIUS_P] / width * 0.94",
    ),
    Fault(
        "mb_damping",
        "own mesh damping without its 2",
        _MACHINE,
        "2.0 * pair.mesh.damping_ratio",
        "pair.mesh.damping_ratio",
    ),
    Fault(
        "mb_bearing_damping",
        "own bearing damping without its 2",
        f"{_DRAWING}:bearing_constants",
        "2.0 * ratio *",
        "ratio *",
    ),
    Fault(
        "mb_bearings",
        "own bearings exchanged",
        f"{_DRAWING}:bearing_constants",
        "(pair.bearings.pinion, pair.bearings.gear)",
        "(pair.bearings.gear, pair.bearings.pinion)",
    ),
    Fault(
        "mb_inertia", "own inertia of the disc by 16", f"{_DRAWING}:_disc", "math.pi / 32.0", "math.pi / 16.0"
    ),
    Fault(
        "mb_tip",
        "own tip circle 1 % too large",
        f"{_DRAWING}:circles",
        "tip_pinion=_tip_radius",
        "tip_pinion=1.01 * _tip_radius",
    ),
    Fault(
        "mb_pitch",
        "own base pitch without the cosine",
        f"{_DRAWING}:circles",
        "pitch=math.pi * rack.module * cosine",
        "pitch=math.pi * rack.module",
    ),
    Fault(
        "mb_stiffness",
        "stiffness of the teeth read half a millimetre off",
        "multibody.contact.elements:stiffness_and_slope",
        "s = x - table[low, 0]",
        "s = x + 5e-4 - table[low, 0]",
        {"mesh.stiffness": {"model": "parabolic"}},
    ),
    Fault(
        "mb_records",
        "recorded transmission error without the centres",
        "multibody.run.records:Recorder._motion",
        "- p[kn.RADIUS_G] * phi_g + x_p - x_g",
        "- p[kn.RADIUS_G] * phi_g",
    ),
    Fault(
        "mb_steps",
        "integrator with a tolerance ten million times as large",
        "multibody.run.integration:settings",
        "relativeTolerance, ti.absoluteTolerance = rtol, atol",
        "relativeTolerance, ti.absoluteTolerance = 1e7 * rtol, 1e7 * atol",
    ),
    Fault(
        "mb_flow_map",
        "flow map: rates measured over the wrong time",
        "multibody.run.flow_map:_differences",
        "(2.0 * h)",
        "(1.98 * h)",
    ),
)
