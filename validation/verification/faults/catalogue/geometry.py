"""Faults in the geometry, in bodies and bearings, in stiffness, damping and relief of the teeth."""

from validation.verification.faults.fault import Fault

_GEOMETRY = "lumped.gear_geometry.geometry:_build"
_BODIES, _ISO = "lumped.model.bodies", "lumped.stiffness.iso6336"
_PAIR, _ELEMENTS = "lumped.stiffness.pair_compliance", "lumped.model.mesh_elements:_damping"
_RELIEF = "lumped.quasi_static.tooth_error"
_ENERGY = {"mesh.stiffness": {"model": "energy"}}
_RING = {
    "mesh.stiffness": {"model": "energy", "coupling": "ring_twist"},
    "pinion.bore": 20.0,
    "gear.bore": 20.0,
}
_STATIC = {"mesh.relief": "static"}
_SHIFTED = {"centre_distance": None}

GEOMETRY = (
    Fault(
        "pitch_point",
        "pitch point from the rack's pressure angle",
        _GEOMETRY,
        "L_XP=r_bp * math.tan(alpha_w)",
        "L_XP=r_bp * math.tan(alpha)",
    ),
    Fault("pitch_point_3_percent", "pitch point 3 % off", _GEOMETRY, "L_XP=r_bp *", "L_XP=1.03 * r_bp *"),
    Fault(
        "tip_radii",
        "tip radii exchanged",
        _GEOMETRY,
        "pinion.tip_radius, gear.tip_radius",
        "gear.tip_radius, pinion.tip_radius",
    ),
    Fault(
        "tip_shift",
        "tip radius without the profile shift",
        "lumped.schema.pair:GearPair._tip_radius",
        "(rack.addendum_coefficient + gear.profile_shift)",
        "rack.addendum_coefficient",
    ),
    Fault(
        "tip_radius",
        "tip radius of the pinion 1 % too large",
        _GEOMETRY,
        "r_ap, r_ag = pinion.tip_radius",
        "r_ap, r_ag = 1.01 * pinion.tip_radius",
    ),
    Fault(
        "base_pitch",
        "base pitch without the cosine",
        _GEOMETRY,
        "math.pi * m * math.cos(alpha)",
        "math.pi * m",
    ),
    Fault(
        "contact_ratio",
        "contact ratio over the reference pitch",
        _GEOMETRY,
        "(l_xd - l_xa) / base_pitch",
        "(l_xd - l_xa) / (math.pi * m)",
    ),
    Fault(
        "tangent",
        "L_XY from the rack's pressure angle",
        _GEOMETRY,
        "centre * math.sin(alpha_w)",
        "centre * math.sin(alpha)",
    ),
    Fault(
        "start_of_contact",
        "start of contact from the pinion's tip",
        _GEOMETRY,
        "math.sqrt(r_ag**2 - r_bg**2)",
        "math.sqrt(r_ap**2 - r_bp**2)",
    ),
    Fault(
        "centre_distance",
        "half the profile shifts in the centre distance",
        "lumped.gear_geometry.geometry:_centre_distance",
        "2.0 * shift / teeth",
        "shift / teeth",
        _SHIFTED,
    ),
    Fault(
        "speed_ratio",
        "gear's speed with the ratio inverted",
        _GEOMETRY,
        "omega_p * r_bp / r_bg",
        "omega_p * r_bg / r_bp",
    ),
    Fault(
        "mesh_period",
        "mesh period with the reference radius",
        _GEOMETRY,
        "(omega_p * r_bp),",
        "(omega_p * r_bp / math.cos(alpha)),",
    ),
    Fault(
        "face_width",
        "the larger of both face widths",
        _GEOMETRY,
        "min(pinion.face_width",
        "max(pinion.face_width",
    ),
    Fault(
        "pair_count",
        "one tooth pair too few",
        "lumped.gear_geometry.geometry:Geometry.pairs",
        "math.floor(self.contact_ratio) + 1",
        "math.floor(self.contact_ratio)",
    ),
)

BODIES = (
    Fault("mass_pi", "masses without pi", f"{_BODIES}:solid_disc", "density * math.pi *", "density *"),
    Fault(
        "disc_inertia", "inertia of a disc without its 1/2", f"{_BODIES}:solid_disc", "0.5 * mass *", "mass *"
    ),
    Fault(
        "bore",
        "bore taken as a radius",
        f"{_BODIES}:solid_disc",
        "0.5 * bore",
        "bore",
        {"pinion.bore": 20.0, "gear.bore": 25.0},
    ),
    Fault(
        "effective_mass",
        "effective mass of one gear",
        f"{_BODIES}:bodies",
        " + g.base_radius_gear**2 / j_g",
        "",
    ),
    Fault(
        "bodies_swapped",
        "pinion's and gear's bodies exchanged",
        f"{_BODIES}:bodies",
        "Bodies(m_p, m_g, j_p, j_g",
        "Bodies(m_g, m_p, j_g, j_p",
    ),
    Fault(
        "tip_disc",
        "disc of the tip diameter",
        f"{_BODIES}:bodies",
        "g.reference_radius_gear)",
        "g.tip_radius_gear)",
    ),
    Fault(
        "density",
        "pinion's density for both",
        f"{_BODIES}:bodies",
        "_resolved(pair.gear,",
        "_resolved(pair.gear.model_copy(update={'density': pair.pinion.density}),",
    ),
)

