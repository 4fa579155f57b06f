"""Content of glTF 2.0 files: JSON, buffers and arrays."""

import base64
import binascii
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal, TypeVar

import msgspec
import numpy as np

from kinesic.body.arrays import Floats
from kinesic.capture.reading.text import MAX_FRAMES, CaptureError, check_numbers, check_size

BINARY_MAGIC = b"glTF"  # first bytes of a .glb file
HEADER_SIZE = 12  # [bytes] length of the header of a .glb file
JSON_CHUNK = 0x4E4F534A  # type of the chunk with the JSON text
BINARY_CHUNK = 0x004E4942  # type of the chunk with the first buffer
DATA_SCHEME = "data:"  # beginning of an embedded buffer
# NumPy type by glTF component type.
COMPONENT_TYPES: Mapping[int, str] = {5120: "i1", 5121: "u1", 5122: "<i2", 5123: "<u2", 5126: "<f4"}
FLOAT_COMPONENT = 5126  # component type of floats; others are normalised integers
COMPONENT_COUNTS: Mapping[str, int] = {"SCALAR": 1, "VEC3": 3, "VEC4": 4}  # type -> numbers in an array element
MAX_BUFFERS = 4  # largest number of buffers of a file
MAX_ELEMENTS = 3 * MAX_FRAMES  # largest number of elements of an array: a cubic spline has three of each key

Item = TypeVar("Item")
Interpolation = Literal["LINEAR", "STEP", "CUBICSPLINE"]
LoadBuffer = Callable[[str], bytes]


class _Buffer(msgspec.Struct):
    """Binary data of a file."""

    uri: str | None = None


class _View(msgspec.Struct, rename="camel"):
    """Part of a buffer."""

    buffer: int
    byte_length: int
    byte_offset: int = 0
    byte_stride: int | None = None


class _Accessor(msgspec.Struct, rename="camel"):
    """Array in a buffer view."""

    component_type: int
    count: int
    type: str
    buffer_view: int | None = None
    byte_offset: int = 0
    sparse: dict[str, object] | None = None


class Node(msgspec.Struct):
    """Joint or other object of a scene."""

    name: str = ""
    children: list[int] = []
    translation: tuple[float, float, float] = (0.0, 0.0, 0.0)
    rotation: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 1.0)
    scale: tuple[float, float, float] = (1.0, 1.0, 1.0)
    matrix: list[float] | None = None  # (16,) transformation matrix, column by column


class _Sampler(msgspec.Struct):
    """Key frames of one property."""

    input: int  # index of the accessor with the times
    output: int  # index of the accessor with the values
    interpolation: Interpolation = "LINEAR"


class _Target(msgspec.Struct):
    """Animated property of a node."""

    path: str  # name of the property
    node: int | None = None  # index of the node


class _Channel(msgspec.Struct):
    """Connection of a sampler with a node's property."""

    sampler: int
    target: _Target


class Animation(msgspec.Struct):
    """Key frames of one animation."""

    channels: list[_Channel]
    samplers: list[_Sampler]
    name: str = ""


class Scene(msgspec.Struct, rename="camel"):
    """Parts of a glTF file that describe skeletal animation."""

    nodes: list[Node] = []
    animations: list[Animation] = []
    buffers: list[_Buffer] = []
    buffer_views: list[_View] = []
    accessors: list[_Accessor] = []


