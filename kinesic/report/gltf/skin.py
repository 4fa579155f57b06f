"""The skin of a figure in a glTF scene: joints, weights, morph targets for the face, and clothes cut by alpha."""

import io
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from kinesic.body.arrays import Floats
from kinesic.body.robot import Robot
from kinesic.face.assets.action_units import gaze_rotation, intensities, shape_weights
from kinesic.face.assets.body import DressedPerson, load_figure
from kinesic.face.assets.chart import chart_window, unroll, vertex_chart
from kinesic.face.assets.mesh import PARTS
from kinesic.face.assets.paint import COMPLEXIONS, EYE, iris, skin
from kinesic.face.assets.rig import PLACE
from kinesic.face.assets.skinning import Skin
from kinesic.files.gltf import GltfFile

Rows = NDArray[np.intp]

PLAIN_COLOURS = {"teeth": (0.68, 0.63, 0.55), "tongue": (0.42, 0.12, 0.11), "lashes": (0.02, 0.014, 0.012)}  # linear
HEM = 0.04  # [m] on each side of a border that the clothes' texture spans
ROUGH = {"skin": 0.55, "eyes": 0.15, "cloth": 0.95}
PAINTED = 512  # pixels along a side of the painted skin
HAIRLINE = (-0.06, 0.12)  # in the chart's unit, where skin becomes hair


@dataclass(frozen=True, eq=False)
class AddedSkin:
    """The moving nodes of a skin that was added to a scene."""

    face: int  # the node with morph targets
    _skin: Skin
    _figure: DressedPerson
    _joints: Mapping[int, tuple[int, int]]  # frame -> its node, and its parent's place in the skeleton
    _eyes: tuple[int, int]  # nodes
    _robot: Robot

    def turns(self, angles: Floats, units: Sequence[Mapping[str, float]]) -> Iterator[tuple[int, Floats]]:
        """Yields nodes with their (m, 3, 3) rotations, for (m, n) [rad] and m faces."""
        stands = np.array([self._skin.stand(row)[0] for row in angles])
        bodies = self._robot.skeleton.frames(angles).rotations
        for frame, (node, parent) in self._joints.items():
            yield node, bodies[:, parent].transpose(0, 2, 1) @ stands[:, frame]
        shown = [intensities(row) for row in units]
        for number, node in enumerate(self._eyes):
            yield node, np.array([gaze_rotation(row, number) for row in shown])

    def weights(self, units: Sequence[Mapping[str, float]]) -> Floats:
        """(m, s) weights of the morph targets."""
        return np.array([shape_weights(self._figure.mesh, row) for row in units])


def add_skin(file: GltfFile, nodes: Sequence[int], robot: Robot) -> AddedSkin:
    """Adds the figure of a robot, moved by its segments' nodes and by some between them.

    Args:
        file: that grows.
        nodes: of the segments, in the skeleton's order.
        robot: whose skin it is.
    """
    figure = load_figure()
    skin_of = Skin(figure, robot.skeleton)
    partial, joints = _joints(file, nodes, robot, skin_of)
    eyes = _eyes(file, nodes, robot, figure, skin_of)
    inverses = np.tile(np.eye(4), (len(joints) + 2, 1, 1))
    inverses[: len(joints), :3, :3] = skin_of.unbound
    inverses[: len(joints), :3, 3] = -np.einsum("fij,fj->fi", skin_of.unbound, skin_of.centres)
    for k, centre in enumerate(figure.mesh.eyes):
        head = skin_of.unbound[PLACE["skullbase"]]
        inverses[len(joints) + k, :3, :3], inverses[len(joints) + k, :3, 3] = head, -head @ centre
    bound = file.numbers(inverses.transpose(0, 2, 1).reshape(-1, 16))
    moved = file.add("skins", name="rig", joints=[*joints, *eyes], inverseBindMatrices=bound)
    surface = _Surface(file, figure)
    face = file.add("meshes", name="face", primitives=surface.face(), weights=[0.0] * len(figure.mesh.shapes))
    file.entry("meshes", face)["extras"] = {"targetNames": list(figure.mesh.shapes)}
    body = file.add("meshes", name="hands and clothes", primitives=surface.body())
    shown = [file.add("nodes", name=name, mesh=mesh, skin=moved) for name, mesh in (("face", face), ("body", body))]
    for node in shown:
        file.show(node)
    return AddedSkin(shown[0], skin_of, figure, partial, eyes, robot)


