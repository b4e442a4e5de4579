"""What the lumped and the multibody model still have in common, and what else speaks for each of it.

Agreement of the two models says nothing about what both read from the same place, so each such thing is named
here with the evidence that does not come from their comparison.

Sources: docs/theory/multibody.md, "What is own and what is shared".
"""

from dataclasses import dataclass


@dataclass(frozen=True)
class Shared:
    """One thing that both models take from the same place.

    Attributes
    ----------
    what : the number or formula
    why : why the multibody model has none of its own
    evidence : what else says that it is right
    where : files of the repository in which the evidence is
    """

    what: str
    why: str
    evidence: str
    where: tuple[str, ...]


SHARED: tuple[Shared, ...] = (
    Shared(
        "stiffness k of a tooth pair along the path of contact",
        "rigid bodies have no elasticity; with mesh.relief = 'static' the stretch under load is part of k",
        "the mean against ISO 6336-1 method B, the tooth as a cantilever, published curves, energy balance",
        ("lumped/path_of_contact/stiffness.py", "tests/lumped/stiffness", "docs/theory/mesh_physics.md"),
    ),
    Shared(
        "how far the load of a tooth pair moves the next pairs",
        "rigid bodies have no elasticity; it acts only with loaded contact",
        "plane finite elements of three teeth, the published deflection of the body, reciprocity",
        ("tests/lumped/stiffness", "docs/theory/contact_energy.md"),
    ),
    Shared(
        "drawing and operating point: the fields of the parameter file in SI units",
        "both models are of the same pair",
        "every unit and range of the schema is tested, and the report prints every value with its source",
        ("tests/lumped/schema",),
    ),
    Shared(
        "printed formulas of the friction laws, the film and Walther's law, with their constants",
        "they are what the prediction is about; each is written twice",
        "values that are published or worked out by hand, computed by both models on every installation",
        ("tests/evidence/published.py", "tests/lumped/friction", "docs/theory/friction.md"),
    ),
    Shared(
        "the load of the friction laws: full static load w_n, whatever a tooth pair carries",
        "the paper's assumption; the momentary load is the effect 'friction_load'",
        "the attribution shows what the momentary load changes",
        ("multibody/run/effects.py",),
    ),
    Shared(
        "viscosity at 100 degC of an oil of an ISO VG grade (tables of ASTM D2270)",
        "a table of constants that would only be copied",
        "values of the standard and of data sheets",
        ("tests/lumped/lubrication",),
    ),
    Shared(
        "definition c = 2 zeta sqrt(k m_e) of the mesh damping, and of bodies as discs",
        "definitions of the schema; both sides work them out for themselves",
        "free vibration decays with the damping ratio of the schema (damping_check); the outline of each "
        "gear is integrated and the difference to the disc stated (blanks)",
        ("tests/evidence/reference_model/free_vibration.py", "tests/evidence/reference_model/blanks.py"),
    ),
    Shared(
        "on shafts: what the damping ratio means, the gear as a rigid disc, Cowper's shear coefficient",
        "definitions of the schema; the rest is worked out twice",
        "closed forms of Timoshenko's beam, of torsion and of a whirling disc, on both sides",
        ("tests/multibody/shafts", "tests/lumped/shafts", "docs/theory/shafts.md"),
    ),
    Shared(
        "initial state of a run, its time origin, and its brake torque where it is balanced",
        "the lumped periodic solution starts both models alike",
        "multibody.steady_state finds its own periodic motion and the brake torque that balances it; "
        "on shafts every run starts from the multibody model's own",
        ("multibody/run/flow_map.py",),
    ),
)
