"""Run command lines of kinesic one after the other, and print their exit codes and messages as JSON.

PYTHONPATH=tests/windows_host python tests/windows_host/run_verbs.py '[["plan", "welcome"], ["serve"]]'
"""

import io
import json
import sys
from contextlib import redirect_stderr, redirect_stdout
from importlib import import_module
from pkgutil import walk_packages

from kinesic.cli import main


def run(arguments: list[str]) -> tuple[int, str, str]:
    """Run one command line in this process."""
    out, err = io.StringIO(), io.StringIO()
    sys.argv = ["kinesic", *arguments]
    code: object = 0
    with redirect_stdout(out), redirect_stderr(err):
        try:
            main()
        except SystemExit as end:
            code = end.code
    return int(str(code or 0)), out.getvalue(), err.getvalue()


def import_all(package: str) -> list[str]:
    """Import every module of a package and return the names."""
    names = [module.name for module in walk_packages(import_module(package).__path__, f"{package}.")]
    for name in names:
        if not name.endswith("__main__"):
            import_module(name)
    return names


if __name__ == "__main__":
    command_lines = json.loads(sys.argv[1])
    answer = {"modules": import_all("kinesic.cli"), "ended": [run(arguments) for arguments in command_lines]}
    sys.stdout.write(json.dumps(answer))
