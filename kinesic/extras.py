"""Commands that install optional packages, for error messages."""

import shutil
import sys
import sysconfig
from importlib.machinery import PathFinder
from importlib.metadata import PackageNotFoundError, distribution
from pathlib import Path


def install_extra(extra: str) -> str:
    """Return the shell command that installs an extra of kinesic.

    The installed kinesic satisfies its own name, so pip and uv only add the packages of the extra. This also works for
    versions that are not on PyPI.
    """
    return f'{install_command()} "{_requirement()}[{extra}]"'


def install_command() -> str:
    """Return the command that installs packages for the running interpreter.

    It is `pip install` in an active environment, else pip or uv with the path of the interpreter.
    """
    pip = shutil.which("pip")
    if pip is not None and Path(pip).parent == Path(sysconfig.get_path("scripts")):
        return "pip install"
    if _has_pip():
        return f"{_interpreter()} -m pip install"
    return f"uv pip install --python {_interpreter()}"


def _has_pip() -> bool:
    """Return whether the running interpreter can import pip.

    Only folders are searched, because import hooks of setuptools disable their distutils once pip is searched.
    """
    return PathFinder.find_spec("pip") is not None


def _requirement() -> str:
    """Return the distribution name, or the source folder if not installed."""
    try:
        return distribution("kinesic").name
    except PackageNotFoundError:
        return str(Path(__file__).resolve().parents[1])


def _interpreter() -> str:
    """Return the Python interpreter's path, quoted for a shell.

    It is relative if it lies in the current folder.
    """
    path = Path(sys.executable)
    if path.is_relative_to(Path.cwd()):
        path = path.relative_to(Path.cwd())
    return f'"{path}"' if " " in str(path) else str(path)
