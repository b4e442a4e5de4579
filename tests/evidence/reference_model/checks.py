"""The multibody model by means that do not come from its comparison with the lumped model, as numbers."""

from collections.abc import Iterator

import numpy as np

import lumped
from tests.evidence.check import Check, rows
from tests.evidence.reference_model.blanks import blanks
from tests.evidence.reference_model.free_vibration import damping_check
from tests.evidence.reference_model.frozen_modes import frozen_modes

PAIR = lumped.load_gear_pair("nasa_28_28").with_(mesh__relief="ignored")
#: Nothing alike: teeth, shifts, all damping ratios and bearings.
UNLIKE = lumped.load_gear_pair("fzg_c").with_(
    mesh__damping_ratio=0.07,
    mesh__stiffness={"model": "parabolic"},
    bearings__pinion={
        "loa_stiffness": 2e8, "oloa_stiffness": 5e7, "loa_damping_ratio": 0.02, "oloa_damping_ratio": 0.4,
    },
    bearings__gear={
        "loa_stiffness": 3e8,
        "oloa_stiffness": 1e8,
        "loa_damping_ratio": 1.2,
        "oloa_damping_ratio": 0.03,
    },
)  # fmt: skip


def reference_model() -> Iterator[Check]:
    """Damping by decay, bodies by their outline, frozen modes."""
    decays = [(decay.measured, decay.given) for decay in damping_check(UNLIKE)]
    yield rows("free vibration of mesh and bearings: decay", "damping ratios of the schema", 1e-6, decays)
    bodies = [blank for name in lumped.preset_names() for blank in blanks(lumped.load_gear_pair(name))]
    exact = "that of the disc that stands for the gear"
    mass, inertia = (
        [(getattr(b, f"taken_{what}"), getattr(b, what)) for b in bodies] for what in ("mass", "inertia")
    )
    yield rows("mass of all presets by the outline", exact, 0.03, mass)
    yield rows("inertia of all presets by the outline", exact, 0.1, inertia)
    found = frozen_modes(PAIR)
    frozen, linear = found["lumped frozen"], found["exudyn linear"]
    # exudyn differentiates numerically.
    both = np.stack([linear.ravel(), frozen.ravel()], axis=1)
    yield rows("natural frequencies and damping ratios by exudyn, mesh frozen", "those of A(t)", 1e-6, both)
