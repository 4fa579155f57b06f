import json
import struct
from pathlib import Path

import numpy as np
import pytest

from kinesic.files.gltf import COMPONENT_CODES, GltfFile


def read(path: Path) -> tuple[dict, bytes]:
    data = path.read_bytes()
    magic, version, size = struct.unpack("<4sII", data[:12])
    assert (magic, version, size) == (b"glTF", 2, len(data))
    length, kind = struct.unpack("<I4s", data[12:20])
    assert kind == b"JSON"
    assert length % 4 == 0
    text, rest = data[20 : 20 + length], data[20 + length :]
    assert struct.unpack("<I4s", rest[:8]) == (len(rest) - 8, b"BIN\0")
    return json.loads(text), rest[8:]


@pytest.fixture
def file() -> GltfFile:
    return GltfFile("test")


def test_written_gltf_numbers_are_read_back(file: GltfFile, tmp_path: Path):
    odd = np.array([1, 2, 3])
    values = np.array([[1.5, -2.0, 3.0], [0.0, 4.0, -1.0]])
    file.numbers(odd, "u1")
    assert file.numbers(values, target="vertices", bounds=True) == 1
    file.write(tmp_path / "x.glb")
    tables, block = read(tmp_path / "x.glb")
    accessor = tables["accessors"][1]
    assert accessor["min"] == [0.0, -2.0, -1.0]
    assert accessor["max"] == [1.5, 4.0, 3.0]
    assert (accessor["type"], accessor["count"], accessor["componentType"]) == ("VEC3", 2, 5126)
    view = tables["bufferViews"][accessor["bufferView"]]
    assert view["target"] == 34962
    assert view["byteOffset"] == 4, "numbers begin at multiples of four"
    result = np.frombuffer(block, "<f4", count=6, offset=view["byteOffset"])
    np.testing.assert_array_equal(result.reshape(2, 3), values)


def test_sparse_gltf_accessor_has_count_and_bounds(file: GltfFile, tmp_path: Path):
    file.sparse(5, np.array([1, 3]), np.array([[1.0, 2.0, 3.0], [2.0, -1.0, 4.0]]))
    file.sparse(1, np.array([0]), np.array([[1.0, 2.0, 3.0]]))
    file.sparse(7, np.array([], dtype=int), np.zeros((0, 3)))
    file.write(tmp_path / "x.glb")
    some, every, none = read(tmp_path / "x.glb")[0]["accessors"]
    assert some["sparse"]["count"] == 2
    assert (some["min"], some["max"]) == ([0.0, -1.0, 0.0], [2.0, 2.0, 4.0])
    assert every["min"] == every["max"] == [1.0, 2.0, 3.0]
    assert "sparse" not in none
    assert none["count"] == 7


def test_vertex_weights_use_a_normalized_gltf_accessor(file: GltfFile):
    file.numbers(np.zeros(3), "f4")
    index = file.weights(np.array([[0.2, 0.8, 0.0, 0.0]]))
    assert index == 1
    assert file.entry("accessors", index)["normalized"]


def test_gltf_node_is_added_to_the_scene_with_its_children(file: GltfFile, tmp_path: Path):
    node = file.add("nodes", name="a", mesh=None)
    file.entry("nodes", node)["children"] = [file.add("nodes", name="b")]
    file.show(node)
    file.write(tmp_path / "x.glb")
    tables, _ = read(tmp_path / "x.glb")
    assert tables["nodes"] == [{"name": "a", "children": [1]}, {"name": "b"}]
    assert tables["scenes"][tables["scene"]]["nodes"] == [0]


def test_gltf_component_types_have_the_codes_of_the_standard():
    assert COMPONENT_CODES == {"u1": 5121, "u2": 5123, "u4": 5125, "f4": 5126}
