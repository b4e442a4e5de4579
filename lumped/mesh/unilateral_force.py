"""The force of the mesh with unilateral contact: teeth only push, and a pair that would pull has no load.

    N = max(N_el + s c p', 0)

N_el is the elastic load of ``lumped.mesh.element``, s c the damper of ``lumped.mesh.damper``, p' the rate of
the compression. In ``lumped.mesh.linear``, the form with linear contact, a pair that would pull does pull.

Sources: docs/theory/contact_energy.md, "First law".
"""

from __future__ import annotations

from typing import NamedTuple

from lumped.compiler import inlined
from lumped.mesh.damper import acting_damping, damper_power
from lumped.mesh.element import in_contact, rolling_rate
from lumped.mesh.records import ContactLaw, Record, Records
from lumped.typing import FloatArray


class MeshForce(NamedTuple):
    """Force of all pairs on the gears, with the fields of FORCE, and the power of their dampers [W]."""

    normal: float
    friction_force: float
    friction_moment: float
    separating: float
    damper_power: float


@inlined
def compression_rate(approach_rate: float, contact: Record, line: Record, law: ContactLaw) -> float:
    """Rate p' of the compression of a pair [m/s]: the approach less the growth of the gap."""
    rate: float = approach_rate * (1.0 - contact.gap_by_approach) - rolling_rate(contact, line, law)
    return rate


@inlined
def pushing_load(elastic_load: float, damping: float, rate: float) -> float:
    """Load N = max(N_el + c p', 0) of a pair that cannot pull [N]."""
    return max(elastic_load + damping * rate, 0.0)


@inlined
def unilateral_force(
    approach_rate: float,
    pairs: Records,
    line: Record,
    law: ContactLaw,
    contacts: Records,
    normal: FloatArray,
) -> MeshForce:
    """Force of all pairs at a rate of the approach, from elastic loads of ``write_elastic_loads``.

    The damper force of a pair is N - N_el also where the load is cut to 0. The power (N - N_el) p' of the
    damper is then exactly what the energy of the pairs loses.

    Parameters
    ----------
    approach_rate : delta' [m/s]
    normal : (pairs,) written: the load N of each pair [N]
    """
    total = 0.0
    friction = 0.0
    moment = 0.0
    separating = 0.0
    power = 0.0
    for i in range(pairs.size):
        pair = pairs[i]
        contact = contacts[i]
        normal[i] = 0.0
        if not in_contact(pair, contact, law):
            continue
        rate = compression_rate(approach_rate, contact, line, law)
        load = pushing_load(contact.load, acting_damping(pair, contact, law), rate)
        # A pair that neither touches elastically nor pushes has no damper: with prescribed contact its
        # spring is stretched, and nothing holds it.
        if load > 0.0 or contact.load > 0.0:
            power += damper_power(load - contact.load, rate)
        normal[i] = load
        total += load
        friction += pair.mu * load
        moment += pair.mu * load * pair.position
        separating += contact.tilt * load
    return MeshForce(total, friction, moment, separating, power)
