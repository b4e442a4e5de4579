"""Symbols and formulas that stand as plain text in a sentence become equations: ``Ω_p r_bp t`` is typeset.

The sources stay readable as plain text. Code and equations are left alone. A formula is a sequence of
symbols, numbers and operators with a sign of mathematics: a Greek letter, an index, a prime, a relation. A
single letter counts on the pages of ``MATHEMATICAL`` alone, where it is a symbol.
"""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Iterator
from dataclasses import dataclass
from enum import Enum
from typing import Any

from docutils import nodes
from sphinx import addnodes
from sphinx.application import Sphinx
from sphinx.transforms.post_transforms import SphinxPostTransform

#: Folders of pages on which a letter that stands alone is a symbol.
MATHEMATICAL = ("theory/",)

_GREEK = {
    letter: unicodedata.name(letter).split()[-1].lower().replace("lamda", "lambda")
    for letter in "αβγδεζηθικλμνξπρστφχψω"
}
_GREEK |= {
    letter: unicodedata.name(letter).split()[-1].title().replace("Lamda", "Lambda") for letter in "ΓΔΘΛΞΠΣΦΨΩ"
}
_GREEK |= {"ε": "varepsilon", "φ": "varphi"}
_ACCENTS = {"\u0307": "dot", "\u0308": "ddot", "\u0304": "bar", "\u0302": "hat", "\u0303": "tilde"}
_RAISED = dict(zip("⁰¹²³⁴⁵⁶⁷⁸⁹⁻⁺ⁿᵀ", "0123456789-+nT", strict=True))
_LOWERED = dict(zip("₀₁₂₃₄₅₆₇₈₉₋₊", "0123456789-+", strict=True))
_OPERATORS = {
    "=": "=", "≤": r"\le ", "≥": r"\ge ", "<": "<", ">": ">", "≈": r"\approx ", "≠": r"\ne ",
    "≪": r"\ll ", "≫": r"\gg ",
    "→": r"\to ", "↦": r"\mapsto ", "∈": r"\in ", "∝": r"\propto ", "−": "-", "+": "+",
    "±": r"\pm ", "·": r"\cdot ",
    "×": r"\times ", "/": "/", "…": r"\dotso ",
}  # fmt: skip
_RELATIONS = frozenset("=≤≥<>≈≠≪≫→↦∈∝")
_SIGNS = {
    "∞": r"\infty ",
    "∂": r"\partial ",
    "∇": r"\nabla ",
    "∫": r"\int ",
    "½": r"\tfrac{1}{2}",
    "∑": r"\sum ",
}
_OPEN = {"(": "(", "[": "[", "⟨": r"\langle ", "⌊": r"\lfloor ", "{": r"\{"}
_CLOSE = {")": ")", "]": "]", "⟩": r"\rangle ", "⌋": r"\rfloor ", "}": r"\}"}
_PAIRED = dict(zip(_CLOSE, _OPEN, strict=True))
_FUNCTIONS = ("sin", "cos", "tan", "max", "min", "ln", "log", "exp", "det")
_NAMED = ("inv", "mod", "sgn", "tr", "diag", "lcm")


class Kind(Enum):
    """What a piece of text is in a formula."""

    SYMBOL = "a letter with index, exponent, accent or prime"
    LETTER = "a Latin letter alone"
    FUNCTION = "sin, max, mod"
    NUMBER = "a number"
    OPERATOR = "between two terms"
    SIGN = "a sign that stands before a term or alone"
    BAR = "modulus or norm"
    OPEN = "an opening bracket"
    CLOSE = "a closing bracket"
    COMMA = "between arguments"
    SPACE = "a blank"
    TEXT = "words, units, punctuation"


@dataclass(frozen=True)
class Piece:
    """A piece of text, its kind and, where it belongs to a formula, its LaTeX."""

    kind: Kind
    text: str
    latex: str = ""


