"""Reader of the triangles of a COLLADA scene (.dae).

Lengths are converted to metres. The up axis is ignored, as ROS tools ignore it.
"""

from collections.abc import Iterator, Mapping
from typing import NoReturn
from xml.etree.ElementTree import Element, TreeBuilder
from xml.parsers import expat

import numpy as np

from kinesic.body.arrays import Floats, Indices

MAX_NODES = 2000  # largest number of drawn nodes, with the nodes that others repeat
MAX_NODE_DEPTH = 50  # deepest nesting of nodes
FACE_TAGS = ("triangles", "polylist", "polygons")  # elements of a mesh with faces


def parse_collada(data: bytes) -> tuple[Floats, Indices]:
    """Parse a COLLADA document.

    Returns:
        Vertices (v, 3) [m] and corners (t, 3) of all geometries of the scene, each placed by its nodes.

    Raises:
        ValueError: the document is not well-formed, has entities, or its faces are inconsistent.
    """
    root = _parse_xml(data)
    unit = root.find("asset/unit")
    metre = 1.0 if unit is None else float(unit.get("meter", "1"))
    geometries = {element.get("id", ""): element for element in root.findall("library_geometries/geometry")}
    scene = _Scene(root, geometries)
    vertices, corners, count = [np.zeros((0, 3))], [np.zeros((0, 3), dtype=np.intp)], 0
    for geometry, frame in scene.drawn():
        for points, triangles in _meshes(geometry):
            vertices.append(metre * (points @ frame[:3, :3].T + frame[:3, 3]))
            corners.append(triangles + count)
            count += len(points)
    return np.concatenate(vertices), np.concatenate(corners)


def _parse_xml(data: bytes) -> Element:
    """Parse XML without entities and without namespaces."""
    builder, parser = TreeBuilder(), expat.ParserCreate()

    def refuse(*_declared: object) -> NoReturn:
        raise ValueError("document types and entities are refused")

    parser.StartDoctypeDeclHandler = refuse
    parser.StartElementHandler = lambda tag, attributes: builder.start(tag.rpartition(":")[2], attributes)
    parser.EndElementHandler = lambda tag: builder.end(tag.rpartition(":")[2])
    parser.CharacterDataHandler = builder.data
    try:
        parser.Parse(data, True)
    except expat.ExpatError as error:
        raise ValueError(str(error)) from None
    return builder.close()


class _Scene:
    """Nodes of a document with the geometries that they place."""

    def __init__(self, root: Element, geometries: Mapping[str, Element]) -> None:
        self._root, self._geometries, self._count = root, geometries, 0
        self._nodes = {node.get("id", ""): node for node in root.iter("node")}

    def drawn(self) -> Iterator[tuple[Element, Floats]]:
        """Yield each geometry of the scene with its frame (4, 4).

        A document without a scene draws all its geometries.
        """
        scenes = self._root.findall("library_visual_scenes/visual_scene")
        if not scenes:
            yield from ((geometry, np.eye(4)) for geometry in self._geometries.values())
        for scene in scenes[:1]:
            for node in scene.findall("node"):
                yield from self._walk(node, np.eye(4), 0)

    def _walk(self, node: Element, frame: Floats, depth: int) -> Iterator[tuple[Element, Floats]]:
        self._count += 1
        if self._count > MAX_NODES or depth > MAX_NODE_DEPTH:
            raise ValueError(f"more than {MAX_NODES} nodes, or nodes more than {MAX_NODE_DEPTH} deep")
        frame = frame @ _read_frame(node)
        for child in node:
            target = child.get("url", "").removeprefix("#")
            if child.tag == "instance_geometry" and target in self._geometries:
                yield self._geometries[target], frame
            elif child.tag == "instance_node" and target in self._nodes:
                yield from self._walk(self._nodes[target], frame, depth + 1)
            elif child.tag == "node":
                yield from self._walk(child, frame, depth + 1)


def _read_frame(node: Element) -> Floats:
    """Return the frame (4, 4) of a node in its parent."""
    frame = np.eye(4)
    for child in node:
        step = np.eye(4)
        if child.tag == "matrix":
            step = _numbers(child).reshape(4, 4)
        elif child.tag == "translate":
            step[:3, 3] = _numbers(child)
        elif child.tag == "scale":
            step[:3, :3] = np.diag(_numbers(child))
        elif child.tag == "rotate":
            step[:3, :3] = _rotation(_numbers(child))
        frame = frame @ step
    return frame


def _rotation(axis_and_angle: Floats) -> Floats:
    """Convert an axis and an angle [deg] to a rotation matrix."""
    x, y, z = axis_and_angle[:3] / np.linalg.norm(axis_and_angle[:3])
    angle = np.radians(axis_and_angle[3])
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.asarray(np.eye(3) + np.sin(angle) * cross + (1.0 - np.cos(angle)) * cross @ cross)


def _meshes(geometry: Element) -> Iterator[tuple[Floats, Indices]]:
    """Yield vertices and triangles of each face element of a geometry."""
    for mesh in geometry.findall("mesh"):
        arrays = {
            source.get("id", ""): values
            for source in mesh.findall("source")
            if (values := source.find("float_array")) is not None
        }
        positions = {
            vertices.get("id", ""): vertices_input.get("source", "").removeprefix("#")
            for vertices in mesh.findall("vertices")
            for vertices_input in vertices.findall("input")
            if vertices_input.get("semantic") == "POSITION"
        }
        for faces in (child for child in mesh if child.tag in FACE_TAGS):
            inputs = faces.findall("input")
            found = [entry for entry in inputs if entry.get("semantic") == "VERTEX"]
            if not found:
                raise ValueError(f"<{faces.tag}> has no vertices")
            name = positions.get(found[0].get("source", "").removeprefix("#"), "")
            if name not in arrays:
                raise ValueError(f"<{faces.tag}> refers to vertices that are not there")
            points = _numbers(arrays[name]).reshape(-1, 3)
            stride = 1 + max(int(entry.get("offset", "0")) for entry in inputs)
            yield points, _read_triangles(faces, int(found[0].get("offset", "0")), stride, len(points))


def _read_triangles(faces: Element, offset: int, stride: int, count: int) -> Indices:
    """Return the corners (t, 3) of faces, split into fans of triangles."""
    rings = [_numbers(element).astype(np.intp)[offset::stride] for element in faces.findall("p")]
    if faces.tag == "polygons":
        sizes = np.array([len(ring) for ring in rings], dtype=np.intp)
    else:
        sizes = np.full(sum(map(len, rings)) // 3, 3, dtype=np.intp)
    listed = faces.find("vcount")
    if faces.tag == "polylist" and listed is not None:
        sizes = _numbers(listed).astype(np.intp)
    corners = np.concatenate([np.zeros(0, dtype=np.intp), *rings])
    if sizes.sum() != len(corners) or (len(corners) and not 0 <= corners.min() <= corners.max() < count):
        raise ValueError(f"<{faces.tag}> has an invalid number of corners or vertex index")
    fans = np.maximum(sizes - 2, 0)  # number of triangles of each face
    starts = np.repeat(np.cumsum(sizes) - sizes, fans)
    place = np.arange(len(starts)) - np.repeat(np.cumsum(fans) - fans, fans)
    return np.stack([corners[starts], corners[starts + place + 1], corners[starts + place + 2]], axis=1)


def _numbers(element: Element) -> Floats:
    return np.array((element.text or "").split(), dtype=float)
