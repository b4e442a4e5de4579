"""What became of one fault, for the table of faults: the documentation reads this table without pytest."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from tests.evidence.faults.quantities import FELT


@dataclass(frozen=True)
class Outcome:
    """What became of one fault."""

    size: float  # largest change of a quantity of the report over its largest value, and which
    quantity: str
    caught: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    seconds: float = 0.0  # time of the parts

    @property
    def felt(self) -> bool:
        """Whether the fault changes a quantity by more than ``FELT``."""
        return not self.size <= FELT

    @property
    def first(self) -> str:
        """The first check that fails. Empty: no check sees the fault."""
        return next((f"{part}: {checks[0]}" for part, checks in self.caught.items() if checks), "")
