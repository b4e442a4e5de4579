"""Every fault, by group."""

from __future__ import annotations

from collections.abc import Mapping

from validation.verification.faults.catalogue.dynamics import EQUATIONS, INTEGRATION, STABILITY
from validation.verification.faults.catalogue.friction import FRICTION
from validation.verification.faults.catalogue.geometry import BODIES, GEOMETRY, TEETH
from validation.verification.faults.catalogue.multibody import MULTIBODY
from validation.verification.faults.catalogue.reporting import INPUTS, REPORTING
from validation.verification.faults.fault import Fault

#: Group in words -> its faults.
GROUPS: Mapping[str, tuple[Fault, ...]] = {
    "equations of motion": EQUATIONS,
    "friction and film": FRICTION,
    "geometry": GEOMETRY,
    "bodies": BODIES,
    "teeth": TEETH,
    "integration": INTEGRATION,
    "stability": STABILITY,
    "multibody model": MULTIBODY,
    "report": REPORTING,
    "input": INPUTS,
}
#: Key -> fault.
FAULTS: Mapping[str, Fault] = {fault.key: fault for group in GROUPS.values() for fault in group}
