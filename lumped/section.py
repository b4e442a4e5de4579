"""The base of every part of the schema."""

from __future__ import annotations

import unicodedata
from typing import Annotated

from pydantic import AfterValidator, BaseModel, ConfigDict
from pydantic_core import PydanticCustomError


class Section(BaseModel):
    """Base of every part of the schema: frozen, and unknown keys are errors."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)


def _readable(text: str) -> str:
    if any(unicodedata.category(c) == "Cc" and c not in "\t\n\r" for c in text):
        context = {"value": ascii(text)[:60], "allowed": "text without control characters"}
        raise PydanticCustomError(
            "quantity", "{value}: allowed {allowed}. {action}", {**context, "action": "Remove them."}
        )
    return text


#: Free text. Terminals obey control characters, and result files cannot hold them all.
Text = Annotated[str, AfterValidator(_readable)]
