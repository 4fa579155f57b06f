import pytest

from kinesic.speech.hibari.protobuf import (
    ProtobufError,
    encode_bytes,
    encode_integer,
    encode_varint,
    read_fields,
)


def test_protobuf_fields_of_every_wire_type_are_read_with_their_bytes():
    message = encode_integer(1, 300) + encode_bytes(2000, b"text") + b"\x1d" + bytes(4) + b"\x21" + bytes(8)
    fields = list(read_fields(memoryview(message)))
    assert [field.number for field in fields] == [1, 2000, 3, 4]
    assert [len(field.value) for field in fields] == [2, 4, 4, 8]
    assert fields[1].text == "text"
    assert b"".join(field.encoded for field in fields) == message


@pytest.mark.parametrize(("value", "encoded"), [(0, b"\0"), (127, b"\x7f"), (128, b"\x80\x01"), (300, b"\xac\x02")])
def test_protobuf_varints_are_encoded_in_groups_of_seven_bits(value: int, encoded: bytes):
    assert encode_varint(value) == encoded


@pytest.mark.parametrize(
    "message", [b"\x08", b"\x08\x80", b"\x12\x05abc", b"\x0b", b"\x0d\0\0", b"\x08" + 11 * b"\xff"]
)
def test_truncated_and_unknown_protobuf_fields_are_rejected(message: bytes):
    with pytest.raises(ProtobufError):
        list(read_fields(memoryview(message)))
