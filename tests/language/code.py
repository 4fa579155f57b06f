"""Docstring first lines, module constants, parameters and public names of Python sources."""

import ast
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from .rules import MAX_PARAMETERS, has_old_word, is_one_word, is_unclear

Function = ast.FunctionDef | ast.AsyncFunctionDef
Documented = Function | ast.ClassDef | ast.Module


@dataclass(frozen=True, eq=False)
class Finding:
    """One text of a source file, and whether it breaks the rule of its kind."""

    kind: str
    place: str  # path:line
    text: str
    is_offender: bool


def read_findings(path: Path, name: str) -> Iterator[Finding]:
    """Yield all checked texts of one Python file.

    Args:
        path: of the file.
        name: of the file in the findings' places.
    """
    tree = ast.parse(path.read_text(encoding="utf-8"))
    for node in ast.walk(tree):
        if isinstance(node, Documented) and (docstring := ast.get_docstring(node)):
            first_line, place = docstring.splitlines()[0], f"{name}:{node.body[0].lineno}"
            yield Finding("first lines", place, first_line, is_unclear(first_line))
            yield Finding("old words", place, first_line, has_old_word(first_line))
        if isinstance(node, Function):
            yield Finding(
                "long signatures", f"{name}:{node.lineno}", node.name, _count_parameters(node) > MAX_PARAMETERS
            )
    for statement in tree.body:
        if isinstance(statement, Function | ast.ClassDef) and not statement.name.startswith("_"):
            yield Finding("public names", f"{name}:{statement.lineno}", statement.name, False)
        for names in _constant_names(statement):
            is_offender = len(names) > 1 or is_one_word(names[0])
            yield Finding("constants", f"{name}:{statement.lineno}", ", ".join(names), is_offender)


def _count_parameters(node: Function) -> int:
    """Return the number of a function's parameters, without `self` and `cls`."""
    arguments = node.args
    named = [*arguments.posonlyargs, *arguments.args, *arguments.kwonlyargs]
    variable = [argument for argument in (arguments.vararg, arguments.kwarg) if argument]
    return len([item for item in named if item.arg not in ("self", "cls")]) + len(variable)


def _constant_names(statement: ast.stmt) -> Iterator[list[str]]:
    """Yield the upper-case names that each target of an assignment sets."""
    if isinstance(statement, ast.Assign):
        targets = statement.targets
    elif isinstance(statement, ast.AnnAssign):
        targets = [statement.target]
    else:
        return
    for target in targets:
        elements = target.elts if isinstance(target, ast.Tuple) else [target]
        if names := [element.id for element in elements if isinstance(element, ast.Name) and element.id.isupper()]:
            yield names
