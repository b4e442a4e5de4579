"""Faults in the equations of motion, in their balance, their integration and their stability."""

from validation.faults.fault import Fault

_EQUATIONS, _SYSTEM = "lumped.model.equations:structure", "lumped.model.periodic_system"
_NORMAL = "np.array([-r_bp, s.gear_mesh * r_bg, -1.0, s.gear_loa, 0.0, 0.0])"
_STEADY, _CYCLE = "lumped.model.steady", "lumped.model.mesh_cycle:MeshCycle"
_BLOCK, _GAINS = "floquet.gear.block", "floquet.gear.mesh_gains:MeshGains"
_MULTIPLIERS = "floquet.gear.multipliers"
_STATIC = {"mesh.relief": "static"}

EQUATIONS = (
    Fault("eq1_mesh", "(1): sign of the mesh moment", _EQUATIONS, _NORMAL, _NORMAL.replace("-r_bp", "r_bp")),
    Fault(
        "eq1_friction",
        "(1): sign of the friction moment, as printed",
        _EQUATIONS,
        "0.0, -s.pinion_friction",
        "0.0, s.pinion_friction",
    ),
    Fault(
        "eq1_arm",
        "(1): friction arm of the gear",
        _EQUATIONS,
        "arm[0] = 0.0, -s.pinion_friction",
        "arm[0] = -g.L_XY, s.pinion_friction",
    ),
    Fault(
        "eq2_mesh",
        "(2): sign of the mesh moment, as printed",
        _EQUATIONS,
        "s.gear_mesh * r_bg",
        "-s.gear_mesh * r_bg",
    ),
    Fault(
        "eq2_friction",
        "(2): sign of the friction moment",
        _EQUATIONS,
        "arm[1] = g.L_XY, -1.0",
        "arm[1] = -g.L_XY, 1.0",
    ),
    Fault(
        "eq2_arm", "(2): friction arm of the pinion", _EQUATIONS, "arm[1] = g.L_XY, -1.0", "arm[1] = 0.0, 1.0"
    ),
    Fault(
        "eq3_centres",
        "(3): transmission error with the centres' signs reversed",
        _EQUATIONS,
        "-r_bg, 1.0, -1.0, 0.0, 0.0]",
        "-r_bg, -1.0, 1.0, 0.0, 0.0]",
    ),
    Fault(
        "eq3_gear",
        "(3): transmission error without the gear's centre",
        _EQUATIONS,
        "-r_bg, 1.0, -1.0, 0.0, 0.0]",
        "-r_bg, 1.0, 0.0, 0.0, 0.0]",
    ),
    Fault(
        "eq4_damping",
        "(4): mesh damping of opposite sign",
        f"{_SYSTEM}:LTVSystem.gain",
        "acceleration(pairs.damping)",
        "-acceleration(pairs.damping)",
    ),
    Fault(
        "eq5_position",
        "(5): pairs half a pitch ahead",
        f"{_CYCLE}.offsets",
        "g.L_XA + np.arange",
        "g.L_XA - 0.5 * g.base_pitch + np.arange",
    ),
    Fault(
        "eq6_mesh",
        "(6): sign of the mesh force",
        _EQUATIONS,
        _NORMAL,
        _NORMAL.replace("r_bg, -1.0", "r_bg, 1.0"),
    ),
    Fault(
        "eq7_mesh",
        "(7): sign of the mesh force, as printed",
        _EQUATIONS,
        "s.gear_loa, 0.0",
        "-s.gear_loa, 0.0",
    ),
    Fault(
        "eq8_friction",
        "(8): sign of the friction force",
        _EQUATIONS,
        "= 1.0, -s.gear_oloa",
        "= -1.0, -s.gear_oloa",
    ),
    Fault(
        "eq9_friction",
        "(9): sign of the friction force, as printed",
        _EQUATIONS,
        "= 1.0, -s.gear_oloa",
        "= 1.0, s.gear_oloa",
    ),
    Fault(
        "bearings_swapped",
        "bearings of pinion and gear exchanged",
        _EQUATIONS,
        "pair.bearings.pinion, pair.bearings.gear",
        "pair.bearings.gear, pair.bearings.pinion",
    ),
    Fault(
        "bearing_directions",
        "bearing stiffness on and off the line of action exchanged",
        _EQUATIONS,
        "pinion.loa_stiffness, gear.loa_stiffness, pinion.oloa_stiffness, gear.oloa_stiffness",
        "pinion.oloa_stiffness, gear.oloa_stiffness, pinion.loa_stiffness, gear.loa_stiffness",
    ),
    Fault(
        "bearing_damping_half",
        "bearing damping without its 2",
        _EQUATIONS,
        "damping=2.0 * ratio",
        "damping=ratio",
    ),
    Fault(
        "bearing_damping_root",
        "bearing damping without its root",
        _EQUATIONS,
        "np.sqrt(bearing * mass)",
        "bearing * np.sqrt(mass) * 1e-4",
    ),
    Fault(
        "masses_swapped",
        "inertias of pinion and gear exchanged",
        _EQUATIONS,
        "[b.inertia_pinion, b.inertia_gear,",
        "[b.inertia_gear, b.inertia_pinion,",
    ),
    Fault(
        "balance_sign",
        "sign of the brake torque",
        f"{_SYSTEM}:periodic_system",
        "-reduction[:, 1] / s.mass[1]",
        "reduction[:, 1] / s.mass[1]",
    ),
    Fault(
        "balance_ratio",
        "efficiency without the ratio of the speeds",
        f"{_STEADY}:PeriodicSolution.balance",
        "self.brake_torque * g.omega_gear / (self.pinion_torque * g.omega_pinion)",
        "self.brake_torque / self.pinion_torque",
    ),
    Fault(
        "balance_inverse",
        "efficiency inverted",
        f"{_STEADY}:PeriodicSolution.balance",
        "self.brake_torque * g.omega_gear / (self.pinion_torque * g.omega_pinion)",
        "self.pinion_torque * g.omega_pinion / (self.brake_torque * g.omega_gear)",
    ),
    Fault(
        "balance_torque",
        "periodic motion of 5 % more torque",
        f"{_STEADY}:balanced_start",
        "known = np.array([1.0, 0.0,",
        "known = np.array([1.0, 0.05 * operating.pinion_torque,",
    ),
)

