"""Writes a binary glTF 2.0 file (.glb): numbers in one block, and JSON that says what they are."""

import json
import struct
from pathlib import Path
from typing import Literal

import numpy as np
from numpy.typing import NDArray

Entry = dict[str, object]
Values = NDArray[np.float64] | NDArray[np.float32] | NDArray[np.integer]
Stored = Literal["f4", "u1", "u2", "u4"]
BufferTarget = Literal["vertices", "indices", "none"]

COMPONENTS: dict[Stored, int] = {"u1": 5121, "u2": 5123, "u4": 5125, "f4": 5126}
TARGETS = {"vertices": 34962, "indices": 34963}
SHAPES = {1: "SCALAR", 2: "VEC2", 3: "VEC3", 4: "VEC4", 16: "MAT4"}
MAGIC, VERSION = 0x46546C67, 2
TEXT, BINARY = 0x4E4F534A, 0x004E4942


class GltfFile:
    """What a file is made of, as it is collected; every method returns the index of what it adds."""

    def __init__(self, generator: str) -> None:
        self._tables: dict[str, list[Entry]] = {}
        self._asset: Entry = {"version": "2.0", "generator": generator}
        self._roots: list[int] = []
        self._block = bytearray()

    def add(self, table: str, **entry: object) -> int:
        """Adds an entry to a table of the file, such as `nodes` or `materials`; None is left out."""
        rows = self._tables.setdefault(table, [])
        rows.append({key: value for key, value in entry.items() if value is not None})
        return len(rows) - 1

    def entry(self, table: str, index: int) -> Entry:
        """Gives an entry that was added, to be completed."""
        return self._tables[table][index]

    def show(self, node: int) -> None:
        """Puts a node into the scene, with its children."""
        self._roots.append(node)

    def numbers(
        self, values: Values, stored: Stored = "f4", target: BufferTarget = "none", *, bounds: bool = False
    ) -> int:
        """Adds an accessor of (n,) or (n, k) values, with what is least and most of them if asked."""
        rows = np.ascontiguousarray(values, dtype=f"<{stored}")
        width = 1 if rows.ndim == 1 else rows.shape[1]
        entry: Entry = {
            "bufferView": self._view(rows.tobytes(), target),
            "componentType": COMPONENTS[stored],
            "count": len(rows),
            "type": SHAPES[width],
        }
        if bounds:
            flat = rows.reshape(len(rows), width)
            entry |= {"min": flat.min(axis=0).tolist(), "max": flat.max(axis=0).tolist()}
        return self.add("accessors", **entry)

    def shares(self, values: NDArray[np.float64]) -> int:
        """Adds an accessor of (n, 4) shares 0..1 for vertices, a byte each; each row adds up as it did, to 1/255."""
        index = self.numbers(np.rint(255.0 * values).astype(np.uint8), "u1", "vertices")
        self.entry("accessors", index)["normalized"] = True
        return index

    def sparse(self, count: int, places: NDArray[np.integer], values: NDArray[np.float64]) -> int:
        """Adds an accessor of (count, 3) zeros, but for (k, 3) values at (k,) places."""
        bounds = (values if len(places) == count else np.vstack([values, np.zeros((1, 3))])).astype("<f4")
        entry: Entry = {
            "componentType": COMPONENTS["f4"],
            "count": count,
            "type": "VEC3",
            "min": bounds.min(axis=0).tolist(),
            "max": bounds.max(axis=0).tolist(),
        }
        if len(places):
            entry["sparse"] = {
                "count": len(places),
                "indices": {"bufferView": self._view(places.astype("<u4").tobytes()), "componentType": 5125},
                "values": {"bufferView": self._view(values.astype("<f4").tobytes())},
            }
        return self.add("accessors", **entry)

    def picture(self, data: bytes, mime: str) -> int:
        """Adds a texture of an encoded picture."""
        source = self.add("images", bufferView=self._view(data), mimeType=mime)
        sampler = self.add("samplers", magFilter=9729, minFilter=9729, wrapS=33071, wrapT=33071)
        return self.add("textures", source=source, sampler=sampler)

    def write(self, path: Path) -> None:
        """Writes the file."""
        whole: Entry = {"asset": self._asset, "scene": 0, "scenes": [{"nodes": self._roots}]}
        whole |= {"buffers": [{"byteLength": len(self._block)}], **self._tables}
        text = json.dumps(whole, separators=(",", ":")).encode()
        text += b" " * (-len(text) % 4)
        size = 12 + 8 + len(text) + 8 + len(self._block)
        with path.open("wb") as file:
            file.write(struct.pack("<III", MAGIC, VERSION, size))
            file.write(struct.pack("<II", len(text), TEXT) + text)
            file.write(struct.pack("<II", len(self._block), BINARY) + self._block)

    def _view(self, data: bytes, target: BufferTarget = "none") -> int:
        start = len(self._block)
        self._block += data + b"\0" * (-len(data) % 4)
        return self.add("bufferViews", buffer=0, byteOffset=start, byteLength=len(data), target=TARGETS.get(target))
