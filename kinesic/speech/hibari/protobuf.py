"""Reading and writing of protocol buffer fields in ONNX files.

A message is a sequence of fields: a varint with field number and wire type, and the value.
"""

from collections.abc import Iterator
from typing import NamedTuple

VARINT_TYPE = 0  # wire type of integers
FIXED64_TYPE = 1  # wire type of 8 bytes
BYTES_TYPE = 2  # wire type of strings, messages and packed arrays, after their length
FIXED32_TYPE = 5  # wire type of 4 bytes
FIXED_SIZES = {FIXED64_TYPE: 8, FIXED32_TYPE: 4}  # [bytes] size of a value by wire type
MAX_VARINT_BYTES = 10  # [bytes] longest varint of 64 bits


class ProtobufError(ValueError):
    """Invalid bytes of a protocol buffer message."""


class WireField(NamedTuple):
    """Field of a message with its encoded bytes."""

    number: int  # field number in the message's definition
    value: memoryview  # content without length; of a varint its encoded bytes
    encoded: memoryview  # tag, length and content

    @property
    def text(self) -> str:
        """Content as a string."""
        return bytes(self.value).decode()


def read_fields(message: memoryview) -> Iterator[WireField]:
    """Yield the fields of a message in order, without copying.

    Raises:
        ProtobufError: the bytes are no complete message.
    """
    position = 0
    while position < len(message):
        start = position
        tag, position = _read_varint(message, position)
        kind, begin = tag & 7, position
        if kind == VARINT_TYPE:
            _, end = _read_varint(message, position)
        elif kind == BYTES_TYPE:
            size, begin = _read_varint(message, position)
            end = begin + size
        elif kind in FIXED_SIZES:
            end = begin + FIXED_SIZES[kind]
        else:
            raise ProtobufError(f"wire type {kind} at byte {start} is not supported")
        if end > len(message):
            raise ProtobufError(f"the field at byte {start} ends {end - len(message)} bytes after its message")
        yield WireField(tag >> 3, message[begin:end], message[start:end])
        position = end


def encode_varint(value: int) -> bytes:
    """Encode an integer >= 0 as a varint."""
    encoded = bytearray()
    while value > 0x7F:
        encoded.append(value & 0x7F | 0x80)
        value >>= 7
    encoded.append(value)
    return bytes(encoded)


def encode_bytes(number: int, content: bytes | memoryview) -> bytes:
    """Encode a string or message as a field."""
    return encode_varint(number << 3 | BYTES_TYPE) + encode_varint(len(content)) + bytes(content)


def encode_integer(number: int, value: int) -> bytes:
    """Encode an integer >= 0 as a field."""
    return encode_varint(number << 3 | VARINT_TYPE) + encode_varint(value)


def _read_varint(message: memoryview, position: int) -> tuple[int, int]:
    """Return a varint and the position after it."""
    value = 0
    for count in range(MAX_VARINT_BYTES):
        if position + count >= len(message):
            raise ProtobufError("the message ends within a number")
        byte = message[position + count]
        value |= (byte & 0x7F) << 7 * count
        if byte < 0x80:
            return value, position + count + 1
    raise ProtobufError(f"the number at byte {position} has more than {MAX_VARINT_BYTES} bytes")
