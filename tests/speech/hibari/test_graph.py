import pytest

from kinesic.speech.hibari.graph import (
    GRAPH_INPUT,
    GRAPH_NODE,
    GRAPH_OUTPUT,
    MODEL_GRAPH,
    NATURAL_PITCH,
    NODE_INPUT,
    NODE_OUTPUT,
    NODE_TYPE,
    PITCH_INPUT,
    PITCH_OUTPUT,
    SPEED_INPUT,
    VALUE_NAME,
    edit_graph,
)
from kinesic.speech.hibari.protobuf import ProtobufError, encode_bytes, encode_integer, read_fields


def node(kind: str, inputs: tuple[str, ...], output: str) -> bytes:
    names = [encode_bytes(NODE_INPUT, name.encode()) for name in inputs]
    content = b"".join(names) + encode_bytes(NODE_OUTPUT, output.encode()) + encode_bytes(NODE_TYPE, kind.encode())
    return encode_bytes(GRAPH_NODE, content)


SUM_NODE = node("CumSum", ("durations", "axis"), "ends")  # node that adds up the durations
PITCH_NODE = node("Mul", ("raw", "scale"), PITCH_OUTPUT)  # node that computes the pitch
# declaration of the input for the speech rate
SPEED_FIELD = encode_bytes(GRAPH_INPUT, encode_bytes(VALUE_NAME, SPEED_INPUT.encode()))


def model(*parts: bytes) -> bytes:
    return encode_integer(1, 8) + encode_bytes(MODEL_GRAPH, b"".join(parts)) + encode_bytes(8, b"opset")


def names(graph: bytes, number: int, name_number: int) -> list[str]:
    return [
        field.text
        for part in read_fields(memoryview(graph))
        if part.number == number
        for field in read_fields(part.value)
        if field.number == name_number
    ]


def test_edited_model_graph_has_durations_as_output_and_pitch_as_input():
    edited = edit_graph(model(SPEED_FIELD, SUM_NODE, PITCH_NODE, node("Relu", (PITCH_OUTPUT,), "voiced")))
    before, graph, after = read_fields(memoryview(edited.model))
    assert (bytes(before.encoded), bytes(after.encoded)) == (encode_integer(1, 8), encode_bytes(8, b"opset"))
    assert edited.duration_output == "durations"
    assert names(graph.value, GRAPH_OUTPUT, VALUE_NAME) == ["durations"]
    assert names(graph.value, GRAPH_INPUT, VALUE_NAME) == [SPEED_INPUT, PITCH_INPUT]
    assert names(graph.value, GRAPH_NODE, NODE_OUTPUT) == ["ends", NATURAL_PITCH, PITCH_OUTPUT, "voiced"]
    assert names(graph.value, GRAPH_NODE, NODE_INPUT)[4:6] == [NATURAL_PITCH, PITCH_INPUT]


@pytest.mark.parametrize(
    "parts",
    [
        (),
        (SUM_NODE, PITCH_NODE),
        (SPEED_FIELD, SUM_NODE),
        (SPEED_FIELD, PITCH_NODE),
        (SPEED_FIELD, SUM_NODE, SUM_NODE, PITCH_NODE),
    ],
)
def test_model_graph_with_missing_or_repeated_nodes_is_rejected(parts: tuple[bytes, ...]):
    with pytest.raises(ProtobufError, match="the graph"):
        edit_graph(model(*parts))


def test_model_without_a_graph_is_rejected():
    with pytest.raises(ProtobufError, match="no graph"):
        edit_graph(encode_integer(1, 8))
