"""Symbols in running text: θ_p and M^k become subscript and superscript.

The sources stay readable as plain text; code, links and equations are left alone.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any

from docutils import nodes
from sphinx import addnodes
from sphinx.application import Sphinx
from sphinx.transforms.post_transforms import SphinxPostTransform

#: One letter, perhaps primed or dotted, or a closing bar, then _index and ^exponent in either order.
_SYMBOL = re.compile(
    r"(?<![^\W\d])(?<![`.\\-])(?P<base>\b10(?=\^)|\(?\|*[^\W\d_][\u0300-\u036f′]*\|?)"
    r"(?P<marks>(?:_(?:[^\W_²³¹⁰-⁹]+|\{[^{}]*\})|\^(?:\{[^{}]*\}|[−-]?(?:\d+(?:\.\d+)?|[^\W\d_]\d*|\w)))+)(?![^\W_²³¹⁰-⁹])"
)
_MARK = re.compile(r"([_^])\{?([^_^{}]+)\}?")
_NOT_TEXT = (
    nodes.literal,
    nodes.literal_block,
    nodes.math,
    nodes.math_block,
    nodes.raw,
    nodes.comment,
    nodes.FixedTextElement,
    addnodes.desc_signature,
    addnodes.literal_strong,
    addnodes.literal_emphasis,
)


def pieces(text: str) -> Iterator[nodes.Node]:
    """Text as text, subscript and superscript nodes."""
    end = 0
    for symbol in _SYMBOL.finditer(text):
        yield nodes.Text(text[end : symbol.start()] + symbol["base"])
        for kind, mark in _MARK.findall(symbol["marks"]):
            node = nodes.subscript if kind == "_" else nodes.superscript
            yield node("", nodes.Text(mark))
        end = symbol.end()
    yield nodes.Text(text[end:])


class Scripts(SphinxPostTransform):
    """Replace symbols in text."""

    default_priority = 900

    def run(self, **kwargs: Any) -> None:
        """Go through the text of the document."""
        for text in list(self.document.findall(nodes.Text)):
            node = text.parent
            while node is not None and not isinstance(node, _NOT_TEXT):
                node = node.parent
            if node is None and _SYMBOL.search(text.astext()):
                parent = text.parent
                index = parent.index(text)
                parent[index : index + 1] = list(pieces(text.astext()))


def setup(app: Sphinx) -> dict[str, Any]:
    """Register the transform."""
    app.add_post_transform(Scripts)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
