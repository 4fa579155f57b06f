"""Triangles of COLLADA documents: faces, placement by nodes, units and refused contents."""

import numpy as np
import pytest

from kinesic.sim.importer import collada
from kinesic.sim.importer.collada import parse_collada

SQUARE = "0 0 0 1 0 0 1 1 0 0 1 0"  # [units] corners of the plate
WHOLE_SCENE = '<node><instance_geometry url="#plate"/></node>'
SQUARE_AS_TRIANGLES = '<triangles><input semantic="VERTEX" source="#v" offset="0"/><p>0 1 2 0 2 3</p></triangles>'


def document(faces: str = SQUARE_AS_TRIANGLES, scene: str = WHOLE_SCENE, *, unit: str = "", head: str = "") -> bytes:
    """Return a document with a square plate."""
    scenes = f"<library_visual_scenes><visual_scene>{scene}</visual_scene></library_visual_scenes>" if scene else ""
    return f"""{head}<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema"><asset>{unit}</asset>
        <library_geometries><geometry id="plate"><mesh>
          <source id="p"><float_array count="12">{SQUARE}</float_array></source>
          <source id="n"><float_array count="3">0 0 1</float_array></source>
          <vertices id="v"><input semantic="POSITION" source="#p"/></vertices>{faces}
        </mesh></geometry></library_geometries>{scenes}</COLLADA>""".encode()


def triangles(data: bytes) -> np.ndarray:
    vertices, corners = parse_collada(data)
    return vertices[corners]


PLATE = np.array([[[0, 0, 0], [1, 0, 0], [1, 1, 0]], [[0, 0, 0], [1, 1, 0], [0, 1, 0]]], dtype=float)
INPUTS = '<input semantic="NORMAL" source="#n" offset="1"/><input semantic="VERTEX" source="#v" offset="0"/>'


@pytest.mark.parametrize(
    "faces",
    [
        SQUARE_AS_TRIANGLES,
        f"<triangles>{INPUTS}<p>0 0 1 0 2 0 0 0 2 0 3 0</p></triangles>",
        f"<polylist>{INPUTS}<vcount>4</vcount><p>0 0 1 0 2 0 3 0</p></polylist>",
        f"<polygons>{INPUTS}<p>0 0 1 0 2 0 3 0</p></polygons>",
        f"<polylist>{INPUTS}<vcount>3 2 3</vcount><p>0 0 1 0 2 0 0 0 1 0 0 0 2 0 3 0</p></polylist>",
    ],
)
def test_faces_of_all_kinds_become_the_same_triangles(faces: str):
    np.testing.assert_array_equal(triangles(document(faces)), PLATE)


def test_document_without_scene_draws_its_geometries_in_place():
    np.testing.assert_array_equal(triangles(document(scene="")), PLATE)


def test_vertices_are_converted_from_the_unit_of_the_document_to_metres():
    np.testing.assert_allclose(triangles(document(unit='<unit meter="0.001"/>')), PLATE / 1000)


@pytest.mark.parametrize(
    ("place", "first"),
    [
        ("<translate>1 2 3</translate>", [2.0, 2.0, 3.0]),
        ("<scale>2 3 4</scale>", [2.0, 0.0, 0.0]),
        ("<rotate>0 0 2 90</rotate>", [0.0, 1.0, 0.0]),
        ("<matrix>0 -1 0 5 1 0 0 6 0 0 1 7 0 0 0 1</matrix>", [5.0, 7.0, 7.0]),
        ("<translate>1 2 3</translate><rotate>0 0 1 90</rotate>", [1.0, 3.0, 3.0]),
    ],
)
def test_node_places_the_corner_at_1_0_0(place: str, first: list[float]):
    moved = triangles(document(scene=f"<node>{place}<node><instance_geometry url='#plate'/></node></node>"))
    np.testing.assert_allclose(moved[0, 1], first, atol=1e-12)


def test_geometry_of_a_repeated_node_is_drawn_twice():
    scene = '<node id="a"><instance_geometry url="#plate"/></node><node><instance_node url="#a"/></node>'
    assert len(triangles(document(scene=scene))) == 4


@pytest.mark.parametrize(
    ("data", "why"),
    [
        (document(head='<!DOCTYPE a [<!ENTITY b "c">]>'), "entities are refused"),
        (document()[:-3], "unclosed token|no element"),
        (document(SQUARE_AS_TRIANGLES.replace("3<", "4<")), "invalid number of corners or vertex index"),
        (document(SQUARE_AS_TRIANGLES.replace("0 1 2 0 2 3", "0 1")), "invalid number of corners or vertex index"),
        (document(SQUARE_AS_TRIANGLES.replace("#v", "#w")), "refers to vertices that are not there"),
        (document("<triangles><p>0 1 2</p></triangles>"), "has no vertices"),
        (document(scene='<node id="a"><instance_node url="#a"/></node>'), "nodes more than 50 deep"),
    ],
)
def test_inconsistent_document_is_rejected_with_the_reason(data: bytes, why: str):
    with pytest.raises(ValueError, match=why):
        parse_collada(data)


def test_number_of_drawn_nodes_is_limited(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(collada, "MAX_NODES", 2)
    assert len(triangles(document(scene=2 * WHOLE_SCENE))) == 4
    with pytest.raises(ValueError, match="more than 2 nodes"):
        parse_collada(document(scene=3 * WHOLE_SCENE))
