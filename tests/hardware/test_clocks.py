"""Changes of the system clock move no robot."""

import ast
import re
from pathlib import Path

import kinesic

ROOT = Path(kinesic.__file__).parent
WALL_CLOCK_USERS = {  # modules that read the time of day, only to label events, backups, reports and folders
    "cli/servos/accept.py",
    "hardware/supervisor/status.py",
    "report/output.py",
    "serve/desk/archive.py",
    "serve/desk/backups.py",
}
WALL_CLOCK_CALLS = {
    ("time", "time"),
    ("time", "time_ns"),
    ("time", "localtime"),
    ("time", "gmtime"),
    ("datetime", "now"),
}
# Words without which a file reads no wall clock
CLOCK_WORDS = re.compile(r"\b(time_ns|localtime|gmtime|now)\b|\btime(\.| import .*\b)time\b", re.DOTALL)


def wall_clocks(source: str) -> bool:
    """Return whether a source file reads the wall clock."""
    if not CLOCK_WORDS.search(source):
        return False
    for node in ast.walk(ast.parse(source)):
        if (
            isinstance(node, ast.Attribute)
            and isinstance(node.value, ast.Name)
            and (node.value.id, node.attr) in WALL_CLOCK_CALLS
        ):
            return True
        if isinstance(node, ast.ImportFrom) and any(
            (node.module, name.name) in WALL_CLOCK_CALLS for name in node.names
        ):
            return True
    return False


def test_only_listed_modules_read_the_wall_clock():
    assert wall_clocks("import time\nprint(time.time())")
    assert wall_clocks("from time import time as wall_time")
    paths = {path.relative_to(ROOT).as_posix() for path in ROOT.rglob("*.py") if wall_clocks(path.read_text())}
    assert paths == WALL_CLOCK_USERS
