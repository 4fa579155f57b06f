"""Changes of a source that a test should notice.

A site is a place in the source; its edits are the wrong programs to be made there. Left alone are docstrings, types,
decorators, imports, assertions (`strict=True` is one) and the texts of errors: a change there breaks nothing, or all.
"""

import ast
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from itertools import pairwise

# Operator -> its text, and the operators that mutants have in its place
OPERATOR_SWAPS: dict[type[ast.AST], tuple[str, tuple[str, ...]]] = {
    ast.Lt: ("<", ("<=", ">")),
    ast.LtE: ("<=", ("<", ">=")),
    ast.Gt: (">", (">=", "<")),
    ast.GtE: (">=", (">", "<=")),
    ast.Eq: ("==", ("!=",)),
    ast.NotEq: ("!=", ("==",)),
    ast.Is: ("is", ("is not",)),
    ast.IsNot: ("is not", ("is",)),
    ast.In: ("in", ("not in",)),
    ast.NotIn: ("not in", ("in",)),
    ast.And: ("and", ("or",)),
    ast.Or: ("or", ("and",)),
    ast.Add: ("+", ("-",)),
    ast.Sub: ("-", ("+",)),
    ast.Mult: ("*", ("/",)),
    ast.MatMult: ("@", ("*",)),
    ast.Div: ("/", ("*",)),
    ast.FloorDiv: ("//", ("*",)),
    ast.Mod: ("%", ("*",)),
    ast.Pow: ("**", ("*",)),
    ast.LShift: ("<<", (">>",)),
    ast.RShift: (">>", ("<<",)),
    ast.BitAnd: ("&", ("|",)),
    ast.BitOr: ("|", ("&",)),
    ast.BitXor: ("^", ("&",)),
}
# Function -> function that mutants call instead
FUNCTION_SWAPS = {"min": "max", "any": "all", "minimum": "maximum", "floor": "ceil", "argmin": "argmax"}
FUNCTION_SWAPS |= {other: name for name, other in FUNCTION_SWAPS.items()}
# Functions whose arguments are not exchanged, because their order does not matter
SYMMETRIC_FUNCTIONS = frozenset({"hypot", "isclose", "allclose", "array_equal", "isinstance", "issubclass", "cast"})
DEFAULT_CALLS = {
    "get": 2,
    "pop": 2,
    "next": 2,
    "getattr": 3,
}  # function -> number of arguments of a call that ends with a default value
# Return annotation -> results that mutants return
CONSTANT_RESULTS = {
    "bool": ("True", "False"),
    "int": ("0", "1"),
    "float": ("0.0", "1.0"),
    "str": ('""',),
    "bytes": ('b""',),
}
CONSTANT_RESULTS |= {
    "list": ("[]",),
    "tuple": ("()",),
    "dict": ("{}",),
    "set": ("set()",),
    "frozenset": ("frozenset()",),
}
UNCHANGED_STATEMENTS = (ast.Import, ast.ImportFrom, ast.Assert, ast.JoinedStr)


@dataclass(frozen=True)
class Edit:
    """Replacement of some bytes of a source."""

    start: int
    end: int
    text: str

    def apply(self, source: bytes) -> bytes:
        """Return the changed source."""
        return source[: self.start] + self.text.encode() + source[self.end :]

    def line(self, source: bytes) -> int:
        """Return the number of the first changed line."""
        return source.count(b"\n", 0, self.start) + 1

    def lines(self, source: bytes) -> tuple[str, str]:
        """Return the old and the new text of the changed lines, each as one line."""
        first = source.rfind(b"\n", 0, self.start) + 1
        last = source.find(b"\n", self.end) % (len(source) + 1)
        changed = source[first : self.start] + self.text.encode() + source[self.end : last]
        was, now = (" ".join(lines.decode().split()) for lines in (source[first:last], changed))
        return was, now


Site = tuple[Edit, ...]
Function = ast.FunctionDef | ast.AsyncFunctionDef