def _joints(
    file: GltfFile, nodes: Sequence[int], robot: Robot, skin_of: Skin
) -> tuple[dict[int, tuple[int, int]], list[int]]:
    """Frames between segments get nodes of their own: frame -> node and parent; and the nodes of all frames."""
    partial: dict[int, tuple[int, int]] = {}
    found: list[int] = []
    for name, place in PLACE.items():
        frame = skin_of.frames[place]
        segment = robot.skeleton.segment(frame.segment)
        if name == frame.segment:
            found.append(nodes[segment])
            continue
        parent, origin, _ = robot.skeleton.steps[segment]
        node = file.add("nodes", name=name, translation=origin.tolist())
        _hang(file, nodes[parent], node)
        partial[place] = node, parent
        found.append(node)
    return partial, found


def _eyes(file: GltfFile, nodes: Sequence[int], robot: Robot, figure: DressedPerson, skin_of: Skin) -> tuple[int, int]:
    """Nodes of the left and the right eyeball."""
    head = PLACE["skullbase"]
    places = (figure.mesh.eyes - skin_of.centres[head]) @ skin_of.unbound[head].T
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
    """The primitives of a figure."""

    def __init__(self, file: GltfFile, figure: DressedPerson) -> None:
        self._file, self._figure, mesh = file, figure, figure.mesh
        self._chart = vertex_chart(mesh)
        self._normals = mesh.normals(mesh.positions)
        self._points = mesh.positions + self._normals * figure.hair[:, None]
        self._deltas = figure.mesh.deltas.tocsc()
        strongest = np.asarray(figure.weights.argmax(axis=1)).ravel()
        arms = [place for name, place in PLACE.items() if name[:2] in ("l_", "r_") and "clavicular" not in name]
        skinned = mesh.parts == PARTS.index("skin")
        self._hands = skinned & np.isin(strongest, arms) & (mesh.positions[:, 2] < -0.3)
        self._face = ~self._hands & (mesh.parts != PARTS.index("cloth"))

    def face(self) -> list[dict[str, object]]:
        """Head, eyes, teeth, tongue and lashes, with morph targets."""
        mesh, triangles = self._figure.mesh, self._figure.mesh.triangles
        first = triangles[:, 0]
        sources, chart, corners = unroll(self._chart, triangles)
        found = [self._painted(sources, chart, corners[(mesh.parts[first] == 0) & self._face[first]], morphs=True)]
        eyes = triangles[mesh.parts[first] == PARTS.index("eyes")]
        material = self._material("eyes", texture=_encoded(iris(COMPLEXIONS["female"])))
        everyone = np.arange(len(mesh.positions))
        found.append(self._primitive(everyone, eyes, material, self._chart[:, :2] / EYE * 0.5 + 0.5, morphs=True))
        for part, colour in PLAIN_COLOURS.items():
            of_part = triangles[mesh.parts[first] == PARTS.index(part)]
            found.append(self._primitive(everyone, of_part, self._material(part, colour), morphs=True))
        return found

    def body(self) -> list[dict[str, object]]:
        """Hands and clothes."""
        mesh, triangles = self._figure.mesh, self._figure.mesh.triangles
        first = triangles[:, 0]
        everyone = np.arange(len(mesh.positions))
        found = [self._painted(everyone, self._chart, triangles[self._hands[first]], morphs=False)]
        assert mesh.plain is not None  # a figure has it
        cloth = mesh.parts == PARTS.index("cloth")
        for look in np.unique(mesh.plain[cloth], axis=0):
            worn = triangles[(cloth & (mesh.plain == look).all(axis=1))[first]]
            material = self._material("cloth", tuple((look[:3] ** 2).tolist()), texture=_hem(), cut=True)
            across = np.stack([0.5 + mesh.tips / (2 * HEM), np.full(len(mesh.tips), 0.5)], axis=1)
            found.append(self._primitive(everyone, worn, material, np.clip(across, 0.0, 1.0)))
        return found

    def _painted(self, sources: Rows, chart: Floats, corners: Rows, *, morphs: bool) -> dict[str, object]:
        """Skin with its painting; hair is a colour of vertices."""
        complexion = COMPLEXIONS["female"]
        wide, high, left, low = chart_window()
        across = chart[:, :2] * (wide, high) + (left, low)
        t = np.clip((chart[:, 3] - HAIRLINE[0]) / (HAIRLINE[1] - HAIRLINE[0]), 0.0, 1.0)
        hair = np.clip(np.asarray(complexion.hair) / complexion.skin, 0.0, 1.0)
        colours = 1.0 + (t * t * (3 - 2 * t))[:, None] * (hair - 1.0)
        material = self._material("skin", texture=_painting())
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
        """One surface of (t, 3) corners, whose vertices are those of the mesh at sources; across: right and up 0..1."""
        used, placed = np.unique(corners, return_inverse=True)
        own, file = sources[used], self._file
        places, weights = self._influences(own)
        attributes = {
            "POSITION": file.numbers(self._points[own], target="vertices", bounds=True),
            "NORMAL": file.numbers(self._normals[own], target="vertices"),
        }
        for k in range(2):
            part = slice(4 * k, 4 * k + 4)
            attributes[f"JOINTS_{k}"] = file.numbers(places[:, part], "u1", "vertices")
            attributes[f"WEIGHTS_{k}"] = file.shares(weights[:, part])
        if across is not None:
            downward = across[used] * (1.0, -1.0) + (0.0, 1.0)
            attributes["TEXCOORD_0"] = file.numbers(downward, target="vertices")
        if colours is not None:
            attributes["COLOR_0"] = file.numbers(colours[used], target="vertices")
        indices = file.numbers(placed.ravel(), "u4", "indices")
        found: dict[str, object] = {"attributes": attributes, "indices": indices, "material": material}
        if morphs:
            found["targets"] = [{"POSITION": self._morph(own, shape)} for shape in range(self._deltas.shape[1])]
        return found

    def _morph(self, own: Rows, shape: int) -> int:
        """Writes by how much a shape moves each vertex, and returns the index of that."""
        moves = self._deltas[:, [shape]].toarray().reshape(-1, 3)[own]
        places = np.flatnonzero(np.abs(moves).max(axis=1) > 0.0)
        return self._file.sparse(len(own), places, moves[places])

    def _influences(self, own: Rows) -> tuple[NDArray[np.intp], Floats]:
        """(v, 8) joints that move each vertex, and (v, 8) how much; eyeballs follow their own."""
        mesh = self._figure.mesh
        rows = self._figure.weights[own].toarray()
        places = np.argsort(-rows, axis=1)[:, :8]
        weights = np.take_along_axis(rows, places, axis=1)
        balls = np.flatnonzero(mesh.parts[own] == PARTS.index("eyes"))
        places[balls, 0] = len(PLACE) + np.where(mesh.positions[own[balls], 1] > 0.0, 0, 1)
        return np.where(weights > 0.0, places, 0), weights

    def _material(
        self, name: str, colour: tuple[float, ...] = (1.0, 1.0, 1.0), *, texture: bytes | None = None, cut: bool = False
    ) -> int:
        look: dict[str, object] = {
            "baseColorFactor": [*colour, 1.0],
            "metallicFactor": 0.0,
            "roughnessFactor": ROUGH.get(name, 0.6),
        }
        if texture is not None:
            mime = "image/png" if texture.startswith(b"\x89PNG") else "image/jpeg"
            look["baseColorTexture"] = {"index": self._file.picture(texture, mime)}
        mask = {"alphaMode": "MASK", "alphaCutoff": 0.5, "doubleSided": True} if cut else {}
        return self._file.add("materials", name=name, pbrMetallicRoughness=look, **mask)


