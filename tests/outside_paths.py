"""Search for all places in the package where a string becomes a path.

A place is an expression with a variable part: `Path(text)`, `folder / name`, `with_name(name)` and similar, a call of
`os`, `shutil`, `tempfile`, `open` or a library that takes a path, and a writing method of a path. Types are estimated
from annotations and assignments; `/` counts if its left side is a path or its right side a string.
"""

import ast
import re
from collections.abc import Collection, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TypeVar

# Methods that append text to a path
JOIN_METHODS = {"joinpath", "with_name", "with_suffix", "with_stem"}
JOIN_METHODS |= {"entry_path", "entry_status", "open_entry", "remove_entry", "rename_entry"}  # of a HeldFolder
WRITE_METHODS = {"write_text", "write_bytes", "symlink_to", "hardlink_to", "mkdir", "rmdir", "touch", "unlink", "chmod"}
PATH_METHODS = {"resolve", "absolute", "expanduser", "with_name", "with_suffix", "with_stem", "joinpath", "relative_to"}
PATH_LISTS = {"iterdir", "glob", "rglob"}  # methods that yield paths
PATH_ATTRIBUTES = {"parent", "parents"}  # attributes that are paths
PATH_WORDS = re.compile(  # files without these words need not be parsed
    r"\b(pathlib|os|shutil|tempfile|open|CONFIGS|FOLDER|path|folder|with_(name|suffix|stem)|joinpath)\b"
)
# Syntax nodes that bind a name to a value
BINDING_NODES = (ast.Assign, ast.NamedExpr, ast.For, ast.comprehension, ast.withitem)
PATH_MODULES = {"os", "shutil", "tempfile"}  # modules whose functions take paths
PATH_ARGUMENTS = {"prefix", "suffix", "dir", "path", "src", "dst"}  # keyword arguments that are paths
LIBRARY_CALLS = {  # library functions that open a file by its path
    *("np.load", "np.savez", "np.savez_compressed", "np.fromfile", "wave.open", "Image.open", "ZipFile"),
    *("mujoco.MjSpec.from_file", "mujoco.MjModel.from_xml_path", "mujoco.MjModel.from_binary_path"),
}
LIBRARY_FUNCTIONS = {call.rpartition(".")[2] for call in LIBRARY_CALLS}  # their names without module
HARMLESS_CALLS = {  # functions of these modules without path arguments
    *("getpid", "getppid", "getuid", "geteuid", "cpu_count", "nice", "dup", "dup2", "close", "fsync", "fstat", "read"),
    *("write", "pread", "pwrite", "ftruncate", "fchmod", "set_blocking", "openpty", "ttyname", "memfd_create", "kill"),
    *("fdopen", "strerror", "waitpid", "killpg", "getloadavg", "sched_getaffinity", "getenv", "urandom", "fsync"),
    *("setpriority", "sched_param", "sched_setscheduler", "WEXITSTATUS", "WIFEXITED", "WTERMSIG", "samestat", "fork"),
    *("commonpath", "dirname", "basename", "splitext", "which"),
    *("isatty", "get_terminal_size", "_exit", "set_inheritable", "fspath", "fsencode", "fsdecode", "getcwd", "pipe"),
}

T = TypeVar("T", bound=ast.expr)


@dataclass(frozen=True, order=True)
class PathPlace:
    """Expression that turns a string into a path, with its function."""

    module: str  # path relative to the project root
    function: str
    line: int
    text: str


def find_places(root: Path) -> list[PathPlace]:
    """Find all expressions of a package that turn strings into paths."""
    texts = {file: file.read_text(encoding="utf-8") for file in sorted(root.rglob("*.py"))}
    trees = {file: ast.parse(text) for file, text in texts.items() if PATH_WORDS.search(text)}
    names = _PathNames.of(trees.values())
    places = [
        PathPlace(file.relative_to(root.parent).as_posix(), function, node.lineno, ast.unparse(node))
        for file, tree in trees.items()
        for function, node in _places(tree, names)
    ]
    return sorted(places)