def find_sites(source: bytes) -> list[Site]:
    """Find all places of a source that mutations change, in source order."""
    tree = ast.parse(source)
    starts = [0]
    for line in source.splitlines(keepends=True):
        starts.append(starts[-1] + len(line))
    sites = list(_Finder(source, starts).sites(tree))
    return sorted(sites, key=lambda site: (site[0].start, site[0].end))


class _Finder:
    def __init__(self, source: bytes, starts: list[int]) -> None:
        self._source, self._starts = source, starts

    def sites(self, node: ast.AST) -> Iterator[Site]:
        """Yield the changeable places of a node and of all nodes inside."""
        if isinstance(node, UNCHANGED_STATEMENTS):
            return
        yield from self._own(node)
        for child in _children(node):
            yield from self.sites(child)

    def _own(self, node: ast.AST) -> Iterator[Site]:
        match node:
            case ast.Compare():
                for (left, right), operator in zip(pairwise([node.left, *node.comparators]), node.ops, strict=True):
                    yield self._swap(left, right, operator)
            case ast.BoolOp():
                for left, right in pairwise(node.values):
                    yield self._swap(left, right, node.op)
            case ast.BinOp():
                yield self._swap(node.left, node.right, node.op)
            case ast.AugAssign():
                yield (*self._swap(node.target, node.value, node.op), self._edit(node, "pass"))
            case ast.UnaryOp():
                yield (self._edit(node, f"({self._text(node.operand)})"),)
            case ast.If() | ast.IfExp():
                yield self._condition(node.test, "True", "False")
            case ast.While():
                yield self._condition(node.test, "False")
            case ast.comprehension():
                yield from (self._condition(test, "True", "False") for test in node.ifs)
            case ast.Call(func=ast.Name(id=name) | ast.Attribute(attr=name)) if name in FUNCTION_SWAPS:
                end = self._end(node.func)
                yield (Edit(end - len(name), end, FUNCTION_SWAPS[name]),)
            case ast.Call(
                func=ast.Name(id=name) | ast.Attribute(attr=name), args=[*_, before, default], keywords=[]
            ) if len(node.args) == DEFAULT_CALLS.get(name):
                yield (Edit(self._end(before), self._end(default), ""),)
            case ast.Call(args=[first, second, *_]) if not _is_orderless(node):
                yield from self._exchange(first, second)
            case ast.Slice():
                yield from (self._bound(bound) for bound in (node.lower, node.upper) if bound is not None)
            case ast.match_case(guard=ast.expr() as guard):
                yield self._condition(guard, "True", "False")
            case ast.Constant(value=bool() | int() | float()):
                yield tuple(self._edit(node, value) for value in _others(node.value))
            case ast.Expr(value=ast.Constant()):
                return  # a docstring
            case ast.Expr() | ast.Delete() | ast.Raise() | ast.Break() | ast.Continue():
                yield (self._edit(node, "pass"),)
            case ast.Assign() if _can_be_left_out(node):
                yield (self._edit(node, "pass"),)
            case (
                ast.FunctionDef(returns=ast.Constant(value=None))
                | ast.AsyncFunctionDef(returns=ast.Constant(value=None))
            ):
                yield from self._return_early(node)
            case ast.FunctionDef() | ast.AsyncFunctionDef():
                yield from self._return_another(node)

    def _return_another(self, node: Function) -> Iterator[Site]:
        """Yield mutants that return another value, except in inner functions."""
        for own_return in _own_returns(node.body):
            if own_return.value is not None:
                others = [f"return {result}" for result in _results(node.returns)]
                edits = tuple(self._edit(own_return, other) for other in others if other != self._text(own_return))
                if edits:
                    yield edits

    def _exchange(self, first: ast.expr, second: ast.expr) -> Iterator[Site]:
        """Yield the exchange of two arguments, unless they are equal."""
        whole = Edit(self._edit(first, "").start, self._end(second), "")
        between = self._source[self._end(first) : self._edit(second, "").start].decode()
        starred = isinstance(first, ast.Starred) or isinstance(second, ast.Starred)
        if not starred and self._text(first) != self._text(second):
            yield (Edit(whole.start, whole.end, self._text(second) + between + self._text(first)),)

    def _bound(self, bound: ast.expr) -> Site:
        """Return mutants of a slice bound: shifted by one, or missing."""
        return self._edit(bound, f"({self._text(bound)}) + 1"), self._edit(bound, "")

    def _return_early(self, node: Function) -> Iterator[Site]:
        body = [item for item in node.body if not (isinstance(item, ast.Expr) and isinstance(item.value, ast.Constant))]
        if body and node.name != "__init__":
            yield (self._edit(body[0], "return"),)

    def _condition(self, test: ast.expr, *others: str) -> Site:
        return tuple(self._edit(test, text) for text in (f"not ({self._text(test)})", *others))

    def _swap(self, left: ast.expr, right: ast.expr, operator: ast.AST) -> Site:
        symbol, others = OPERATOR_SWAPS[type(operator)]
        end = self._end(left)
        start = end + self._source[end : self._place(right.lineno, right.col_offset)].index(symbol.encode())
        return tuple(Edit(start, start + len(symbol), other) for other in others)

    def _edit(self, node: ast.expr | ast.stmt, text: str) -> Edit:
        return Edit(self._place(node.lineno, node.col_offset), self._end(node), text)

    def _end(self, node: ast.expr | ast.stmt) -> int:
        return self._place(node.end_lineno, node.end_col_offset)

    def _place(self, line: int | None, column: int | None) -> int:
        return self._starts[(line or 1) - 1] + (column or 0)

    def _text(self, node: ast.expr) -> str:
        whole = self._edit(node, "")
        return self._source[whole.start : whole.end].decode()


