"""Reader of the records of MCAP files, as ROS 2 records them."""

import struct
from collections.abc import Iterator
from dataclasses import dataclass

from kinesic.capture.reading.text import CaptureError, check_size
from kinesic.extras import install_extra

FILE_MAGIC = b"\x89MCAP0\r\n"  # first bytes of an MCAP file
OPCODE_SCHEMA = 0x03  # record of a message type
OPCODE_CHANNEL = 0x04  # record of a topic
OPCODE_MESSAGE = 0x05  # record of one message
OPCODE_CHUNK = 0x06  # record of compressed records
OPCODE_DATA_END = 0x0F  # record after the last message
RECORD_HEADER = struct.Struct("<BQ")  # fields of a record's header: opcode, length
MESSAGE_HEADER = struct.Struct("<HIQQ")  # fields before a message: channel, sequence, log time, publish time
CHUNK_HEADER = struct.Struct("<QQQI")  # fields of a chunk: first and last log time, unpacked size, checksum
MAX_CHUNK_SIZE = 64_000_000  # [bytes] largest unpacked chunk
MAX_UNPACKED_SIZE = 512_000_000  # [bytes] largest sum of all unpacked chunks
SECONDS_PER_TICK = 1e-9  # [s] unit of log times


@dataclass(frozen=True)
class Topic:
    """Topic of an MCAP file with its message type."""

    name: str
    schema: str  # message type, such as sensor_msgs/msg/JointState
    encoding: str  # encoding of messages, such as cdr


@dataclass(frozen=True)
class Message:
    """One recorded message."""

    topic: Topic
    time: float  # [s] log time
    data: bytes


class _Fields:
    """Reader of the successive fields of a record."""

    def __init__(self, data: bytes) -> None:
        self._data = data
        self._position = 0

    def unpack(self, layout: struct.Struct) -> tuple[int, ...]:
        """Return the numbers of a fixed layout.

        Raises:
            struct.error: the record ends before.
        """
        numbers: tuple[int, ...] = layout.unpack_from(self._data, self._position)
        self._position += layout.size
        return numbers

    def text(self) -> str:
        """Return a text with its length before it."""
        (size,) = self.unpack(struct.Struct("<I"))
        begin, self._position = self._position, self._position + size
        if self._position > len(self._data):
            raise struct.error(f"a text of {size} bytes")
        return self._data[begin : self._position].decode("utf-8", "replace")

    def rest(self) -> bytes:
        """Return all remaining bytes of the record."""
        return self._data[self._position :]


def read_messages(data: bytes, source: str) -> Iterator[Message]:
    """Yield all messages of an MCAP file in file order.

    Raises:
        CaptureError: the data is no MCAP file, is damaged, or needs a missing package.
    """
    check_size(data, source)
    if not data.startswith(FILE_MAGIC):
        raise CaptureError(f"{source}: not an MCAP file: its first bytes differ")
    schemas: dict[int, str] = {}
    topics: dict[int, Topic] = {}
    for place, opcode, record in _read_records(data[len(FILE_MAGIC) :], source):
        fields = _Fields(record)
        try:
            if opcode == OPCODE_SCHEMA:
                (schema,) = fields.unpack(struct.Struct("<H"))
                schemas[schema] = fields.text()
            elif opcode == OPCODE_CHANNEL:
                channel, schema = fields.unpack(struct.Struct("<HH"))
                topics[channel] = Topic(fields.text(), schemas.get(schema, ""), fields.text())
            elif opcode == OPCODE_MESSAGE:
                channel, _, time, _ = fields.unpack(MESSAGE_HEADER)
                if channel not in topics:
                    raise CaptureError(f"{place}: a message of the unknown channel {channel}")
                yield Message(topics[channel], time * SECONDS_PER_TICK, fields.rest())
        except struct.error as error:
            raise CaptureError(f"{place}: a record is incomplete ({error})") from None


def _read_records(data: bytes, source: str) -> Iterator[tuple[str, int, bytes]]:
    """Yield location text, opcode and content of records before `Data End`.

    Records of chunks are unpacked.
    """
    unpacked = 0
    for place, opcode, record in _split_records(data, source, len(FILE_MAGIC)):
        if opcode == OPCODE_DATA_END:
            return
        if opcode != OPCODE_CHUNK:
            yield place, opcode, record
            continue
        content = _unpack(record, place)
        unpacked += len(content)
        if unpacked > MAX_UNPACKED_SIZE:
            raise CaptureError(f"{place}: its chunks unpack to more than {MAX_UNPACKED_SIZE // 1_000_000} MB")
        yield from _split_records(content, f"{place}: chunk", 0)


def _split_records(data: bytes, source: str, begin: int) -> Iterator[tuple[str, int, bytes]]:
    """Yield the place, opcode and content of successive records.

    Args:
        data: the records.
        source: name of the file, for places.
        begin: position of the data in the file.
    """
    position = 0
    while position + RECORD_HEADER.size <= len(data):
        place = f"{source}: byte {begin + position}"
        opcode, size = RECORD_HEADER.unpack_from(data, position)
        position += RECORD_HEADER.size
        if position + size > len(data):
            raise CaptureError(f"{place}: a record of {size} bytes is incomplete")
        yield place, opcode, data[position : position + size]
        position += size


def _unpack(record: bytes, place: str) -> bytes:
    """Return the records of a chunk.

    Raises:
        CaptureError: the chunk is damaged, too large, or needs a missing package.
    """
    fields = _Fields(record)
    try:
        _, _, size, _ = fields.unpack(CHUNK_HEADER)
        compression = fields.text()
        packed = fields.rest()[8:]
    except struct.error as error:
        raise CaptureError(f"{place}: a chunk is incomplete ({error})") from None
    if size > MAX_CHUNK_SIZE:
        raise CaptureError(f"{place}: a chunk unpacks to {size} bytes; at most {MAX_CHUNK_SIZE} are read")
    match compression:
        case "":
            content = packed
        case "lz4":
            content = _unpack_lz4(packed, size, place)
        case "zstd":
            content = _unpack_zstandard(packed, size, place)
        case _:
            raise CaptureError(f"{place}: a chunk has the unknown compression {compression[:20]!r}")
    if len(content) != size:
        raise CaptureError(f"{place}: a chunk unpacks to {len(content)} bytes, but states {size}")
    return content


def _unpack_lz4(packed: bytes, size: int, place: str) -> bytes:
    try:
        from lz4.frame import LZ4FrameDecompressor  # noqa: PLC0415 - an extra
    except ModuleNotFoundError:
        raise CaptureError(f"{place}: lz4 chunks need lz4: {install_extra('bags')}") from None
    try:
        content: bytes = LZ4FrameDecompressor().decompress(packed, max_length=size + 1)
    except (RuntimeError, EOFError) as error:
        raise CaptureError(f"{place}: a chunk is damaged ({error})") from None
    return content


def _unpack_zstandard(packed: bytes, size: int, place: str) -> bytes:
    try:
        import zstandard  # noqa: PLC0415 - an extra
    except ModuleNotFoundError:
        raise CaptureError(f"{place}: zstd chunks need zstandard: {install_extra('bags')}") from None
    try:
        with zstandard.ZstdDecompressor(max_window_size=MAX_CHUNK_SIZE).stream_reader(packed) as stream:
            return stream.read(size + 1)
    except zstandard.ZstdError as error:
        raise CaptureError(f"{place}: a chunk is damaged ({error})") from None