@dataclass(frozen=True)
class _PathNames:
    """Names of attributes, functions and constants that hold paths in the package."""

    attributes: frozenset[str]
    functions: frozenset[str]
    constants: frozenset[str]

    @classmethod
    def of(cls, trees: Collection[ast.Module]) -> "_PathNames":
        nodes = [node for tree in trees for node in _list_nodes(tree)]
        fields = {
            node.target.id
            for node in nodes
            if isinstance(node, ast.AnnAssign) and isinstance(node.target, ast.Name) and _is_path_type(node.annotation)
        }
        fields |= {name for node in nodes if isinstance(node, ast.FunctionDef) for name in _kept_paths(node)}
        functions = {
            node.name
            for node in nodes
            if isinstance(node, ast.FunctionDef) and node.returns and _is_path_type(node.returns)
        }
        known = cls(frozenset(fields), frozenset(functions), frozenset())
        for _ in range(3):  # constants derived from constants
            constants = {
                target.id
                for tree in trees
                for node in tree.body
                if isinstance(node, ast.Assign)
                for target, value in _pairs(node, ast.Name)
                if _is_path(value, known, set())
            }
            known = cls(known.attributes, known.functions, frozenset(constants))
        return known


def _list_children(node: ast.AST) -> list[ast.AST]:
    """Return the child nodes without `ast.Load` and `ast.Store`, in a third of the time of `ast`."""
    children: list[ast.AST] = []
    for value in vars(node).values():
        if isinstance(value, list):
            children += [item for item in value if isinstance(item, ast.AST)]
        elif isinstance(value, ast.AST) and not isinstance(value, ast.expr_context):
            children.append(value)
    return children


def _list_nodes(node: ast.AST) -> list[ast.AST]:
    """Return a node and all nodes inside it, like `ast.walk`."""
    nodes = [node]
    for each in nodes:  # grows meanwhile
        nodes += _list_children(each)
    return nodes


def _kept_paths(function: ast.FunctionDef) -> Iterator[str]:
    """Yield the attributes to which a method assigns its arguments that are paths."""
    given = {arg.arg for arg in function.args.args if arg.annotation is not None and _is_path_type(arg.annotation)}
    for node in _list_nodes(function):
        if isinstance(node, ast.Assign):
            for target, value in _pairs(node, ast.Attribute):
                if isinstance(value, ast.Name) and value.id in given:
                    yield target.attr


def _places(tree: ast.Module, names: _PathNames) -> Iterator[tuple[str, ast.expr]]:
    """Yield a module's expressions that turn strings into paths."""

    def visit(node: ast.AST, function: str, paths: set[str]) -> Iterator[tuple[str, ast.expr]]:
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef):
            function = f"{function}.{node.name}".lstrip(".")
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
            paths = _local_paths(node, names, paths)
        if isinstance(node, ast.expr) and (_is_place(node, names, paths) or _calls_imported(node, imported, names)):
            yield function or "<module>", node
        for child in _list_children(node):
            yield from visit(child, function, paths)

    imported = {
        alias.asname or alias.name
        for node in tree.body
        if isinstance(node, ast.ImportFrom) and (node.module or "").split(".")[0] in PATH_MODULES
        for alias in node.names
    }
    yield from visit(tree, "", set())


def _is_place(node: ast.expr, names: _PathNames, paths: set[str]) -> bool:
    match node:
        case ast.BinOp(left=left, op=ast.Div(), right=right):
            return (_is_text(right) or _is_path(left, names, paths)) and not _is_constant(right, names)
        case ast.Call(func=ast.Name(id="Path" | "open"), args=[first, *_]):
            return not _is_constant(first, names)
        case ast.Call(func=ast.Attribute(value=ast.Name(id=module), attr=attr)) if module in PATH_MODULES:
            return attr not in HARMLESS_CALLS and _varies(node, names)
        case ast.Call(func=ast.Name(id=last) | ast.Attribute(attr=last) as called, args=[first, *_]) if (
            last in LIBRARY_FUNCTIONS and ast.unparse(called) in LIBRARY_CALLS
        ):
            return not _is_constant(first, names)
        case ast.Call(func=ast.Attribute(attr=attr), args=arguments) if attr in JOIN_METHODS:
            return not all(_is_constant(argument, names) for argument in arguments)
        case ast.Call(func=ast.Attribute(attr=attr)) if attr in WRITE_METHODS:
            return True
        case ast.Call(func=ast.Attribute(attr="open"), args=[ast.Constant(value=str(mode)), *_]):
            return any(letter in mode for letter in "wax+")
    return False


def _calls_imported(node: ast.expr, imported: set[str], names: _PathNames) -> bool:
    """Return whether a call uses an imported name of `os`, `shutil` or `tempfile`."""
    match node:
        case ast.Call(func=ast.Name(id=name)) if name in imported - HARMLESS_CALLS:
            return _varies(node, names)
    return False


def _varies(call: ast.Call, names: _PathNames) -> bool:
    """Return whether a call has a path argument that is not constant."""
    named = [keyword.value for keyword in call.keywords if keyword.arg in PATH_ARGUMENTS]
    return not all(_is_constant(item, names) for item in (*call.args, *named))


