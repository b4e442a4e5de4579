"""The small changes that can be made to a source: one span of its text is replaced by another.

Only what is computed is changed. Docstrings, annotations, decorators, imports, refusals and assertions keep
their text, and so does a span whose change is none by construction: the order of arguments of ``max``, five
per cent of a bound on rounding.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

#: Names of functions that are exchanged, as a word after the last dot.
_EXCHANGED = {
    "min": "max", "minimum": "maximum", "fmin": "fmax", "nanmin": "nanmax", "argmin": "argmax", "sin": "cos",
}  # fmt: skip
_EXCHANGED |= {other: name for name, other in _EXCHANGED.items()}
_MAGNITUDES = ("abs", "fabs", "absolute")
#: Functions whose arguments in another order give the same, and those whose arguments are no physics.
_ANY_ORDER = {
    "min", "max", "minimum", "maximum", "fmin", "fmax", "hypot", "add", "multiply", "gcd", "array_equal",
    "isinstance", "issubclass", "getattr", "setattr", "hasattr", "cast", "partial", "zip",
}  # fmt: skip
#: Calls that only speak: the text of a refusal, a warning.
_SPEECH = ("refuse", "warn", "warning")
_COMPARED = {
    ast.Lt: ("<", ">", "<="),
    ast.LtE: ("<=", ">=", "<"),
    ast.Gt: (">", "<", ">="),
    ast.GtE: (">=", "<=", ">"),
}
_SHOWN = ("__repr__", "__str__")
#: A number below this is a bound on rounding, which may as well be five per cent smaller.
_ROUNDING = 1e-7


@dataclass(frozen=True)
class Mutation:
    """One change of a source: its bytes from ``start`` to ``end`` become ``new``."""

    operator: str
    start: int
    end: int
    new: str

    def applied(self, source: str) -> str:
        """Return the source with the change."""
        content = source.encode()
        return (content[: self.start] + self.new.encode() + content[self.end :]).decode()


def mutations(source: str) -> list[Mutation]:
    """Return every change that the operators make to a source, by place."""
    finder = _Finder(source)
    finder.visit(ast.parse(source))
    return sorted(finder.changes, key=lambda one: (one.start, one.end, one.operator, one.new))


def differs(source: str, other: str) -> bool:
    """Whether another source compiles and is not the same program in other words."""
    try:
        compile(other, "<mutant>", "exec", dont_inherit=True)
    except SyntaxError:
        return False
    return ast.dump(ast.parse(source)) != ast.dump(ast.parse(other))


class _Finder(ast.NodeVisitor):
    """Collects the changes; a method for each kind of node that has some, or that is left alone."""

    def __init__(self, source: str) -> None:
        self.source = source.encode()
        self.lines = [0]
        for line in self.source.splitlines(keepends=True):
            self.lines.append(self.lines[-1] + len(line))
        self.words = {*re.findall(r"\w+", source)}
        self.changes: list[Mutation] = []

    def start(self, node: ast.expr) -> int:
        return self.lines[node.lineno - 1] + node.col_offset

    def end(self, node: ast.expr) -> int:
        assert node.end_lineno is not None
        assert node.end_col_offset is not None
        return self.lines[node.end_lineno - 1] + node.end_col_offset

    def text(self, node: ast.expr) -> str:
        return self.source[self.start(node) : self.end(node)].decode()

    def add(self, operator: str, start: int, end: int, new: str) -> None:
        self.changes.append(Mutation(operator, start, end, new))

    def token(self, left: ast.expr, right: ast.expr, symbol: str) -> tuple[int, int]:
        """Place of the symbol between two operands, past any parentheses and comments."""
        begin = self.end(left)
        between = re.sub(
            rb"#[^\n]*", lambda comment: b" " * len(comment[0]), self.source[begin : self.start(right)]
        )
        place = begin + between.index(symbol.encode())
        return place, place + len(symbol)

    # What is left alone.
    def visit_FunctionDef(self, node: ast.FunctionDef) -> None:
        if node.name not in _SHOWN:
            for part in (*node.args.defaults, *filter(None, node.args.kw_defaults), *node.body):
                self.visit(part)

    def visit_ClassDef(self, node: ast.ClassDef) -> None:
        for part in node.body:
            self.visit(part)

    def visit_AnnAssign(self, node: ast.AnnAssign) -> None:
        if node.value is not None:
            self.visit(node.value)

    def visit_Raise(self, node: ast.Raise) -> None:
        pass

    def visit_Assert(self, node: ast.Assert) -> None:
        pass

    def visit_JoinedStr(self, node: ast.JoinedStr) -> None:
        pass

    # Conditions.
    def _negate(self, test: ast.expr) -> None:
        if isinstance(test, ast.UnaryOp) and isinstance(test.op, ast.Not):
            self.add("condition negated", self.start(test), self.start(test.operand), "")
        else:
            self.add("condition negated", self.start(test), self.end(test), f"not ({self.text(test)})")

    def visit_If(self, node: ast.If) -> None:
        if "TYPE_CHECKING" not in self.text(node.test) and "__name__" not in self.text(node.test):
            self._negate(node.test)
            self.generic_visit(node)

    def visit_While(self, node: ast.While) -> None:
        self._negate(node.test)
        self.generic_visit(node)

    def visit_IfExp(self, node: ast.IfExp) -> None:
        self._negate(node.test)
        self.generic_visit(node)

    def visit_comprehension(self, node: ast.comprehension) -> None:
        for test in node.ifs:
            self._negate(test)
        self.generic_visit(node)

    def visit_BoolOp(self, node: ast.BoolOp) -> None:
        symbol, other = ("and", "or") if isinstance(node.op, ast.And) else ("or", "and")
        self.add("and, or exchanged", *self.token(node.values[0], node.values[1], symbol), other)
        self.generic_visit(node)

    def visit_Compare(self, node: ast.Compare) -> None:
        operands = (node.left, *node.comparators)
        for place, comparison in enumerate(node.ops):
            if (kind := type(comparison)) in _COMPARED:
                symbol, reverse, strict = _COMPARED[kind]
                span = self.token(operands[place], operands[place + 1], symbol)
                self.add("comparison reversed", *span, reverse)
                self.add("strictness changed", *span, strict)
        self.generic_visit(node)

    # Arithmetic.
    def visit_BinOp(self, node: ast.BinOp) -> None:
        self.generic_visit(node)
        if _is_text(node.left) or _is_text(node.right):
            return
        if isinstance(node.op, (ast.Mult, ast.Div)):
            symbol, other = ("*", "/") if isinstance(node.op, ast.Mult) else ("/", "*")
            self.add("*, / exchanged", *self.token(node.left, node.right, symbol), other)
        elif isinstance(node.op, (ast.Add, ast.Sub)):
            symbol, other = ("+", "-") if isinstance(node.op, ast.Add) else ("-", "+")
            begin, end = self.token(node.left, node.right, symbol)
            self.add("+, - exchanged", begin, end, other)
            self.add("term dropped", begin, self.end(node), "")
            if symbol == "+":
                self.add("term dropped", self.start(node), end, "")

    def visit_UnaryOp(self, node: ast.UnaryOp) -> None:
        if isinstance(node.op, ast.USub):
            self.add("sign of a term", self.start(node), self.start(node) + 1, "+")
        self.generic_visit(node)

    def visit_Constant(self, node: ast.Constant) -> None:
        value = node.value
        span = (self.start(node), self.end(node))
        if isinstance(value, float) and _ROUNDING < abs(value) < float("inf"):
            self.add("constant changed", *span, repr(float(f"{0.95 * value:.12g}")))
        elif isinstance(value, int) and not isinstance(value, bool):
            self.add("constant changed", *span, str(value + 1))
        elif value in ("pinion", "gear"):
            self.add("pinion, gear exchanged", *span, repr("gear" if value == "pinion" else "pinion"))

    def visit_Subscript(self, node: ast.Subscript) -> None:
        self.visit(node.value)
        parts = node.slice.elts if isinstance(node.slice, ast.Tuple) else [node.slice]
        for part in parts:
            if isinstance(part, ast.Constant) and type(part.value) is int and part.value in (0, 1):
                self.add("index 0, 1 exchanged", self.start(part), self.end(part), str(1 - part.value))
            else:
                self.visit(part)

    # Names and calls.
    def _exchange_gears(self, node: ast.expr, name: str) -> None:
        swapped = _other_gear(name)
        if swapped != name and swapped in self.words:
            self.add("pinion, gear exchanged", self.end(node) - len(name.encode()), self.end(node), swapped)

    def visit_Name(self, node: ast.Name) -> None:
        if isinstance(node.ctx, ast.Load):
            self._exchange_gears(node, node.id)

    def visit_Attribute(self, node: ast.Attribute) -> None:
        if isinstance(node.ctx, ast.Load):
            self._exchange_gears(node, node.attr)
        self.visit(node.value)

    def visit_Call(self, node: ast.Call) -> None:
        name = self.text(node.func).rpartition(".")[2]
        if name in _SPEECH:
            return
        if name in _EXCHANGED:
            self.add(f"{min(name, _EXCHANGED[name])}, {max(name, _EXCHANGED[name])} exchanged",
                     self.end(node.func) - len(name), self.end(node.func), _EXCHANGED[name])  # fmt: skip
        if name in _MAGNITUDES and len(node.args) == 1 and not node.keywords:
            self.add("abs dropped", self.start(node.func), self.end(node.func), "")
        if name not in _ANY_ORDER:
            for first, second in self._alike(node.args):
                a = self.text(first)
                b = self.text(second)
                between = self.source[self.end(first) : self.start(second)].decode()
                self.add("arguments exchanged", self.start(first), self.end(second), b + between + a)
        self.generic_visit(node)

    def _alike(self, arguments: list[ast.expr]) -> Iterator[tuple[ast.expr, ast.expr]]:
        """Neighbours whose names are alike: any test sees it where a pair stands in the place of a length."""
        for first, second in pairwise(arguments):
            a = self.text(first)
            b = self.text(second)
            if isinstance(first, ast.Attribute) and isinstance(second, ast.Attribute):
                alike = self.text(first.value) == self.text(second.value) or first.attr == second.attr
            else:
                both = isinstance(first, ast.Name) and isinstance(second, ast.Name)
                alike = both and (max(len(a), len(b)) <= 2 or bool({*a.split("_")} & {*b.split("_")}))
            if alike and a != b:
                yield first, second


def _is_text(node: ast.expr) -> bool:
    """Whether an operand is a text, a list or a tuple: their sums and multiples are no arithmetic."""
    if isinstance(node, ast.BinOp):
        return _is_text(node.left) or _is_text(node.right)
    if isinstance(node, ast.Constant):
        return isinstance(node.value, str)
    return isinstance(node, (ast.JoinedStr, ast.List, ast.Tuple))


def _other_gear(name: str) -> str:
    """The same name of the other gear: pinion and gear are exchanged, or the endings ``_p`` and ``_g``."""
    other = {"pinion": "gear", "gear": "pinion"}
    *words, last = name.split("_")
    ends = other | ({"p": "g", "g": "p"} if words else {})
    return "_".join([*(other.get(word, word) for word in words), ends.get(last, last)])
