"""Pictures and discrepancies of the reference cases, from their published files."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from computed.diagrams import svg
from computed.markdown import Code, table
from lumped.fields.units import to_stated
from validation.reference_cases.case import reference, reference_names
from validation.reference_cases.discrepancy import percent

#: Way -> head of its column.
_WAYS = {
    "closed_form": "closed form",
    "lumped": "lumped, half the step",
    "floquet": "floquet",
    "multibody": "multibody, exact",
}


def picture(name: str) -> str:
    """Every channel of a case over its period."""
    return svg(reference(name).plot())


def facts(name: str) -> str:
    """What a case is, where its curves come from, and the discrepancy of every channel."""
    case = reference(name)
    ways = [way for way in _WAYS if any(getattr(one, way) is not None for one in case.discrepancy.values())]
    rows = (
        (Code(channel), *(percent(getattr(one, way)) for way in ways))
        for channel, one in case.discrepancy.items()
    )
    cycles = "one mesh cycle" if case.mesh_cycles == 1 else f"{case.mesh_cycles} mesh cycles"
    frequency = f"mesh frequency {1.0 / case.mesh_period:.1f} Hz"
    operating = None if case.pair is None else case.pair.operating
    if operating is not None:
        speed = to_stated(operating.pinion_speed, "rpm")
        ratio = case.pair.geometry.contact_ratio
        running = f"{speed:.0f} rpm, {operating.pinion_torque:g} N m, contact ratio {ratio:.3f}"
        frequency = f"{running}, {frequency}"
    text = (
        f"{case.description} {frequency[0].upper()}{frequency[1:]}. Curves over {cycles}, "
        f"{case.samples_per_cycle} samples a mesh cycle, from: {case.curves_from}. A frequent fault that the "
        f"case shows: {case.frequent_fault[0].lower()}{case.frequent_fault[1:]} Source: {case.source}."
    )
    return f"{text}\n\n{table(('channel', *(_WAYS[way] for way in ways)), rows)}\n"


def _files() -> Iterator[tuple[str, Callable[[], str]]]:
    for name in reference_names():
        yield f"reference_{name}.svg", lambda name=name: picture(name)
        yield f"reference_{name}.md", lambda name=name: facts(name)


FILES: dict[str, Callable[[], str]] = dict(_files())
