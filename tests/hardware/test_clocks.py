"""Clock changes, by hand or from the net, move no robot: wall time is used for labels only."""

import ast
import re
from pathlib import Path

import kinesic

ROOT = Path(kinesic.__file__).parent
LABELS = {  # the time of day of an event, of a backup or version of a document, a folder's name
    "hardware/supervisor/status.py",
    "report/output.py",
    "serve/desk/archive.py",
    "serve/desk/backups.py",
}
WALL = {("time", "time"), ("time", "time_ns"), ("time", "localtime"), ("time", "gmtime"), ("datetime", "now")}
NAMED = re.compile(r"\b(time_ns|localtime|gmtime|now)\b|\btime(\.| import .*\b)time\b", re.DOTALL)


def wall_clocks(source: str) -> bool:
    """Return whether a file reads the wall clock; files without any of the words are not parsed."""
    if not NAMED.search(source):
        return False
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name) and (node.value.id, node.attr) in WALL:
            return True
        if isinstance(node, ast.ImportFrom) and any((node.module, name.name) in WALL for name in node.names):
            return True
    return False


def test_only_listed_modules_read_the_wall_clock():
    assert wall_clocks("import time\nprint(time.time())")
    assert wall_clocks("from time import time as wall_time")
    paths = {path.relative_to(ROOT).as_posix() for path in ROOT.rglob("*.py") if wall_clocks(path.read_text())}
    assert paths == LABELS