@dataclass(frozen=True, eq=False)
class GltfArrays:
    """Numeric arrays of a glTF file, by the index of their accessor."""

    scene: Scene
    buffers: Sequence[bytes]
    source: str

    def read(self, index: int, kind: str) -> Floats:
        """Return an accessor's elements (m, k).

        Raises:
            CaptureError: it is missing, of another type, or beyond its buffer.
        """
        place = f"{self.source}: accessors[{index}]"
        accessor = get_item(self.scene.accessors, index, place)
        dtype = COMPONENT_TYPES.get(accessor.component_type)
        if accessor.type != kind or dtype is None or accessor.sparse is not None or accessor.buffer_view is None:
            raise CaptureError(f"{place}: it must be a dense array of {kind} in floats or normalised integers")
        view = get_item(self.scene.buffer_views, accessor.buffer_view, f"{place}: bufferView {accessor.buffer_view}")
        data = get_item(self.buffers, view.buffer, f"{place}: buffer {view.buffer}")
        width = COMPONENT_COUNTS[kind]
        size = np.dtype(dtype).itemsize * width
        stride, begin = view.byte_stride or size, view.byte_offset + accessor.byte_offset
        end = begin + stride * (accessor.count - 1) + size
        is_inside = 0 <= view.byte_offset <= begin and end <= min(len(data), view.byte_offset + view.byte_length)
        if not (1 <= accessor.count <= MAX_ELEMENTS and stride >= size and is_inside):
            raise CaptureError(f"{place}: {accessor.count} elements from byte {begin} are outside of its buffer")
        elements = np.ndarray((accessor.count, width), dtype, data, begin, (stride, np.dtype(dtype).itemsize))
        values = elements.astype(np.float64)
        if accessor.component_type != FLOAT_COMPONENT:
            values = np.maximum(values / np.iinfo(dtype).max, -1.0)
        return check_numbers(values, place)


def read_scene(data: bytes, source: str, load_buffer: LoadBuffer) -> GltfArrays:
    """Read the JSON and the buffers of a glTF file.

    Args:
        data: content of the file.
        source: name of the file, for messages.
        load_buffer: returns the bytes of a buffer by its URI.

    Raises:
        CaptureError: the data is not glTF.
    """
    check_size(data, source)
    text, binary = _split_binary(data, source) if data.startswith(BINARY_MAGIC) else (data, b"")
    try:
        scene = msgspec.json.decode(text, type=Scene)
    except (msgspec.DecodeError, RecursionError, UnicodeDecodeError) as error:
        raise CaptureError(f"{source}: not glTF: {error}") from None
    if len(scene.buffers) > MAX_BUFFERS:
        raise CaptureError(f"{source}: {len(scene.buffers)} buffers; at most {MAX_BUFFERS} are read")
    buffers = [_load(buffer, binary, load_buffer, f"{source}: buffers[{k}]") for k, buffer in enumerate(scene.buffers)]
    return GltfArrays(scene, buffers, source)


def get_item(items: Sequence[Item], index: int, place: str) -> Item:
    """Return an item by the index that a file states.

    Raises:
        CaptureError: there is no such item; the message begins with the place.
    """
    if not 0 <= index < len(items):
        raise CaptureError(f"{place} does not exist")
    return items[index]


def _split_binary(data: bytes, source: str) -> tuple[bytes, bytes]:
    """Return the JSON and the binary chunk of a .glb file."""
    chunks: dict[int, bytes] = {}
    begin = HEADER_SIZE
    while begin + 8 <= len(data):
        size, kind = (int.from_bytes(data[k : k + 4], "little") for k in (begin, begin + 4))
        if begin + 8 + size > len(data):
            raise CaptureError(f"{source}: it ends within a chunk of {size} bytes")
        chunks.setdefault(kind, data[begin + 8 : begin + 8 + size])
        begin += 8 + size
    if JSON_CHUNK not in chunks:
        raise CaptureError(f"{source}: not glTF 2.0: it has no JSON chunk")
    return chunks[JSON_CHUNK], chunks.get(BINARY_CHUNK, b"")


def _load(buffer: _Buffer, binary: bytes, load_buffer: LoadBuffer, place: str) -> bytes:
    if buffer.uri is None:
        return binary
    if not buffer.uri.startswith(DATA_SCHEME):
        return load_buffer(buffer.uri)
    try:
        return base64.b64decode(buffer.uri.partition(",")[2], validate=True)
    except (binascii.Error, ValueError):
        raise CaptureError(f"{place}: its embedded data is no base64") from None