_LETTERS = "A-Za-zℓΑ-Ωα-ω"
_INDEX = r"_(?:\{[^{}]*\}|[A-Za-z0-9Α-Ωα-ω]+(?:,[A-Za-z]+(?![\w]))?(?!_))"
_EXPONENT = r"\^(?:\{[^{}]*\}|\([^()]*\)|[−-]?(?:\d+(?:\.\d+)?|[A-Za-zα-ω]\d*)(?![A-Za-z]))"
_PRIMES = r"(?:[′″]+|[’'](?![A-Za-z]))"
_RAISED_MARK = "[⁰¹²³⁴-⁹⁻⁺ⁿᵀ]+"
_LOWERED_MARK = "[₀-₉₋₊]+"
_MARK = re.compile(rf"{_PRIMES}|{_LOWERED_MARK}|{_RAISED_MARK}|{_INDEX}|{_EXPONENT}|\*(?=[ ,)=]|$)")
_MARKS = rf"(?P<accent>[\u0302-\u0308])?(?P<marks>(?:{_MARK.pattern})*)"
_UNIT_NAME = r"(?:[kMGTmµμn]?(?:N|m|s|g|W|J|K|V|A|h|Hz|Pa)|rad|min|rpm|mm|l|°C?|%)[²³⁻¹]*"
#: Units: behind a number, in brackets, or with a solidus between units.
_UNITS = re.compile(
    rf"(?<=[\d⁰-⁹¹²³])[ \u00a0\n]{_UNIT_NAME}(?:[ /·]{_UNIT_NAME})*(?![\w^′(₀-₉])"
    rf"|\[{_UNIT_NAME}(?:[ /·]{_UNIT_NAME})*\]"
    rf"|\b{_UNIT_NAME}/{_UNIT_NAME}(?:[ ·]{_UNIT_NAME})*(?![\w^′(])|[µμ](?:m|N|s)²?(?![\w^(])"
)
_TOKEN = re.compile(
    rf"(?P<function>(?:{'|'.join((*_FUNCTIONS, *_NAMED))})(?![A-Za-z_-]))(?P<power>[²³]?)"
    rf"|(?P<root>√)"
    r"|(?P<named>Ra)(?=\^)"
    r"|(?P<first>(?<![A-Za-z])[A-Za-z])(?=[A-Za-z](?:[′″ᵀ⁻₀-₉]|_[A-Za-z0-9]))"
    r"|(?P<differential>(?<![A-Za-z])d[xytrhgAlsuTp])(?![A-Za-z])"
    rf"|(?P<word>[A-Za-zÀ-ÿ]{{2,}}(?:[-’'][A-Za-z]+)*)"
    rf"|(?P<end>[)\]⟩|‖])(?P<end_marks>(?:[′″]+|{_RAISED_MARK}|{_INDEX}|{_EXPONENT})+)"
    rf"|(?P<base>\b10(?=[⁻⁰-⁹¹²³^])|[{_LETTERS}])(?:{_MARKS})"
    r"|(?P<number>\d+(?:\.\d+)?°?)|(?P<space>[ \u00a0\n])|(?P<other>.)",
    re.DOTALL,
)
#: Two letters that stand for two symbols.
_PRODUCT = re.compile(r"Gb|Eb|JA|KT|CT|MT")
#: Words behind which a capital letter is a point or a matrix, not the beginning of a sentence or a name.
_BEFORE_A = re.compile(
    r"(?:\b(?:from|beyond|at|before|behind|between|to|and|or|matrix|of|where|near|points?)|[,(])\s\Z", re.I
)
_BEFORE_SMALL_A = re.compile(r"\b(?:distance|width|crack)\s\Z")
_ROMAN = frozenset("IV")


