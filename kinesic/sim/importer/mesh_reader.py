"""Reader of an imported robot's mesh files with limits and a cache."""

from collections.abc import Sequence
from pathlib import Path

import mujoco
import numpy as np

from kinesic.body.arrays import sealed
from kinesic.body.config import ConfigError
from kinesic.sim.importer.mesh_file import MESH_SUFFIXES, Triangles, read_mesh, simplify
from kinesic.sim.importer.reading.mesh_folders import list_mesh_folders
from kinesic.sim.importer.reading.model_text import MeshReference

MAX_MESH_FILES = 300  # largest number of mesh files of one robot
MAX_MESH_BYTES = 200_000_000  # [bytes] largest total size of a robot's mesh files
MAX_MESH_TRIANGLES = 3000  # largest number of triangles of a simplified mesh
MAX_MESH_SIZE = 10.0  # [m] extent above which a mesh without scale is taken as millimetres
MILLIMETRE_SCALE = 1e-3  # [m/mm]


class MeshReader:
    """Reader of one robot's meshes, with notes on unreadable ones."""

    def __init__(self, path: Path) -> None:
        """Create a reader for the meshes of a robot file."""
        self.notes: list[str] = []
        self._folder, self._bytes = path.parent.resolve(), 0
        self._cache: dict[tuple[MeshReference, Sequence[float]], Triangles | None] = {}

    def read(self, reference: MeshReference, mesh: mujoco.MjsMesh) -> Triangles | None:
        """Return the scaled triangles of a mesh, or None with a note."""
        key = (reference, (*mesh.scale, *mesh.refpos, *mesh.refquat))
        if key not in self._cache:
            try:
                self._cache[key] = self._read(reference, mesh)
            except (ConfigError, OSError, RuntimeError) as error:  # RuntimeError: symbolic links form a cycle
                self._cache[key] = None
                if str(error) not in self.notes:
                    self.notes.append(str(error))
        return self._cache[key]

    def _read(self, reference: MeshReference, mesh: mujoco.MjsMesh) -> Triangles:
        if not reference.file:
            raise ConfigError(f"mesh {reference.name}: without a file; only {', '.join(MESH_SUFFIXES)} files are drawn")
        if len(self._cache) >= MAX_MESH_FILES:
            raise ConfigError(f"{reference.file}: more than {MAX_MESH_FILES} mesh files")
        path, home = self._find(reference)
        self._bytes += path.stat().st_size
        if self._bytes > MAX_MESH_BYTES:
            raise ConfigError(f"{reference.file}: more than {MAX_MESH_BYTES // 1_000_000} MB of meshes")
        scaled = _scale_mesh(read_mesh(path, folder=home), mesh)
        extent = float(np.ptp(scaled.vertices, axis=0).max())
        if extent > MAX_MESH_SIZE and np.array_equal(mesh.scale, np.ones(3)):
            self.notes.append(f"{reference.file}: {extent:.0f} m large without a scale, so it is taken as millimetres")
            scaled = Triangles(sealed(scaled.vertices * MILLIMETRE_SCALE), scaled.corners)
        return simplify(scaled, MAX_MESH_TRIANGLES)

    def _find(self, reference: MeshReference) -> tuple[Path, Path]:
        """Find the mesh file of a reference, and its folder."""
        spelled = reference.file.replace("\\", "/")
        parts = Path(spelled.rsplit("://", maxsplit=1)[-1]).parts
        folders = list(list_mesh_folders(self._folder, spelled, reference.below))
        for k in range(len(parts)):
            for place in folders:
                candidate = place.start.joinpath(*parts[max(k, place.skipped) :]).resolve()
                if candidate.is_relative_to(place.home.resolve()) and candidate.is_file():
                    return candidate, place.home
        folder = self._folder.name
        raise ConfigError(f"{reference.file}: not in the folder {folder}; copy it there, or the robot's file above it")


def _scale_mesh(triangles: Triangles, mesh: mujoco.MjsMesh) -> Triangles:
    """Apply the scale and reference frame of a mesh to its triangles."""
    scale, turn = np.array(mesh.scale), np.empty(9)
    mujoco.mju_quat2Mat(turn, np.array(mesh.refquat))
    vertices = (triangles.vertices * scale - np.array(mesh.refpos)) @ turn.reshape(3, 3)
    corners = triangles.corners if np.prod(scale) > 0 else triangles.corners[:, ::-1]
    return Triangles(sealed(vertices), corners)