@cache
def _painting() -> bytes:
    """The painted skin as a JPEG."""
    pixels = np.asarray(skin(COMPLEXIONS["female"]))[:, :, :3]
    side = len(pixels) // PAINTED
    return _encoded(pixels.reshape(PAINTED, side, PAINTED, side, 3).mean(axis=(1, 3)))


def _encoded(linear: Floats) -> bytes:
    """A JPEG of (n, n, 3) linear colours, first row at the bottom."""
    data = io.BytesIO()
    Image.fromarray(np.rint(255 * screen_colours(linear)).astype(np.uint8)[::-1]).save(data, "JPEG", quality=88)
    return data.getvalue()


def screen_colours(linear: Floats) -> Floats:
    """Turns linear colours into what screens show, 0..1."""
    low, high = linear * 12.92, 1.055 * np.maximum(linear, 1e-9) ** (1 / 2.4) - 0.055
    return np.asarray(np.where(linear < 0.0031308, low, high).clip(0.0, 1.0))


@cache
def _hem() -> bytes:
    """A PNG that is cloth on its left, has a seam, and is nothing on its right."""
    where = (np.arange(128) + 0.5) / 128 * 2 * HEM - HEM
    shade = np.where(where > -0.007, 225, 255)
    alpha = np.where(where < 0.0, 255, 0)
    row = np.stack([shade, shade, shade, alpha], axis=1).astype(np.uint8)
    data = io.BytesIO()
    Image.fromarray(np.repeat(row[None], 2, axis=0)).save(data, "PNG")
    return data.getvalue()