def _mark_latex(mark: str) -> tuple[str, str]:
    """Return index and exponent of a mark."""
    if mark[0] in "_^":
        content = mark[1:].strip("{}()") if mark[1:2] in "{(" else mark[1:]
        inner = "".join(piece.latex or piece.text for piece in _pieces(content))
        return (inner, "") if mark[0] == "_" else ("", inner)
    if mark[0] in _LOWERED:
        return "".join(_LOWERED[one] for one in mark), ""
    if mark[0] in _RAISED:
        return "", "".join(_RAISED[one] for one in mark)
    if mark == "*":
        return "", "*"
    return "", "".join({"′": r"\prime ", "″": r"\prime\prime "}.get(one, r"\prime ") for one in mark)


def _symbol(base: str, accent: str, marks: str) -> str:
    """Return the LaTeX of a symbol with its marks."""
    latex = rf"\{_GREEK[base]} " if base in _GREEK else r"\ell " if base == "ℓ" else base
    if accent:
        latex = rf"\{_ACCENTS[accent]}{{{latex.strip()}}}"
    if base == "Σ" and "_" in marks:
        latex = r"\sum "
    return latex.strip() + _index_and_exponent(marks) + " "


def _index_and_exponent(marks: str) -> str:
    """Return the LaTeX of marks behind a symbol or a bracket."""
    index, exponent = (
        "".join(parts).strip()
        for parts in zip(("", ""), *(_mark_latex(mark) for mark in _MARK.findall(marks)), strict=True)
    )
    return (f"_{{{index}}}" if index else "") + (f"^{{{exponent}}}" if exponent else "")


def _pieces(text: str) -> Iterator[Piece]:
    """Split text into pieces of formulas and words between."""
    position = 0
    while position < len(text):
        unit = _UNITS.match(text, position)
        if unit and not (position and text[position - 1].isalpha()):
            yield Piece(Kind.TEXT, unit[0])
            position = unit.end()
            continue
        token = _TOKEN.match(text, position)
        assert token
        yield _piece(token, text[:position], text[token.end() :])
        position = token.end()


def _piece(token: re.Match[str], before: str, behind: str) -> Piece:
    """Return the piece that a token is, between the texts before and behind it."""
    text = token[0]
    if token["function"]:
        name = token["function"]
        if (
            before[-1:].isalpha()
            or not re.match(r"\s?[(|{A-Za-zα-ωΑ-Ω√∂∫\d]", behind)
            or re.match(r"\s[a-z]{2}", behind)
        ):
            return Piece(Kind.TEXT, text)
        latex = rf"\operatorname{{{name}}}" if name in _NAMED else rf"\{name} "
        power = f"^{{{_RAISED[token['power']]}}}" if token["power"] else ""
        return Piece(Kind.FUNCTION, text, latex.strip() + power + " ")
    if token["root"]:
        return Piece(Kind.SIGN, text, "√")
    if token["word"]:
        beside = before.rstrip()[-1:] in _OPERATORS or behind.lstrip()[:1] in {*_OPERATORS, "("}
        glued = before[-1:] in {*_GREEK, *"(/·)∂"} or behind[:1] in _GREEK
        behind_mark = len(text) == 2 and re.search(r"[ᵀ′″⁻][⁰-⁹¹²]?\Z", before)
        if behind_mark or ((glued or beside) and _PRODUCT.fullmatch(text)):
            return Piece(Kind.LETTER, text, " ".join(text) + " ")
        return Piece(Kind.TEXT, text)
    if token["named"]:
        return Piece(Kind.SYMBOL, text, r"\mathrm{Ra}")
    if token["first"]:
        return Piece(Kind.SYMBOL, text, text + " ")
    if token["differential"]:
        return Piece(Kind.SYMBOL, text, f"d{text[1]} ")
    if token["end"]:
        return _end(token["end"], token["end_marks"])
    if token["base"]:
        if token["base"] == "10":
            return Piece(Kind.NUMBER, text, _symbol("10", "", token["marks"]))
        return _letter(token, before, behind)
    if token["number"]:
        return Piece(Kind.NUMBER, text, text.replace("°", r"^{\circ}"))
    if token["space"]:
        return Piece(Kind.SPACE, text, " ")
    if text in _OPERATORS:
        return Piece(Kind.OPERATOR, text, _OPERATORS[text])
    if text in _SIGNS:
        return Piece(Kind.SIGN, text, _SIGNS[text])
    if text in "|‖":
        return Piece(Kind.BAR, text, "|" if text == "|" else r"\|")
    if text in _OPEN:
        return Piece(Kind.OPEN, text, _OPEN[text])
    if text in _CLOSE:
        return Piece(Kind.CLOSE, text, _CLOSE[text])
    return Piece(Kind.COMMA, text, ", ") if text == "," else Piece(Kind.TEXT, text)


