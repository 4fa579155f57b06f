"""Writer of binary glTF 2.0 files (.glb)."""

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

COMPONENT_CODES: dict[Stored, int] = {"u1": 5121, "u2": 5123, "u4": 5125, "f4": 5126}  # NumPy dtype -> glTF code
TARGET_CODES = {"vertices": 34962, "indices": 34963}  # glTF buffer target by purpose
SHAPE_NAMES = {1: "SCALAR", 2: "VEC2", 3: "VEC3", 4: "VEC4", 16: "MAT4"}  # glTF accessor type by number of components
GLB_MAGIC = 0x46546C67  # First bytes of a binary glTF file: "glTF"
GLB_VERSION = 2  # Version of the container format
JSON_CHUNK = 0x4E4F534A  # Type of the JSON chunk: "JSON"
BINARY_CHUNK = 0x004E4942  # Type of the binary chunk: "BIN"


class GltfFile:
    """Builder of a glTF file from tables and binary data.

    A method that adds an entry returns its index in the table.
    """

    def __init__(self, generator: str) -> None:
        self._tables: dict[str, list[Entry]] = {}
        self._asset: Entry = {"version": "2.0", "generator": generator}
        self._roots: list[int] = []
        self._block = bytearray()

    def add(self, table: str, **entry: object) -> int:
        """Add an entry to a glTF table such as `nodes` or `materials`.

        Values that are None are omitted.
        """
        rows = self._tables.setdefault(table, [])
        rows.append({key: value for key, value in entry.items() if value is not None})
        return len(rows) - 1

    def entry(self, table: str, index: int) -> Entry:
        """Return a glTF table entry added earlier, for modification."""
        return self._tables[table][index]

    def show(self, node: int) -> None:
        """Add a root node with its children to the glTF scene."""
        self._roots.append(node)

    def numbers(
        self, values: Values, stored: Stored = "f4", target: BufferTarget = "none", *, bounds: bool = False
    ) -> int:
        """Add a glTF accessor of values (n,) or (n, k).

        Minimum and maximum are included if `bounds` is set.
        """
        rows = np.ascontiguousarray(values, dtype=f"<{stored}")
        width = 1 if rows.ndim == 1 else rows.shape[1]
        entry: Entry = {
            "bufferView": self._view(rows.tobytes(), target),
            "componentType": COMPONENT_CODES[stored],
            "count": len(rows),
            "type": SHAPE_NAMES[width],
        }
        if bounds:
            flat = rows.reshape(len(rows), width)
            entry |= {"min": flat.min(axis=0).tolist(), "max": flat.max(axis=0).tolist()}
        return self.add("accessors", **entry)

    def weights(self, values: NDArray[np.float64]) -> int:
        """Add a glTF accessor of vertex weights (n, 4) in 0..1.

        Values are rounded to multiples of 1/255.
        """
        index = self.numbers(np.rint(255.0 * values).astype(np.uint8), "u1", "vertices")
        self.entry("accessors", index)["normalized"] = True
        return index

    def sparse(self, count: int, places: NDArray[np.integer], values: NDArray[np.float64]) -> int:
        """Add a sparse glTF accessor (count, 3) with values (k, 3).

        `places` (k,) are the rows of the values; all other rows are zero.
        """
        bounds = (values if len(places) == count else np.vstack([values, np.zeros((1, 3))])).astype("<f4")
        entry: Entry = {
            "componentType": COMPONENT_CODES["f4"],
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
        """Add an encoded picture to the glTF file as a texture."""
        source = self.add("images", bufferView=self._view(data), mimeType=mime)
        sampler = self.add("samplers", magFilter=9729, minFilter=9729, wrapS=33071, wrapT=33071)
        return self.add("textures", source=source, sampler=sampler)

    def write(self, path: Path) -> None:
        """Write the binary glTF file."""
        whole: Entry = {"asset": self._asset, "scene": 0, "scenes": [{"nodes": self._roots}]}
        whole |= {"buffers": [{"byteLength": len(self._block)}], **self._tables}
        text = json.dumps(whole, separators=(",", ":")).encode()
        text += b" " * (-len(text) % 4)
        size = 12 + 8 + len(text) + 8 + len(self._block)
        with path.open("wb") as file:
            file.write(struct.pack("<III", GLB_MAGIC, GLB_VERSION, size))
            file.write(struct.pack("<II", len(text), JSON_CHUNK) + text)
            file.write(struct.pack("<II", len(self._block), BINARY_CHUNK) + self._block)

    def _view(self, data: bytes, target: BufferTarget = "none") -> int:
        start = len(self._block)
        self._block += data + b"\0" * (-len(data) % 4)
        return self.add(
            "bufferViews", buffer=0, byteOffset=start, byteLength=len(data), target=TARGET_CODES.get(target)
        )