def _is_orderless(call: ast.Call) -> bool:
    """Return whether exchanging arguments changes nothing, or always causes an error."""
    match call.func:
        case ast.Name(id=name) | ast.Attribute(attr=name):
            return name in SYMMETRIC_FUNCTIONS
    return False


def _can_be_left_out(assignment: ast.Assign) -> bool:
    """Return whether all assigned names have earlier values."""
    targets = [
        item
        for target in assignment.targets
        for item in (target.elts if isinstance(target, ast.Tuple | ast.List) else [target])
    ]
    read = {item.id for item in ast.walk(assignment.value) if isinstance(item, ast.Name)}
    return all(
        isinstance(target, ast.Attribute | ast.Subscript) or (isinstance(target, ast.Name) and target.id in read)
        for target in targets
    )


def _own_returns(body: Iterable[ast.AST]) -> Iterator[ast.Return]:
    for item in body:
        if isinstance(item, ast.Return):
            yield item
        elif not isinstance(item, Function | ast.Lambda | ast.ClassDef):
            yield from _own_returns(ast.iter_child_nodes(item))


def _results(returns: ast.expr | None) -> tuple[str, ...]:
    """Return the results that mutants return for an annotation."""
    match returns:
        case ast.Name(id=name) | ast.Subscript(value=ast.Name(id=name)):
            return CONSTANT_RESULTS.get(name, ("None",))
    return ("None",)


def _others(value: bool | int | float) -> list[str]:
    """Return the values that mutants have in place of a constant."""
    if isinstance(value, bool):
        return [str(not value)]
    changes: list[Callable[[float], float]] = [lambda x: 2 * x, lambda x: 100 * x, lambda x: 0 * x, lambda x: x + 1]
    if isinstance(value, int):
        changes.append(lambda x: x - 1)
    return sorted({repr(change(value)) for change in changes} - {repr(value)})


def _children(node: ast.AST) -> Iterator[ast.AST]:
    """Yield the children that are executed, without types, decorators and error texts."""
    match node:
        case ast.FunctionDef() | ast.AsyncFunctionDef():
            yield from (default for default in (*node.args.defaults, *node.args.kw_defaults) if default is not None)
            yield from node.body
        case ast.ClassDef():
            yield from node.body
        case ast.AnnAssign():
            yield from () if node.value is None else (node.value,)
        case ast.Assign(targets=[ast.Name(id=name)], value=ast.BinOp() | ast.Subscript()) if name.istitle():
            return  # the name of a type
        case ast.Raise() | ast.Expr(value=ast.Constant()) | ast.keyword(arg="strict"):
            return
        case ast.Lambda():
            yield node.body
        case _:
            yield from ast.iter_child_nodes(node)
