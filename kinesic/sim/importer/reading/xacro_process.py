"""Process that expands a xacro file.

    python -P -m kinesic.sim.importer.reading.xacro_process FILE HOME

xacro evaluates expressions of the file as Python. An audit hook therefore refuses everything except reading files below
HOME: other files, programs, connections and modules that are not loaded yet. Standard output gets the URDF.
"""

import os
import sys
from errno import EACCES
from pathlib import Path
from types import TracebackType

from kinesic.sim.importer.reading.mesh_folders import is_package

XACRO_PACKAGE_DEPTH = 3  # folders between HOME and a package that `$(find NAME)` names, at most
HARMLESS_EVENTS = frozenset(  # audit events of xacro and of the XML parser that neither write nor connect
    {
        "builtins.id",
        "compile",
        "exec",
        "code.__new__",
        "glob.glob",
        "glob.glob/2",
        "marshal.loads",
        "object.__getattr__",
        "sys._getframe",
        "sys.excepthook",
        "sys.unraisablehook",
    }
)


def guard_process(home: Path) -> None:
    """Refuse everything except reading files below a folder, until the process ends."""

    def audit(event: str, arguments: tuple[object, ...]) -> None:
        if event in HARMLESS_EVENTS:
            return
        if event in ("os.listdir", "os.scandir") and _is_below(home, arguments[0]):
            return
        if event == "open" and _is_below(home, arguments[0]) and _is_for_reading(arguments[1:]):
            return
        raise PermissionError(EACCES, f"macros may only read files in {home.name}", event)

    sys.addaudithook(audit)


def _is_below(home: Path, path: object) -> bool:
    return isinstance(path, str | bytes) and os.path.realpath(os.fsdecode(path)).startswith(f"{home}{os.sep}")


def _is_for_reading(arguments: tuple[object, ...]) -> bool:
    """Return whether `open` is called for reading, by its mode and flags."""
    mode, flags = arguments
    is_writing = isinstance(flags, int) and bool(flags & (os.O_WRONLY | os.O_RDWR | os.O_CREAT))
    return not is_writing and (mode is None or (isinstance(mode, str) and not set(mode) & set("wax+")))


def list_packages(home: Path) -> dict[str, str]:
    """Return the folders of ROS packages below a folder, by name."""
    folders = [home]
    for depth in range(1, XACRO_PACKAGE_DEPTH + 1):
        folders += [path for path in sorted(home.glob("/".join("*" * depth))) if path.is_dir()]
    return {folder.name: str(folder) for folder in reversed(folders) if is_package(folder)}


def expand_xacro(file: Path, home: Path) -> str:
    """Return the URDF of a xacro file.

    Exceptions of any type are raised if xacro refuses the file.
    """
    import xacro  # noqa: PLC0415 - optional
    from xacro import substitution_args  # noqa: PLC0415 - optional

    xacro.process_doc(xacro.parse("<robot/>"))  # loads all modules before the guard refuses files of modules
    packages = list_packages(home)

    def find_package(name: str) -> str:
        if name not in packages:
            raise ValueError(f"$(find {name}): no package {name} in {home.name}; its folder has a package.xml")
        return packages[name]

    substitution_args._eval_find = find_package
    os.environ.clear()  # `$(env NAME)` must not copy secrets into the robot
    guard_process(home)
    return str(xacro.process_file(str(file)).toxml())


def main(file: str, home: str) -> None:
    """Write the expanded file to standard output.

    Standard error gets the reason for a refusal.
    """
    sys.excepthook = _print_reason
    with os.fdopen(os.dup(1), "wb") as stream:
        os.dup2(2, 1)  # messages of xacro must not mix with the URDF
        stream.write(expand_xacro(Path(file), Path(home)).encode())


def _print_reason(kind: type[BaseException], error: BaseException, _trace: TracebackType | None) -> None:
    """Print an exception as the last line of standard error."""
    sys.stderr.write(f"\n{kind.__name__}: {' '.join(str(error).split())}")


if __name__ == "__main__":
    main(*sys.argv[1:])
