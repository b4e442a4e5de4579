"""Equations as MathML, which browsers draw by themselves: pages need neither network nor script."""

from __future__ import annotations

import re
from typing import Any

from docutils import nodes
from docutils.utils.math import MathError
from docutils.utils.math.latex2mathml import tex2mathml
from sphinx.application import Sphinx
from sphinx.errors import ExtensionError
from sphinx.writers.html5 import HTML5Translator

_RELATION = re.compile(r"[()\[\]{}]|(?P<relation>=|<|>|\\(?:le|ge|approx|ne|in|propto)\b)")
_FUNCTION = r"\\(?:sin|cos|tan|ln|log|exp|operatorname{(?:inv|sgn|mod|tr)})(?![A-Za-z])"
#: Characters of LaTeX that stand in one line.
_SHORT = 20
_TAG = re.compile(r"\\tag\{([^}]*)\}")
#: A dotted or barred symbol with an index, which docutils takes for limits below and above an operator.
_ACCENTED = re.compile(
    r"<munderover>\s*(<mi>[^<]*</mi>)\s*(<m[inr]\w*>(?:[^<]*|(?:\s*<m[ino]>[^<]*</m[ino]>)*\s*)</m\w+>)\s*"
    r"(<mo[^>]*>[˙¨ˉ]</mo>)\s*</munderover>"
)


def mathml(latex: str, *, block: bool) -> str:
    """MathML of an equation.

    Raises
    ------
    ExtensionError : a command that has no MathML here
    """
    try:
        found = str(tex2mathml(_braced(_spaced(latex)), as_block=block))
    except MathError as error:
        raise ExtensionError(f"No MathML for {latex!r}: {error}") from None
    found = _ACCENTED.sub(r"<msub><mover>\1\3</mover>\2</msub>", found)
    # Chromium draws an accent through its letter where the font has no table of accent heights.
    return found.replace('<mover accent="true">', "<mover>")


def _spaced(latex: str) -> str:
    """Set a thin space between a function and the terms beside it, which docutils leaves out."""
    behind = re.sub(rf"({_FUNCTION})(\^(?:\w|{{[^{{}}]*}}))?\s*(?=[\w\\])", r"\1\2\\,", latex)
    return re.sub(rf"(?<=[\w}})])\s*(?={_FUNCTION})", r"\\,", behind)


def _braced(latex: str) -> str:
    """The same with braces about both arguments of every fraction: docutils reads frac 12 as one number."""
    result, rest = "", latex
    while start := re.search(r"\\[td]?frac\s*", rest):
        result, rest = result + rest[: start.start()] + start[0].strip(), rest[start.end() :]
        for _ in range(2):
            argument, rest = _argument(rest.lstrip())
            result += "{" + _braced(argument) + "}"
    return result + rest


def _argument(text: str) -> tuple[str, str]:
    """First argument of a command, without its braces, and what follows."""
    if not text.startswith("{"):
        token = re.match(r"\\[a-zA-Z]+|.", text)
        return (token[0], text[token.end() :]) if token else ("", "")
    depth = 0
    for i, character in enumerate(text):
        depth += (character == "{") - (character == "}")
        if depth == 0:
            return text[1:i], text[i + 1 :]
    return text[1:], ""


def _inline(self: HTML5Translator, node: nodes.math) -> None:
    # Browsers do not break a line inside an equation: a long one is several, and a line may end between.
    self.body.append("<wbr>".join(mathml(part, block=False) for part in _lines(node.astext())))
    raise nodes.SkipNode


def _lines(latex: str) -> list[str]:
    """Split a long equation before its relations; brackets stay together."""
    depth, start, result = 0, 0, []
    for token in _RELATION.finditer(latex):
        depth += token[0] in {"(", "[", "{"}
        depth -= token[0] in {")", "]", "}"}
        if token["relation"] and depth == 0 and token.start() - start > _SHORT:
            result.append(latex[start : token.start()])
            start = token.start()
    return [*result, latex[start:]]


def _block(self: HTML5Translator, node: nodes.math_block) -> None:
    latex = node.astext()
    number = _TAG.search(latex)
    tag = f'<span class="equation-number">({number.group(1)})</span>' if number else ""
    body = mathml(_TAG.sub("", latex).strip(), block=True)
    # The frame scrolls, by keyboard too, where an equation is wider than a phone.
    self.body.append(
        f'<div class="equation"><div class="scroll" tabindex="0" role="math">{body}</div>{tag}</div>\n'
    )
    raise nodes.SkipNode


def setup(app: Sphinx) -> dict[str, Any]:
    """Register the renderer."""
    app.add_html_math_renderer("mathml", inline_renderers=(_inline, None), block_renderers=(_block, None))
    app.config.html_math_renderer = "mathml"
    return {"parallel_read_safe": True, "parallel_write_safe": True}
