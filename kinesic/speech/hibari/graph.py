"""Changes of hibari's ONNX graph for durations, rate and pitch.

The published graph has one rate for a whole sentence, keeps the duration of each phoneme inside, and has no pitch
factor. The nodes concerned are found by their connections, so that other exports of the same model work as well.
"""

from collections.abc import Iterable
from dataclasses import dataclass

from kinesic.speech.hibari.protobuf import ProtobufError, WireField, encode_bytes, encode_integer, read_fields

SPEED_INPUT = "speed"  # input of the published graph: speech rate
PITCH_INPUT = "pitch"  # added input: factor on the pitch, shape (1, 1) or (1, frames)
PITCH_OUTPUT = "f0"  # output of the published graph: pitch [Hz], shape (1, frames)
SUM_TYPE = "CumSum"  # type of the node that adds up durations
NATURAL_PITCH = "natural_f0"  # added tensor: pitch [Hz] without the factor

# Field numbers of onnx.proto.
MODEL_GRAPH = 7
GRAPH_NODE = 1
GRAPH_INPUT = 11
GRAPH_OUTPUT = 12
NODE_INPUT = 1
NODE_OUTPUT = 2
NODE_TYPE = 4
VALUE_NAME = 1
VALUE_TYPE = 2
TYPE_TENSOR = 1
TENSOR_ELEMENT = 1
TENSOR_SHAPE = 2
SHAPE_DIMENSION = 1
DIMENSION_SIZE = 1
DIMENSION_NAME = 2
FLOAT_ELEMENT = 1  # ONNX code of the element type float32


@dataclass(frozen=True)
class EditedGraph:
    """ONNX model with pitch input, rates per symbol and duration output."""

    model: bytes
    duration_output: str  # output with the duration of each phoneme, in units of two frames; shape (phonemes,)


def edit_graph(model: bytes) -> EditedGraph:
    """Give a model a pitch input, duration output and rate per symbol.

    Raises:
        ProtobufError: the bytes are no ONNX model of this kind.
    """
    parts: list[bytes | memoryview] = []
    durations = ""
    for field in read_fields(memoryview(model)):
        if field.number == MODEL_GRAPH:
            graph, durations = _edit_graph(list(read_fields(field.value)))
            parts.append(encode_bytes(MODEL_GRAPH, graph))
        else:
            parts.append(field.encoded)
    if not durations:
        raise ProtobufError("the model has no graph")
    return EditedGraph(b"".join(parts), durations)


def _edit_graph(fields: list[WireField]) -> tuple[bytes, str]:
    """Add pitch input and duration output, and set the rate per symbol."""
    durations = _find_durations(field.value for field in fields if field.number == GRAPH_NODE)
    parts: list[bytes | memoryview] = []
    edited: list[str] = []
    for field in fields:
        if field.number == GRAPH_NODE and _has_text(field.value, NODE_OUTPUT, PITCH_OUTPUT):
            parts += [encode_bytes(GRAPH_NODE, _rename_output(field.value)), encode_bytes(GRAPH_NODE, _scale_pitch())]
            edited.append(PITCH_OUTPUT)
        elif field.number == GRAPH_INPUT and _texts(field.value, VALUE_NAME) == [SPEED_INPUT]:
            parts.append(
                encode_bytes(GRAPH_INPUT, _float_tensor(SPEED_INPUT, [encode_bytes(DIMENSION_NAME, b"rates")]))
            )
            edited.append(SPEED_INPUT)
        else:
            parts.append(field.encoded)
    if sorted(edited) != [PITCH_OUTPUT, SPEED_INPUT]:
        raise ProtobufError(f"the graph needs one input {SPEED_INPUT} and one node with the output {PITCH_OUTPUT}")
    pitch_shape = [encode_integer(DIMENSION_SIZE, 1), encode_bytes(DIMENSION_NAME, b"pitches")]
    parts.append(encode_bytes(GRAPH_INPUT, _float_tensor(PITCH_INPUT, pitch_shape)))
    parts.append(encode_bytes(GRAPH_OUTPUT, encode_bytes(VALUE_NAME, durations.encode())))
    return b"".join(parts), durations


def _find_durations(nodes: Iterable[memoryview]) -> str:
    """Return the name of the tensor of phoneme durations."""
    sums = [_texts(node, NODE_INPUT) for node in nodes if _has_text(node, NODE_TYPE, SUM_TYPE)]
    if len(sums) != 1 or not sums[0]:
        raise ProtobufError(f"the graph has {len(sums)} running sums, and needs one, of the durations")
    return sums[0][0]


def _has_text(message: memoryview, number: int, text: str) -> bool:
    """Return whether a message has a string field with this text."""
    return text.encode() in bytes(message) and text in _texts(message, number)


def _texts(message: memoryview, number: int) -> list[str]:
    return [field.text for field in read_fields(message) if field.number == number]


def _rename_output(node: memoryview) -> bytes:
    return b"".join(
        encode_bytes(NODE_OUTPUT, NATURAL_PITCH.encode()) if field.number == NODE_OUTPUT else field.encoded
        for field in read_fields(node)
    )


def _scale_pitch() -> bytes:
    """Return a node that multiplies the natural pitch by the factor."""
    inputs = b"".join(encode_bytes(NODE_INPUT, name.encode()) for name in (NATURAL_PITCH, PITCH_INPUT))
    return inputs + encode_bytes(NODE_OUTPUT, PITCH_OUTPUT.encode()) + encode_bytes(NODE_TYPE, b"Mul")


def _float_tensor(name: str, dimensions: Iterable[bytes]) -> bytes:
    """Return the encoded ONNX declaration of a float tensor."""
    shape = b"".join(encode_bytes(SHAPE_DIMENSION, dimension) for dimension in dimensions)
    tensor = encode_integer(TENSOR_ELEMENT, FLOAT_ELEMENT) + encode_bytes(TENSOR_SHAPE, shape)
    return encode_bytes(VALUE_NAME, name.encode()) + encode_bytes(VALUE_TYPE, encode_bytes(TYPE_TENSOR, tensor))