def _end(end: str, marks: str) -> Piece:
    """Return the piece of a closing bracket or bar with index and exponent."""
    kind = Kind.BAR if end in "|‖" else Kind.CLOSE
    latex = {"|": "|", "‖": r"\|"}.get(end) or _CLOSE[end]
    return Piece(kind, end + marks, latex.strip() + _index_and_exponent(marks))


def _letter(token: re.Match[str], before: str, behind: str) -> Piece:
    """Return the piece of a letter with its marks."""
    base, accent, marks = token["base"], token["accent"] or "", token["marks"]
    if accent and accent not in _ACCENTS:
        return Piece(Kind.TEXT, token[0])
    latex = _symbol(base, accent, marks)
    if base in _GREEK or accent or marks:
        if re.search(r"[A-Za-z]{2}\Z", before) and base not in _GREEK:
            return Piece(Kind.TEXT, token[0])
        return Piece(Kind.SYMBOL, token[0], latex)
    product = r"(?<![A-Za-z])[\dα-ωΑ-Ω]\Z|[⁰-⁹¹²³ᵀ′″₀-₉_]\Z|_\w+\Z"
    joined = re.search(r"[\w’'.\-]\Z", before) and not re.search(product, before)
    exponential = base == "e" and before[-1:].isdigit() and behind[:1] in ("-", "−")
    if joined or exponential or re.match(r"\.\w|[’']s?\b|[A-Za-z]{2}|\d", behind):
        return Piece(Kind.TEXT, token[0])
    return Piece(Kind.LETTER, token[0], latex)


def _is_name(letter: str, before: str, behind: str) -> bool:
    """Tell whether a letter alone is an article, a numeral or a name instead of a symbol."""
    follows_name = re.search(
        r"\b(?:laws?|method|type|group|class|appendix|chapter|grade|VG|FZG|AIAA)\s\(?\Z", before, re.I
    )
    if letter == "J" and re.match(r"\. [A-Z\d]", behind):  # a journal
        return True
    if letter == "a":
        return not _BEFORE_SMALL_A.search(before) and not re.match(r"[,.;:)/]", behind)
    if letter == "A":
        points = re.match(r" (?:and|to|or) [B-Z]\b", behind)
        return bool(follows_name) or not (points or _BEFORE_A.search(before))
    return letter in _ROMAN or bool(follows_name)


@dataclass(frozen=True)
class Part:
    """A part of a sentence: its text and, of a formula, its LaTeX."""

    text: str
    latex: str = ""


def parts(text: str, *, letters: bool = False) -> list[Part]:
    """Split a sentence into words and formulas.

    Parameters
    ----------
    text : the sentence
    letters : whether a letter that stands alone is a symbol
    """
    composed = "".join(unicodedata.normalize("NFD", one) if one.isalpha() else one for one in text)
    pieces = list(_pieces(composed))
    result: list[Part] = []
    position = 0
    while position < len(pieces):
        end = _formula_end(pieces, position)
        before = "".join(piece.text for piece in pieces[:position])
        behind = "".join(piece.text for piece in pieces[end:])
        formula = pieces[position:end]
        article = pieces[position].text == "a" and [one.kind for one in formula[1:3]] in (
            [Kind.SPACE, Kind.LETTER],
            [Kind.SPACE, Kind.SYMBOL],
        )
        if formula and not article and _accepted(formula, before, behind, letters):
            result.append(Part("".join(piece.text for piece in formula), _latex(formula)))
            position = end
        else:
            result.append(Part(pieces[position].text))
            position += 1
    return result


