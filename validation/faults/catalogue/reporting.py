"""Faults in the arithmetic of the report, and inputs that are wrong in the file."""

from validation.faults.fault import Fault

_ORDERS = "validation.cross_check.metrics:mesh_orders"
_LOSS = "lumped.losses"
_INPUT = "a wrong input: both models and every check read it"

REPORTING = (
    Fault(
        "orders_rms",
        "amplitudes of mesh orders as effective values",
        _ORDERS,
        "2.0 * np.abs(spectrum[1:])",
        "np.sqrt(2.0) * np.abs(spectrum[1:])",
    ),
    Fault(
        "speed_unit",
        "speed in rad/s shown as rpm",
        "floquet.gear.axes:operating_rpm",
        "30.0 / np.pi",
        "1.0",
    ),
    Fault(
        "static_load",
        "static load with the reference radius",
        "validation.reporting.results:Results.static_load",
        "self.geometry.base_radius_pinion",
        "self.geometry.reference_radius_pinion",
    ),
    Fault(
        "resonant_speed",
        "resonant speeds without the tooth number",
        "lumped.model.averaged:modes",
        "60.0 * frequency / pair.pinion.teeth",
        "60.0 * frequency / pair.gear.teeth",
    ),
    Fault(
        "frequency_unit",
        "natural frequencies in rad/s shown as Hz",
        "lumped.model.averaged:modes",
        "float(abs(value)) / (2.0 * np.pi)",
        "float(abs(value))",
    ),
    Fault(
        "loss_sign",
        "quasi-static efficiency above one",
        f"{_LOSS}.quasi_static:quasi_static_losses",
        '"mesh_efficiency": 1.0 - loss',
        '"mesh_efficiency": 1.0 + loss',
    ),
    Fault(
        "loss_sliding",
        "quasi-static sliding from the end of the path",
        f"{_LOSS}.loss_factor:sliding_velocity",
        "(position - g.L_XP)",
        "(position - g.L_XB)",
    ),
    Fault(
        "loss_input",
        "input power with the gear's speed",
        f"{_LOSS}.dynamic:dynamic_losses",
        "torque * pair.geometry.omega_pinion",
        "torque * pair.geometry.omega_gear",
    ),
    Fault(
        "ohlendorf",
        "Ohlendorf's loss factor: ratio inverted",
        f"{_LOSS}.loss_factor:ohlendorf",
        "teeth_gear / teeth_pinion",
        "teeth_pinion / teeth_gear",
    ),
    Fault(
        "friction_power",
        "friction power with the gear's arm from X",
        "lumped.model.results:response",
        "-friction * (g.omega_pinion * pairs.position - g.omega_gear * arm_g)",
        "-friction * (g.omega_pinion * pairs.position + g.omega_gear * arm_g)",
    ),
    Fault(
        "bearing_force",
        "bearing forces without their damping, half as large",
        "lumped.model.results:response",
        "-(s.stiffness * z",
        "-0.5 * (s.stiffness * z",
    ),
    Fault(
        "load_sharing",
        "static load sharing by equal parts of the error",
        "lumped.quasi_static.load_sharing:share_load",
        "(applied + preload) / stiff",
        "(applied + 0.5 * preload) / stiff",
        {"mesh.relief": "static"},
    ),
)

INPUTS = (
    Fault(
        "input_viscosity",
        "viscosity of another oil in the file",
        input={"lubricant.viscosity": 20.0},
        unseen=_INPUT,
    ),
    Fault(
        "input_bearing",
        "bearing stiffness twice as high in the file",
        input={"bearings.pinion.loa_stiffness": 2e8},
        unseen=_INPUT,
    ),
    Fault(
        "input_damping",
        "damping ratio twice as high in the file",
        input={"mesh.damping_ratio": 0.1},
        unseen=_INPUT,
    ),
)