def _is_constant(node: ast.expr, names: _PathNames) -> bool:
    """Return whether an expression is the same in every run."""
    match node:
        case ast.Constant():
            return True
        case ast.Name(id=name):
            return name.isupper() or name == "__file__"
        case ast.Call(func=ast.Name(id="str" | "files"), args=arguments):
            return all(_is_constant(argument, names) for argument in arguments)
        case ast.Attribute(value=ast.Name(id="mujoco" | "os")):
            return True
    return False


def _is_text(node: ast.expr) -> bool:
    """Return whether an expression is a string."""
    match node:
        case ast.JoinedStr() | ast.Constant(value=str()) | ast.Attribute(attr="name" | "stem" | "file"):
            return True
        case ast.Call(func=ast.Name(id="str")):
            return True
    return False


def _is_path(node: ast.expr, names: _PathNames, paths: set[str]) -> bool:
    match node:
        case ast.Name(id=name):
            return name in paths or name in names.constants
        case ast.Attribute(value=value, attr=attr):
            return attr in names.attributes or (attr in PATH_ATTRIBUTES and _is_path(value, names, paths))
        case ast.Call(func=ast.Name(id=name)):
            return name == "Path" or name in names.functions
        case ast.Call(func=ast.Attribute(attr=attr)):
            return attr in PATH_METHODS or attr in names.functions
        case ast.BinOp(left=left, op=ast.Div(), right=right):
            return _is_text(right) or _is_path(left, names, paths)
        case ast.BoolOp(values=values):
            return any(_is_path(value, names, paths) for value in values)
        case ast.IfExp(body=body, orelse=orelse):
            return _is_path(body, names, paths) or _is_path(orelse, names, paths)
        case ast.Subscript(value=value):
            return _is_path(value, names, paths)
    return False


def _local_paths(function: ast.FunctionDef | ast.AsyncFunctionDef, names: _PathNames, outer: set[str]) -> set[str]:
    """Return the variables inside a function that hold paths."""
    results, every = set(outer), (*function.args.posonlyargs, *function.args.args, *function.args.kwonlyargs)
    for argument in every:
        if argument.annotation is not None and _is_path_type(argument.annotation):
            results.add(argument.arg)
        else:
            results.discard(argument.arg)
    bindings = [node for node in _list_nodes(function) if isinstance(node, BINDING_NODES)]
    for _ in range(2):  # paths derived from paths
        for node in bindings:
            match node:
                case ast.Assign():
                    results |= {
                        target.id for target, value in _pairs(node, ast.Name) if _is_path(value, names, results)
                    }
                case ast.NamedExpr(target=ast.Name(id=name), value=value) if _is_path(value, names, results):
                    results.add(name)
                case (
                    ast.For(target=ast.Name(id=name), iter=iterated)
                    | ast.comprehension(target=ast.Name(id=name), iter=iterated)
                ) if _lists_paths(iterated, names, results):
                    results.add(name)
                case ast.withitem(context_expr=ast.Call(func=ast.Name(id=called)), optional_vars=ast.Name(id=name)):
                    if called in names.functions:
                        results.add(name)
    return results


def _lists_paths(node: ast.expr, names: _PathNames, paths: set[str]) -> bool:
    match node:
        case ast.Call(func=ast.Attribute(attr=attr)) if attr in PATH_LISTS:
            return True
        case ast.Call(func=ast.Name(id="sorted" | "islice" | "list" | "tuple"), args=[first, *_]):
            return _lists_paths(first, names, paths)
        case ast.Tuple(elts=parts) | ast.List(elts=parts) | ast.Set(elts=parts):
            return any(_is_path(part, names, paths) for part in parts)
    return _is_path(node, names, paths)


def _pairs(node: ast.Assign, kind: type[T]) -> Iterator[tuple[T, ast.expr]]:
    """Yield the assignment targets of one node type with their values."""
    for target in node.targets:
        if isinstance(target, ast.Tuple):
            values = node.value.elts if isinstance(node.value, ast.Tuple) else [node.value] * len(target.elts)
            yield from (
                (each, value) for each, value in zip(target.elts, values, strict=False) if isinstance(each, kind)
            )
        elif isinstance(target, kind):
            yield target, node.value


def _is_path_type(annotation: ast.expr) -> bool:
    """Return whether an annotation contains a path type.

    Examples: Path, Path | None, Sequence[Path], Iterator[Path].
    """
    return any(isinstance(node, ast.Name) and node.id == "Path" for node in ast.walk(annotation))