_TERM = (Kind.SYMBOL, Kind.LETTER, Kind.NUMBER, Kind.SIGN)


def _formula_end(pieces: list[Piece], start: int) -> int:
    """Return the end of the longest formula that starts at a piece; the start where there is none."""
    best, open_brackets, bars = start, [], 0
    expects_term = True
    position = start
    while position < len(pieces):
        piece = pieces[position]
        kind = piece.kind
        if kind is Kind.TEXT:
            break
        if kind is Kind.SPACE:
            following = pieces[position + 1] if position + 1 < len(pieces) else None
            if position == start or following is None or following.kind in (Kind.SPACE, Kind.TEXT):
                break
            if not expects_term and not _joins(pieces, position, open_brackets):
                break
            position += 1
            continue
        if kind is Kind.COMMA:
            if not open_brackets or expects_term:
                break
            expects_term = True
        elif kind is Kind.OPERATOR:
            if expects_term and piece.text not in "−+±·":
                break
            expects_term = True
        elif kind is Kind.OPEN:
            open_brackets.append(piece.text)
            expects_term = True
        elif kind is Kind.CLOSE:
            if not open_brackets or expects_term or open_brackets[-1] != _PAIRED[piece.text[0]]:
                break
            open_brackets.pop()
            expects_term = False
        elif kind is Kind.BAR:
            bars += 1
            expects_term = bars % 2 == 1 or expects_term
            if bars % 2 == 0 and expects_term:
                break
        elif kind is Kind.FUNCTION:
            expects_term = True
        else:
            expects_term = kind is Kind.SIGN and piece.text in "√∂∇∫∑"
        position += 1
        if not (expects_term or open_brackets or bars % 2):
            best = position
    return best


def _joins(pieces: list[Piece], blank: int, open_brackets: list[str]) -> bool:
    """Tell whether terms on both sides of a blank are one formula: a product, or an operator follows."""
    last, following = pieces[blank - 1], pieces[blank + 1]
    if following.kind is Kind.OPERATOR:
        behind = pieces[blank + 2] if blank + 2 < len(pieces) else None
        unary = behind is None or behind.kind is not Kind.SPACE
        return not (unary and following.text in "−+±")
    if following.kind in (Kind.NUMBER, Kind.COMMA, Kind.CLOSE):
        return False
    if last.kind is Kind.NUMBER and following.kind is Kind.SYMBOL:
        return bool(open_brackets) or _in_formula(pieces, blank)
    if last.kind is Kind.NUMBER:
        factor = following.kind in (Kind.FUNCTION, Kind.OPEN, Kind.BAR) and following.text != "["
        return factor and _in_formula(pieces, blank)
    if following.kind is Kind.OPEN:
        return bool(open_brackets) or last.kind is Kind.CLOSE or _is_factor(pieces[blank + 1 :])
    return bool(open_brackets) or following.text not in ("a", "A", "I")


def _is_factor(pieces: list[Piece]) -> bool:
    """Tell whether the bracket at the beginning holds a sum or a difference of symbols."""
    inside: list[Kind] = []
    for piece in pieces[1:]:
        if piece.kind is Kind.CLOSE:
            return Kind.OPERATOR in inside and (Kind.SYMBOL in inside or Kind.LETTER in inside)
        if piece.kind in (Kind.TEXT, Kind.COMMA):
            return False
        inside.append(piece.kind)
    return False