INTEGRATION = (
    Fault(
        "step",
        "periodic motion with steps forty times as long",
        "lumped.model.propagation:_step_grid",
        "largest = step_angle",
        "largest = 40.0 * step_angle",
    ),
    Fault(
        "order",
        "periodic motion: stages at the wrong times",
        "lumped.model.propagation:_steps",
        "h[:, None] * gauss[2]",
        "0.9 * h[:, None] * gauss[2]",
    ),
    Fault(
        "event_times",
        "switches of the pitch point and the end of contact a tenth of a pitch late",
        f"{_CYCLE}.switch_times",
        "np.array([g.L_XP, self.start, self.end])",
        "np.array([g.L_XP, self.start, self.end]) + 0.1 * g.base_pitch",
    ),
    Fault(
        "segment",
        "pairs that leave contact still count",
        f"{_CYCLE}.sample",
        "middle <= self.end",
        "middle <= self.end + 0.2 * g.base_pitch",
    ),
    Fault(
        "friction_segments",
        "friction of the segment's middle",
        f"{_CYCLE}.sample",
        "of(e.friction(xi))",
        "of(e.friction(middle))",
    ),
    Fault(
        "transient_torque",
        "transient without its brake torque",
        "lumped.model.solution:rate_function",
        "-balance.brake_torque",
        "-0.9 * balance.brake_torque",
    ),
)

STABILITY = (
    Fault(
        "floquet_segments",
        "multipliers: every time in the first segment",
        f"{_MULTIPLIERS}:_Coefficients.__call__",
        'np.searchsorted(edges, times, side="right") - 1',
        "0 * times.astype(int)",
    ),
    Fault(
        "floquet_period",
        "multipliers: over two mesh cycles",
        f"{_MULTIPLIERS}:gear_pair_system",
        "PeriodicSystem(coefficients, system.period,",
        "PeriodicSystem(coefficients, 2.0 * system.period,",
    ),
    Fault(
        "floquet_damping",
        "multipliers: mesh damping 20 % too large",
        f"{_MULTIPLIERS}:_Coefficients.__call__",
        "A[:, m:, m:] += damping",
        "A[:, m:, m:] += 1.2 * damping",
    ),
    Fault(
        "floquet_stiffness",
        "multipliers: mesh stiffness 1 % too large",
        f"{_MULTIPLIERS}:_Coefficients.__call__",
        "A[:, m:, :m] += stiffness",
        "A[:, m:, :m] += 1.01 * stiffness",
    ),
    Fault(
        "floquet_bearings",
        "multipliers: bearings off the line of action without their 1/2",
        f"{_MULTIPLIERS}:OffLineOfAction.of",
        "s.damping[4:] / (2.0 * s.mass[4:])",
        "s.damping[4:] / s.mass[4:]",
    ),
    Fault(
        "block_friction",
        "compiled multipliers: sign of friction",
        f"{_GAINS}.__call__",
        "rows[0] = rows[0] + mu * arm",
        "rows[0] = rows[0] - mu * arm",
    ),
    Fault(
        "block_knots",
        "compiled multipliers: knots of the laws ignored",
        "floquet.gear.mesh_gains:_Law.of",
        "law.breaks[piece],",
        "law.breaks[0 * piece],",
    ),
    Fault(
        "block_period",
        "compiled multipliers: over half a mesh cycle",
        f"{_BLOCK}:gear_block",
        "period=system.period",
        "period=0.5 * system.period",
    ),
    Fault(
        "block_bearings",
        "compiled multipliers: bearing damping 20 % too large",
        f"{_BLOCK}:gear_block",
        "damping=-np.diag(",
        "damping=-1.2 * np.diag(",
    ),
    Fault(
        "block_misfit",
        "compiled multipliers: bound without the misfit of the fit",
        f"{_BLOCK}:_four",
        "misfit[:, :2] = errors[:, first : first + 2]",
        "misfit[:, :2] = 0.0",
    ),
    Fault(
        "averaged",
        "natural frequencies with the mesh of single contact",
        "lumped.model.averaged:averaged_matrix",
        "total / system.period",
        "system.matrices(np.array([0.5 * system.period]))[0]",
    ),
)
