"""Expressions built by operators and calls, and the text in Lua that they stand for. The vocabulary is in solids.py."""
import math
import typing

import numpy

_ATOM, _POWER, _UNARY, _PRODUCT, _SUM, _AND, _OR = 9, 8, 7, 6, 5, 4, 3
_DEPTH_MAX = 40  # of brackets within brackets: Lua's own limit is 200


class Expression:
    """A solid or a field, as the text that describes it: parts that are text, and other expressions."""

    __slots__ = ("_parts", "_rank")
    __array_ufunc__ = None  # numpy.float64(2) * x asks x

    def __init__(self, parts, rank=_ATOM):
        self._parts = tuple(parts)
        self._rank = rank

    def __str__(self):
        return _write(self)

    def __repr__(self):
        text = str(self)
        return f"<laves.solids.Expression {text if len(text) < 200 else text[:197] + '...'}>"

    def __add__(self, other) -> "Expression":
        return _binary(self, "+", other, _SUM)

    def __radd__(self, other) -> "Expression":
        return _binary(other, "+", self, _SUM)

    def __sub__(self, other) -> "Expression":
        return _binary(self, "-", other, _SUM)

    def __rsub__(self, other) -> "Expression":
        return _binary(other, "-", self, _SUM)

    def __mul__(self, other) -> "Expression":
        return _binary(self, "*", other, _PRODUCT)

    def __rmul__(self, other) -> "Expression":
        return _binary(other, "*", self, _PRODUCT)

    def __truediv__(self, other) -> "Expression":
        return _binary(self, "/", other, _PRODUCT)

    def __rtruediv__(self, other) -> "Expression":
        return _binary(other, "/", self, _PRODUCT)

    def __mod__(self, other) -> "Expression":
        return _binary(self, "%", other, _PRODUCT)

    def __rmod__(self, other) -> "Expression":
        return _binary(other, "%", self, _PRODUCT)

    def __pow__(self, other) -> "Expression":
        return _binary(self, "^", other, _POWER)

    def __rpow__(self, other) -> "Expression":
        return _binary(other, "^", self, _POWER)

    def __and__(self, other) -> "Expression":
        return _binary(self, "&", other, _AND)

    def __rand__(self, other) -> "Expression":
        return _binary(other, "&", self, _AND)

    def __or__(self, other) -> "Expression":
        return _binary(self, "|", other, _OR)

    def __ror__(self, other) -> "Expression":
        return _binary(other, "|", self, _OR)

    def __invert__(self) -> "Expression":
        return Expression(["~", _bracketed(self, _UNARY)], _UNARY)

    def __neg__(self) -> "Expression":
        return Expression(["-", _bracketed(self, _UNARY)], _UNARY)

    def __abs__(self) -> "Expression":
        return call("abs", [self])

    if typing.TYPE_CHECKING:  # the methods that solids.py adds

        def __getattr__(self, name: str) -> "typing.Callable[..., Expression]": ...

    def __bool__(self):
        raise TypeError("a solid is neither true nor false; write a & b, a | b, ~a")


# ---- text ----


def _number(value):
    if isinstance(value, int):
        return str(value)
    if not math.isfinite(value):
        raise ValueError(f"{value} is not a finite number")
    return repr(float(value))


def _quoted(text):
    escapes = {'"': '\\"', "\\": "\\\\", "\n": "\\n", "\r": "\\r", "\0": "\\0"}
    return '"' + "".join(escapes.get(c, c) for c in text) + '"'


def _parts_of(value):
    """A value as parts of a text."""
    if isinstance(value, Expression):
        return [value]
    if isinstance(value, str):
        return [_quoted(value)]
    if isinstance(value, numpy.generic) or (isinstance(value, numpy.ndarray) and value.ndim == 0):
        value = value.item()
    if isinstance(value, bool) or not isinstance(value, (int, float, list, tuple, dict, numpy.ndarray)):
        raise TypeError(f"{value!r} has no place in a solid")
    if isinstance(value, (int, float)):
        return [_number(value)]
    return _table(value.items() if isinstance(value, dict) else [(None, v) for v in value])


def _table(items):
    parts = ["{"]
    for i, (name, value) in enumerate(items):
        parts += [", " if i else "", f"{name}=" if name else "", *_parts_of(value)]
    return [*parts, "}"]


def call(function, given, named=(), solid=None):
    """function(given) or, with names, function{given, name=...}; with a solid first, function(solid, ...)."""
    named = [(name, value) for name, value in dict(named).items() if value is not None]
    parts = [function]
    if named and solid is None:
        return Expression(parts + _table([(None, v) for v in given] + named))
    listed = [_parts_of(solid)] if solid is not None else []
    listed += [_table([(None, v) for v in given] + named)] if named else [_parts_of(v) for v in given]
    parts.append("(")
    for i, item in enumerate(listed):
        parts += [", " if i else "", *item]
    return Expression([*parts, ")"])


def _bracketed(value, rank):
    """An operand; in brackets where it binds less tightly than the operator."""
    if isinstance(value, Expression):
        return value if value._rank > rank else Expression(["(", value, ")"])
    parts = _parts_of(value)
    return Expression(parts if not parts[0].startswith("-") else ["(", *parts, ")"])


def _binary(a, sign, b, rank):
    for operand in (a, b):
        if not isinstance(operand, (Expression, int, float, numpy.number)) or isinstance(operand, bool):
            return NotImplemented
    left = _bracketed(a, rank if sign == "^" else rank - 1)  # ^ leans to the right, the others to the left
    return Expression([left, f" {sign} ", _bracketed(b, rank)], rank)


def _write(whole):
    """The text. What is used more than once, and what would be too deep, becomes an item of a list that is filled first."""
    order, uses, stack = [], {}, [(whole, False)]
    while stack:
        node, done = stack.pop()
        if done:
            order.append(node)
            continue
        uses[id(node)] = uses.get(id(node), 0) + 1
        if uses[id(node)] == 1:
            stack.append((node, True))
            stack += [(p, False) for p in node._parts if isinstance(p, Expression)]
    text, depth, lines = {}, {}, []
    for node in order:
        inner = [p for p in node._parts if isinstance(p, Expression)]
        own = "".join(p if isinstance(p, str) else text[id(p)] for p in node._parts)
        deep = 1 + max((depth[id(p)] for p in inner), default=0)
        if node is not whole and ((uses[id(node)] > 1 and len(own) > 8) or deep > _DEPTH_MAX or len(own) > 4000):
            lines.append(f"s[{len(lines) + 1}] = {own}")
            own, deep = f"s[{len(lines)}]", 0
        text[id(node)], depth[id(node)] = own, deep
    if not lines:
        return text[id(whole)]
    return "(function() local s = {} " + "; ".join(lines) + "; return " + text[id(whole)] + " end)()"