def _in_formula(pieces: list[Piece], blank: int) -> bool:
    """Tell whether the number before a blank is the factor of a function or follows an operator."""
    before = [piece.kind for piece in pieces[max(0, blank - 4) : blank - 1] if piece.kind is not Kind.SPACE]
    return pieces[blank + 1].kind is Kind.FUNCTION or before[-1:] in ([Kind.OPERATOR], [Kind.SIGN])


def _accepted(formula: list[Piece], before: str, behind: str, letters: bool) -> bool:
    """Tell whether a sequence of terms is mathematics and not words, units or a list of numbers."""
    kinds = [piece.kind for piece in formula]
    if before[-1:].isalpha() or (before.endswith(("-", "_")) and formula[0].kind is not Kind.OPERATOR):
        return False
    if behind[:1].isalpha() and formula[-1].kind in (Kind.LETTER, Kind.SYMBOL):
        return False
    if Kind.SYMBOL in kinds or Kind.FUNCTION in kinds:
        return True
    names = [piece for piece in formula if piece.kind is Kind.LETTER]
    if not names:
        return any(piece.text in ("∞", "√") for piece in formula)
    if len(formula) == 1:
        return letters and not _is_name(formula[0].text, before, behind)
    if any(piece.text in _RELATIONS for piece in formula):
        return True
    return letters and not (kinds[0] is Kind.OPEN and len(formula) == 3 and names[0].text in "IVabc")


def _latex(formula: list[Piece]) -> str:
    """Return the LaTeX of a formula; the argument of a root is the term or the bracket behind it."""
    out, position = "", 0
    while position < len(formula):
        piece = formula[position]
        if piece.latex != "√":
            summed = piece.text == "Σ" and position + 1 < len(formula)
            out += r"\sum " if summed else r"\," if _is_gap(formula, position) else piece.latex
            position += 1
            continue
        end = position + 1
        depth = 0
        while end < len(formula):
            depth += (formula[end].kind is Kind.OPEN) - (formula[end].kind is Kind.CLOSE)
            end += 1
            if depth == 0:
                break
        argument = formula[position + 1 : end]
        if argument and argument[0].kind is Kind.OPEN:
            argument = argument[1:-1]
        out += rf"\sqrt{{{_latex(argument)}}}"
        position = end
    return out.strip()


def _is_gap(formula: list[Piece], position: int) -> bool:
    """Tell whether a piece is a blank between two factors."""
    if formula[position].kind is not Kind.SPACE:
        return False
    sides = (formula[position - 1].kind, formula[position + 1].kind)
    return not {Kind.OPERATOR, Kind.COMMA, Kind.FUNCTION} & set(sides) and formula[position - 1].text != "Σ"


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


def pieces(text: str, *, letters: bool = False) -> Iterator[nodes.Node]:
    """Text as text and math nodes."""
    words = ""
    for part in parts(text, letters=letters):
        if not part.latex:
            words += part.text
            continue
        if words:
            yield nodes.Text(unicodedata.normalize("NFC", words))
        words = ""
        yield nodes.math(part.text, part.latex)
    if words:
        yield nodes.Text(unicodedata.normalize("NFC", words))


class PlainMathematics(SphinxPostTransform):
    """Replace formulas in text by equations."""

    default_priority = 900

    def run(self, **kwargs: Any) -> None:
        """Go through the text of the document."""
        mathematical = self.env.docname.startswith(MATHEMATICAL)
        for text in list(self.document.findall(nodes.Text)):
            node = text.parent
            while node is not None and not isinstance(node, _NOT_TEXT):
                node = node.parent
            if node is not None:
                continue
            letters = mathematical and not isinstance(text.parent, nodes.title)
            typeset = list(pieces(text.astext(), letters=letters))
            if any(isinstance(one, nodes.math) for one in typeset):
                parent = text.parent
                index = parent.index(text)
                parent[index : index + 1] = typeset


def setup(app: Sphinx) -> dict[str, Any]:
    """Register the transform."""
    app.add_post_transform(PlainMathematics)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
