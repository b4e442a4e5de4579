"""What a fault is: words, the line of code that it changes, and where its effect shows."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any


@dataclass(frozen=True)
class Fault:
    """One fault.

    Attributes
    ----------
    key : stable name
    words : what is wrong
    target : function that is changed, "module:name" or "module:Class.name"; empty for a wrong input
    old, new : text of the function that is replaced; it occurs once
    on : fields of the gear pair without which the changed line is not in use, path -> value
    input : fields of the gear pair that are wrong in the file, for a wrong input
    unseen : why only a measurement can tell; empty for a fault that the verdicts must see
    """

    key: str
    words: str
    target: str = ""
    old: str = ""
    new: str = ""
    on: Mapping[str, Any] = field(default_factory=dict)
    input: Mapping[str, Any] = field(default_factory=dict)
    unseen: str = ""
