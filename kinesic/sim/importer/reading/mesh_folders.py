"""Folders in which the meshes of a robot file are searched.

ROS packages keep them beside the folder of the robot file, and refer to them by `package://NAME/meshes/...`.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

PACKAGE_FILE = "package.xml"  # file in the root folder of a ROS package
MAX_PACKAGE_DEPTH = 4  # folders between a robot file and the root of its package, at most
MESH_FOLDERS = ("meshes", "mesh", "assets", "stl", "obj", "dae", "visual", "collision")  # names of sibling folders
PACKAGE_SCHEMES = ("package://", "model://")  # prefixes of references that begin with a package's name


@dataclass(frozen=True)
class MeshFolder:
    """Folder in which a mesh may be."""

    start: Path  # folder to which a reference is relative
    home: Path  # folder that the mesh must not leave
    skipped: int = 0  # folder names of the reference that are not below `start`


def list_mesh_folders(folder: Path, reference: str, below: str) -> Iterator[MeshFolder]:
    """Yield the possible folders of a robot's mesh, best first.

    These are the folder of the robot file, the ROS package that contains it, the package that the reference names if it
    is a neighbour of that package, and sibling folders for meshes.

    Args:
        folder: Resolved folder of the robot file.
        reference: File of the mesh, as the robot file spells it.
        below: Mesh folder of the <compiler> element.
    """
    yield MeshFolder(folder / below, folder)
    yield MeshFolder(folder, folder)
    package = find_ros_package(folder)
    if package is not None:
        yield MeshFolder(package, package)
        name = _named_package(reference)
        if name and is_package(package.parent / name):
            yield MeshFolder(package.parent / name, package.parent / name, skipped=1)
    for name in MESH_FOLDERS:
        if (folder.parent / name).is_dir():
            yield MeshFolder(folder.parent, folder.parent / name)


def find_ros_package(folder: Path) -> Path | None:
    """Return the root of a folder's ROS package, or None."""
    for parent in (folder, *folder.parents[:MAX_PACKAGE_DEPTH]):
        if is_package(parent):
            return parent
    return None


def is_package(folder: Path) -> bool:
    """Return whether a folder is the root of a ROS package."""
    return (folder / PACKAGE_FILE).is_file()


def _named_package(reference: str) -> str:
    """Return the package that a mesh reference names, empty without one."""
    for scheme in PACKAGE_SCHEMES:
        if reference.startswith(scheme):
            name = reference.removeprefix(scheme).split("/")[0]
            return "" if name in ("", ".", "..") or "\\" in name else name
    return ""
