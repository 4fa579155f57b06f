"""Human figure as a glTF skin: joints, morph targets and clothes."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from kinesic.body.arrays import Floats
from kinesic.body.robot import Robot
from kinesic.face.assets.action_units import compute_gaze_rotation, compute_shape_weights, read_intensities
from kinesic.face.assets.body import DressedPerson, load_figure
from kinesic.face.assets.chart import compute_chart_window, compute_vertex_chart, unroll_mesh
from kinesic.face.assets.mesh import MESH_PARTS
from kinesic.face.assets.paint import COMPLEXIONS, EYE_HALF_WIDTH, paint_iris
from kinesic.face.assets.rig import FRAME_INDICES
from kinesic.face.assets.skinning import Skin
from kinesic.files.gltf import GltfFile
from kinesic.report.gltf.skin_pictures import HEM_HALF_WIDTH, encode_jpeg, hem_texture, shade_locks, skin_painting

Rows = NDArray[np.intp]

# Linear RGB colours of the parts without a texture.
PLAIN_COLOURS = {"teeth": (0.68, 0.63, 0.55), "tongue": (0.42, 0.12, 0.11), "lashes": (0.02, 0.014, 0.012)}
MIN_NORMAL_CHANGE = 0.004  # smaller changes of a unit normal by a blend shape are not stored
PART_ROUGHNESS = {"skin": 0.55, "eyes": 0.15, "cloth": 0.95}  # glTF roughness (0 glossy, 1 matt) of each surface
HAIRLINE_RANGE = (-0.06, 0.12)  # [eye distances] heights over the hairline: last bare skin, first full hair


@dataclass(frozen=True, eq=False)
class AddedSkin:
    """Animated nodes of a human figure in a glTF scene."""

    face: int  # the node with morph targets
    _skin: Skin
    _figure: DressedPerson
    _joints: Mapping[int, tuple[int, int]]  # frame -> its node, and its parent's index in the skeleton
    _eyes: tuple[int, int]  # nodes of the left and right eye
    _robot: Robot

    def turns(self, angles: Floats, units: Sequence[Mapping[str, float]]) -> Iterator[tuple[int, Floats]]:
        """Yield animated skin nodes with their rotations over time, (m, 3, 3)."""
        stands = np.array([self._skin.pose_frames(row)[0] for row in angles])
        bodies = self._robot.skeleton.frames(angles).rotations
        for frame, (node, parent) in self._joints.items():
            yield node, bodies[:, parent].transpose(0, 2, 1) @ stands[:, frame]
        shown = [read_intensities(row) for row in units]
        for number, node in enumerate(self._eyes):
            yield node, np.array([compute_gaze_rotation(row, number) for row in shown])

    def weights(self, units: Sequence[Mapping[str, float]]) -> Floats:
        """Return the morph target weights over time, (m, s)."""
        return np.array([compute_shape_weights(self._figure.mesh, row) for row in units])


def add_skin(file: GltfFile, nodes: Sequence[int], robot: Robot) -> AddedSkin:
    """Add a skinned human figure to a glTF scene.

    Args:
        file: glTF file to extend.
        nodes: nodes of the segments, in the skeleton's order.
        robot: robot with the skin.
    """
    figure = load_figure()
    skin_of = Skin(figure, robot.skeleton)
    partial, joints = _joints(file, nodes, robot, skin_of)
    eyes = _eyes(file, nodes, robot, figure, skin_of)
    inverses = np.tile(np.eye(4), (len(joints) + 2, 1, 1))
    inverses[: len(joints), :3, :3] = skin_of.inverse_bind_rotations
    inverses[: len(joints), :3, 3] = -np.einsum("fij,fj->fi", skin_of.inverse_bind_rotations, skin_of.centres)
    for k, centre in enumerate(figure.mesh.eyes):
        head = skin_of.inverse_bind_rotations[FRAME_INDICES["skullbase"]]
        inverses[len(joints) + k, :3, :3], inverses[len(joints) + k, :3, 3] = head, -head @ centre
    bound = file.numbers(inverses.transpose(0, 2, 1).reshape(-1, 16))
    moved = file.add("skins", name="rig", joints=[*joints, *eyes], inverseBindMatrices=bound)
    surface = _Surface(file, figure)
    face = file.add("meshes", name="face", primitives=surface.face(), weights=[0.0] * len(figure.mesh.shapes))
    file.entry("meshes", face)["extras"] = {"targetNames": list(figure.mesh.shapes)}
    body = file.add("meshes", name="hands and clothes", primitives=surface.body())
    hair = file.add("meshes", name="hair", primitives=[surface.hair()])
    meshes = (("face", face), ("body", body), ("hair", hair))
    shown = [file.add("nodes", name=name, mesh=mesh, skin=moved) for name, mesh in meshes]
    for node in shown:
        file.show(node)
    return AddedSkin(shown[0], skin_of, figure, partial, eyes, robot)


def _joints(
    file: GltfFile, nodes: Sequence[int], robot: Robot, skin_of: Skin
) -> tuple[dict[int, tuple[int, int]], list[int]]:
    """Add nodes for rig frames that are not segments.

    Returns:
        Node and parent segment of each added frame, by frame index; the nodes of all frames.
    """
    partial: dict[int, tuple[int, int]] = {}
    joints: list[int] = []
    for name, place in FRAME_INDICES.items():
        frame = skin_of.frames[place]
        segment = robot.skeleton.segment(frame.segment)
        if name == frame.segment:
            joints.append(nodes[segment])
            continue
        parent, origin, _ = robot.skeleton.steps[segment]
        node = file.add("nodes", name=name, translation=origin.tolist())
        _hang(file, nodes[parent], node)
        partial[place] = node, parent
        joints.append(node)
    return partial, joints


def _eyes(file: GltfFile, nodes: Sequence[int], robot: Robot, figure: DressedPerson, skin_of: Skin) -> tuple[int, int]:
    """Add glTF nodes for both eyeballs, left first."""
    head = FRAME_INDICES["skullbase"]
    places = (figure.mesh.eyes - skin_of.centres[head]) @ skin_of.inverse_bind_rotations[head].T
    left, right = (
        file.add("nodes", name=f"{side}_eyeball", translation=place.tolist())
        for side, place in zip("lr", places, strict=True)
    )
    for node in (left, right):
        _hang(file, nodes[robot.skeleton.segment("skullbase")], node)
    return left, right


def _hang(file: GltfFile, parent: int, node: int) -> None:
    entry = file.entry("nodes", parent)
    children = entry.setdefault("children", [])
    assert isinstance(children, list)  # as `add` was given it
    children.append(node)


class _Surface:
    """Builder of the glTF mesh primitives of a figure."""

    def __init__(self, file: GltfFile, figure: DressedPerson) -> None:
        self._file, self._figure, mesh = file, figure, figure.mesh
        self._chart = compute_vertex_chart(mesh)
        self._normals = mesh.normals(mesh.positions)
        self._points = mesh.positions + self._normals * figure.hair[:, None]
        self._deltas = figure.mesh.deltas.tocsc()
        self._turned: dict[int, Floats] = {}  # shape -> changes of the normals
        strongest = np.asarray(figure.weights.argmax(axis=1)).ravel()
        arms = [place for name, place in FRAME_INDICES.items() if name[:2] in ("l_", "r_") and "clavicular" not in name]
        skinned = mesh.parts == MESH_PARTS.index("skin")
        self._hands = skinned & np.isin(strongest, arms) & (mesh.positions[:, 2] < -0.3)
        self._face = ~self._hands & (mesh.parts != MESH_PARTS.index("cloth"))

    def face(self) -> list[dict[str, object]]:
        """Build the head, eyes, teeth, tongue and lashes, with morph targets."""
        mesh, triangles = self._figure.mesh, self._figure.mesh.triangles
        first = triangles[:, 0]
        skin = mesh.parts[first] == MESH_PARTS.index("skin")
        sources, chart, corners = unroll_mesh(self._chart, triangles, skin)
        primitives = [self._painted(sources, chart, corners[skin & self._face[first]], morphs=True)]
        eyes = triangles[mesh.parts[first] == MESH_PARTS.index("eyes")]
        material = self._material("eyes", texture=encode_jpeg(paint_iris(COMPLEXIONS["female"])))
        everyone = np.arange(len(mesh.positions))
        primitives.append(
            self._primitive(everyone, eyes, material, self._chart[:, :2] / EYE_HALF_WIDTH * 0.5 + 0.5, morphs=True)
        )
        for part, colour in PLAIN_COLOURS.items():
            of_part = triangles[mesh.parts[first] == MESH_PARTS.index(part)]
            primitives.append(self._primitive(everyone, of_part, self._material(part, colour), morphs=True))
        return primitives

    def hair(self) -> dict[str, object]:
        """Build the locks of hair, which follow the head."""
        locks, file = self._figure.locks, self._file
        count = len(locks.positions)
        joints, weights = np.zeros((2, count, 4))
        colours = shade_locks(locks)
        brightest = colours.max(axis=0)  # a viewer that ignores colours of vertices shows this
        joints[:, 0], weights[:, 0] = list(FRAME_INDICES).index("skullbase"), 1.0
        return {
            "attributes": {
                "POSITION": file.numbers(locks.positions, target="vertices", bounds=True),
                "NORMAL": file.numbers(locks.normals, target="vertices"),
                "COLOR_0": file.numbers(colours / brightest, target="vertices"),
                "JOINTS_0": file.numbers(joints, "u1", "vertices"),
                "WEIGHTS_0": file.weights(weights),
            },
            "indices": file.numbers(locks.triangles.ravel(), "u4", "indices"),
            "material": self._material("hair", tuple(brightest.tolist()), double_sided=True),
        }

    def body(self) -> list[dict[str, object]]:
        """Build the glTF primitives of hands and clothes."""
        mesh, triangles = self._figure.mesh, self._figure.mesh.triangles
        first = triangles[:, 0]
        everyone = np.arange(len(mesh.positions))
        primitives = [self._painted(everyone, self._chart, triangles[self._hands[first]], morphs=False)]
        assert mesh.plain is not None  # a figure has it
        cloth = mesh.parts == MESH_PARTS.index("cloth")
        for look in np.unique(mesh.plain[cloth], axis=0):
            worn = triangles[(cloth & (mesh.plain == look).all(axis=1))[first]]
            material = self._material("cloth", tuple((look[:3] ** 2).tolist()), texture=hem_texture(), cut=True)
            across = np.stack([0.5 + mesh.tips / (2 * HEM_HALF_WIDTH), np.full(len(mesh.tips), 0.5)], axis=1)
            primitives.append(self._primitive(everyone, worn, material, np.clip(across, 0.0, 1.0)))
        return primitives

    def _painted(self, sources: Rows, chart: Floats, corners: Rows, *, morphs: bool) -> dict[str, object]:
        """Build the painted skin as glTF primitive, with hair as vertex colour."""
        complexion = COMPLEXIONS["female"]
        wide, high, left, low = compute_chart_window()
        across = chart[:, :2] * (wide, high) + (left, low)
        t = np.clip((chart[:, 3] - HAIRLINE_RANGE[0]) / (HAIRLINE_RANGE[1] - HAIRLINE_RANGE[0]), 0.0, 1.0)
        hair = np.clip(np.asarray(complexion.hair) / complexion.skin, 0.0, 1.0)
        colours = 1.0 + (t * t * (3 - 2 * t))[:, None] * (hair - 1.0)
        material = self._material("skin", texture=skin_painting())
        return self._primitive(sources, corners, material, np.clip(across, 0.0, 1.0), colours, morphs=morphs)

    def _primitive(
        self,
        sources: Rows,
        corners: Rows,
        material: int,
        across: Floats | None = None,
        colours: Floats | None = None,
        *,
        morphs: bool = False,
    ) -> dict[str, object]:
        """Build one glTF primitive from triangle corners (t, 3).

        Its vertices are those of the mesh at `sources`. `across` are texture coordinates to the right and up, 0..1.
        """
        used, placed = np.unique(corners, return_inverse=True)
        vertex_rows, file = sources[used], self._file
        places, weights = self._influences(vertex_rows)
        attributes = {
            "POSITION": file.numbers(self._points[vertex_rows], target="vertices", bounds=True),
            "NORMAL": file.numbers(self._normals[vertex_rows], target="vertices"),
        }
        for k in range(2):
            part = slice(4 * k, 4 * k + 4)
            attributes[f"JOINTS_{k}"] = file.numbers(places[:, part], "u1", "vertices")
            attributes[f"WEIGHTS_{k}"] = file.weights(weights[:, part])
        if across is not None:
            downward = across[used] * (1.0, -1.0) + (0.0, 1.0)
            attributes["TEXCOORD_0"] = file.numbers(downward, target="vertices")
        if colours is not None:
            attributes["COLOR_0"] = file.numbers(colours[used], target="vertices")
        indices = file.numbers(placed.ravel(), "u4", "indices")
        primitive: dict[str, object] = {"attributes": attributes, "indices": indices, "material": material}
        if morphs:
            primitive["targets"] = [self._morph(vertex_rows, shape) for shape in range(self._deltas.shape[1])]
        return primitive

    def _morph(self, vertex_rows: Rows, shape: int) -> dict[str, int]:
        """Write a blend shape's position and normal changes, and return accessor indices."""
        moves = self._deltas[:, [shape]].toarray().reshape(-1, 3)
        turned = self._turn_normals(shape)
        return {
            name: self._file.sparse(len(vertex_rows), places, rows[vertex_rows][places])
            for name, rows, least in (("POSITION", moves, 0.0), ("NORMAL", turned, MIN_NORMAL_CHANGE))
            for places in [np.flatnonzero(np.abs(rows[vertex_rows]).max(axis=1) > least)]
        }

    def _turn_normals(self, shape: int) -> Floats:
        """Return a blend shape's normal changes (v, 3), zero at the eyeballs."""
        if shape not in self._turned:
            mesh = self._figure.mesh
            moves = self._deltas[:, [shape]].toarray().reshape(-1, 3)
            change = mesh.normals(mesh.positions + moves) - self._normals
            change[mesh.parts == MESH_PARTS.index("eyes")] = 0.0
            self._turned[shape] = change
        return self._turned[shape]

    def _influences(self, vertex_rows: Rows) -> tuple[NDArray[np.intp], Floats]:
        """Return eight joints and their weights per vertex, (v, 8) each."""
        mesh = self._figure.mesh
        rows = self._figure.weights[vertex_rows].toarray()
        places = np.argsort(-rows, axis=1)[:, :8]
        weights = np.take_along_axis(rows, places, axis=1)
        balls = np.flatnonzero(mesh.parts[vertex_rows] == MESH_PARTS.index("eyes"))
        places[balls, 0] = len(FRAME_INDICES) + np.where(mesh.positions[vertex_rows[balls], 1] > 0.0, 0, 1)
        return np.where(weights > 0.0, places, 0), weights

    def _material(
        self,
        name: str,
        colour: tuple[float, ...] = (1.0, 1.0, 1.0),
        *,
        texture: bytes | None = None,
        cut: bool = False,
        double_sided: bool = False,
    ) -> int:
        look: dict[str, object] = {
            "baseColorFactor": [*colour, 1.0],
            "metallicFactor": 0.0,
            "roughnessFactor": PART_ROUGHNESS.get(name, 0.6),
        }
        if texture is not None:
            mime = "image/png" if texture.startswith(b"\x89PNG") else "image/jpeg"
            look["baseColorTexture"] = {"index": self._file.picture(texture, mime)}
        mask: dict[str, object] = {"alphaMode": "MASK", "alphaCutoff": 0.5} if cut else {}
        mask |= {"doubleSided": True} if cut or double_sided else {}
        return self._file.add("materials", name=name, pbrMetallicRoughness=look, **mask)
