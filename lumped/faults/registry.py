"""The faults by name."""

from __future__ import annotations

from lumped.faults.chip import Chip
from lumped.faults.crack import Crack
from lumped.faults.spall import Spall

#: Every fault that ``kind`` of an entry of ``faults`` may name.
AnyFault = Crack | Spall | Chip
