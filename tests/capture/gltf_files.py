"""Small glTF files with a moving person for tests."""

import base64
import json
import struct

import numpy as np
from scipy.spatial.transform import Rotation

from .clips import LENGTHS, SIDES

BONES = {"Arm": "upper", "ForeArm": "fore", "Hand": "hand"}
COMPONENTS = {"<f4": 5126, "<i2": 5122}


def person() -> list[dict]:
    """Return nodes of a person with arms to the sides (y up, z ahead), in an armature of another unit."""
    nodes = [
        {"name": "Armature", "scale": [0.01, 0.01, 0.01], "children": [1]},
        {"name": "Hips", "translation": [0, 90, 0], "children": [2]},
        {"name": "Spine", "translation": [0, 40, 0], "children": [3]},
        {"name": "Neck", "translation": [0, 10, 0], "children": [4]},
        {"name": "Head", "translation": [0, 10, 0]},
    ]
    for side, sign in SIDES.items():
        nodes[2]["children"].append(len(nodes))
        nodes.append({"name": f"{side}Shoulder", "translation": [sign * LENGTHS["clavicle"], 3, 1]})
        for bone, length in BONES.items():
            nodes[-1]["children"] = [len(nodes)]
            nodes.append({"name": f"{side}{bone}", "translation": [sign * LENGTHS[length], 0, 0]})
    return nodes


def quaternions(rotations) -> np.ndarray:
    """Return quaternions (m, 4) of BVH angles (m, 3) [deg] about z, x and y."""
    return Rotation.from_euler("ZXY", rotations, degrees=True).as_quat()


class GltfFile:
    """Parts of a glTF file."""

    def __init__(self, nodes=None) -> None:
        self.data = b""
        self.json = {
            "asset": {"version": "2.0"},
            "nodes": nodes or person(),
            "bufferViews": [],
            "accessors": [],
            "animations": [{"name": "wave", "channels": [], "samplers": []}],
        }

    def add_array(self, values, dtype="<f4") -> int:
        """Add an array to the file, and return the array's index."""
        values = np.asarray(values)
        scaled = values if dtype == "<f4" else np.round(values * np.iinfo(dtype).max)
        data = scaled.astype(dtype).tobytes()
        data += b"\0" * (-len(data) % 4)
        self.json["bufferViews"].append({"buffer": 0, "byteOffset": len(self.data), "byteLength": len(data)})
        kind = {0: "SCALAR", 3: "VEC3", 4: "VEC4"}[0 if values.ndim == 1 else values.shape[1]]
        view = len(self.json["bufferViews"]) - 1
        self.json["accessors"].append(
            {"bufferView": view, "componentType": COMPONENTS[dtype], "count": len(values), "type": kind}
        )
        self.data += data
        return view

    def animate(self, name, times, values, *, path="rotation", interpolation="LINEAR", dtype="<f4") -> "GltfFile":
        """Add key frames of a node's property."""
        animation = self.json["animations"][0]
        node = next(k for k, node in enumerate(self.json["nodes"]) if node["name"] == name)
        sampler = {"input": self.add_array(times), "output": self.add_array(values, dtype)}
        animation["samplers"].append({**sampler, "interpolation": interpolation})
        target = {"node": node, "path": path}
        animation["channels"].append({"sampler": len(animation["samplers"]) - 1, "target": target})
        return self

    def text(self, uri=None) -> bytes:
        """Return a .gltf file's text, with the buffer embedded or by URI."""
        uri = uri or "data:application/octet-stream;base64," + base64.b64encode(self.data).decode()
        return json.dumps({**self.json, "buffers": [{"byteLength": len(self.data), "uri": uri}]}).encode()

    def binary(self) -> bytes:
        """Return the bytes of a .glb file."""
        text = json.dumps({**self.json, "buffers": [{"byteLength": len(self.data)}]}).encode()
        text += b" " * (-len(text) % 4)
        chunks = struct.pack("<II", len(text), 0x4E4F534A) + text
        chunks += struct.pack("<II", len(self.data), 0x004E4942) + self.data
        return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks


def moving_person(rotations, *, period=1 / 30, nodes=None, **options) -> GltfFile:
    """Return a person that moves as `clips.bvh` with the same rotations."""
    file = GltfFile(nodes)
    for name, angles in rotations.items():
        file.animate(name, period * np.arange(len(angles)), quaternions(angles), **options)
    return file