TEETH = (
    Fault(
        "stiffness_30_percent",
        "stiffness of the teeth 30 % too high",
        "lumped.path_of_contact.stiffness:pair_stiffness",
        "curve(pair)",
        "curve(pair).scaled(1.3)",
    ),
    Fault(
        "stiffness_5_percent",
        "stiffness of the teeth 5 % too high",
        "lumped.path_of_contact.stiffness:pair_stiffness",
        "curve(pair)",
        "curve(pair).scaled(1.05)",
    ),
    Fault(
        "iso_correction",
        "ISO 6336 without its 0.8",
        f"{_ISO}:single_stiffness",
        "theoretical * CORRECTION",
        "theoretical",
    ),
    Fault(
        "iso_rack",
        "ISO 6336 without the basic rack factor",
        f"{_ISO}:single_stiffness",
        "* basic_rack *",
        "*",
        {"basic_rack.dedendum_coefficient": 1.35},
    ),
    Fault(
        "iso_rack_sign",
        "ISO 6336: basic rack factor with its sign reversed",
        f"{_ISO}:basic_rack_factor",
        "1.0 + 0.5 *",
        "1.0 - 0.5 *",
    ),
    Fault(
        "iso_coefficient",
        "ISO 6336: C2 and C3 exchanged",
        f"{_ISO}:theoretical_single_stiffness",
        "c[1] / z_1\n        + c[2] / z_2",
        "c[2] / z_1\n        + c[1] / z_2",
    ),
    Fault(
        "iso_mean", "ISO 6336: mean stiffness without its 0.25", f"{_ISO}:mean_mesh_stiffness", "return single * (0.75 * contact_ratio + 0.25)", "return single * (0.75 * contact_ratio)"
    ),
    Fault(
        "iso_width",
        "ISO 6336: the pinion's face width",
        f"{_ISO}:single_of",
        "pair.geometry.face_width",
        "pair.pinion.face_width",
    ),
    Fault(
        "parabola_ends",
        "parabola: ends for a contact ratio of 1",
        "lumped.stiffness.parabolic:iso_end_ratio",
        "0.25 + 0.75 / contact_ratio",
        "1.0",
        {"mesh.stiffness": {"model": "parabolic"}},
    ),
    Fault(
        "hertz_one_tooth",
        "energy method: contact of one tooth only",
        f"{_PAIR}:_contact",
        "total = total + ",
        "total = ",
        _ENERGY,
    ),
    Fault(
        "foundation",
        "energy method: without the foundation",
        f"{_PAIR}:ToothCompliance.total",
        " + self.foundation",
        "",
        _ENERGY,
    ),
    Fault(
        "bending",
        "energy method: tooth section I = h^3/3",
        "lumped.stiffness.tooth_beam:_integrals",
        "np.sum(1.5 * arm**2",
        "np.sum(3.0 * arm**2",
        _ENERGY,
    ),
    Fault(
        "shear_modulus",
        "energy method: shear modulus without Poisson's ratio",
        "lumped.stiffness.tooth_beam:beam_compliance",
        "(2.0 * (1.0 + poisson))",
        "2.0",
        _ENERGY,
    ),
    Fault(
        "energy_load",
        "energy method: load in N/mm",
        f"{_PAIR}:_contact",
        "/ g.base_radius_pinion / width",
        "/ g.base_radius_pinion / width * 1e-3",
        _ENERGY,
    ),
    Fault(
        "neighbours",
        "coupling: neighbours half a pitch away",
        "lumped.stiffness.coupling:coupled",
        "geometry.pairs) * pitch",
        "geometry.pairs) * 0.5 * pitch",
        _RING,
    ),
    Fault(
        "mesh_damping_half",
        "mesh damping without its 2",
        _ELEMENTS,
        "2.0 * ratio * np.sqrt(mass)",
        "ratio * np.sqrt(mass)",
    ),
    Fault("mesh_damping_mass", "mesh damping: mass outside of the root", _ELEMENTS, "np.sqrt(mass)", "mass"),
    Fault(
        "mesh_damping_constant",
        "mesh damping by the mean stiffness",
        _ELEMENTS,
        "np.maximum(stiffness(xi), 0.0)",
        "(stiffness.mean() + 0.0 * xi)",
        {"mesh.stiffness": {"model": "parabolic"}},
    ),
    Fault(
        "relief_sign",
        "relief adds material",
        f"{_RELIEF}:flank_relief",
        "relief.amount *",
        "-relief.amount *",
        _STATIC,
    ),
    Fault(
        "relief_start",
        "relief starts 1 degree early",
        f"{_RELIEF}:_Relief.__call__",
        "(xi - self.origin) / self.radius",
        "(xi - self.origin) / self.radius + 0.0175",
        _STATIC,
    ),
    Fault(
        "relief_end",
        "relief reaches its amount too late",
        f"{_RELIEF}:flank_relief",
        "(end - relief.start_roll_angle)",
        "(1.02 * end - relief.start_roll_angle)",
        _STATIC,
    ),
    Fault(
        "relief_shape",
        "linear relief taken as a parabola",
        f"{_RELIEF}:flank_relief",
        's if relief.shape == "linear" else s**2',
        "s**2",
        _STATIC,
    ),
    Fault(
        "relief_rate",
        "relief: sign of its rate",
        "lumped.model.mesh_cycle:MeshCycle.sample",
        "e.error.derivative()(xi) * speed",
        "-e.error.derivative()(xi) * speed",
        _STATIC,
    ),
)
