"""Every fault, by group."""

from __future__ import annotations

from collections.abc import Mapping

from validation.faults.catalogue.dynamics import EQUATIONS, INTEGRATION, STABILITY
from validation.faults.catalogue.friction import FRICTION
from validation.faults.catalogue.geometry import BODIES, GEOMETRY, TEETH
from validation.faults.catalogue.multibody import MULTIBODY
from validation.faults.catalogue.reporting import INPUTS, REPORTING
from validation.faults.fault import Fault

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
