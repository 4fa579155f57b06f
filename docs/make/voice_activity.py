"""Convert the voice detector Silero VAD 6.2 (MIT) to kinesic/configs/hearing/voice_activity.npz.

Usage: voice_activity.py silero_vad-6.2.0-py3-none-any.whl (from https://pypi.org/project/silero-vad/)
"""

import io
import sys
from collections.abc import Iterator
from pathlib import Path
from zipfile import ZIP_DEFLATED, ZipFile, ZipInfo

import numpy as np
from numpy.typing import NDArray

from kinesic.hearing.voice_activity import WEIGHTS_FILE
from kinesic.speech.hibari.protobuf import read_fields

MODEL_NAME = "silero_vad/data/silero_vad_16k_op15.onnx"  # file in the wheel: the model for 16 kHz
MODEL_GRAPH, GRAPH_INITIALIZER = 7, 5  # field numbers of onnx.proto
TENSOR_DIMENSIONS, TENSOR_NAME, TENSOR_DATA = 1, 8, 9  # field numbers of onnx.proto
FIRST_DATE = (1980, 1, 1, 0, 0, 0)  # time stamp of zip entries, the same for every conversion

Weights = NDArray[np.float32]


def read_tensors(model: bytes) -> Iterator[tuple[str, Weights]]:
    """Yield the constant tensors of an ONNX model of float32 by name."""
    for field in read_fields(memoryview(model)):
        for part in read_fields(field.value) if field.number == MODEL_GRAPH else ():
            if part.number == GRAPH_INITIALIZER:
                entries = list(read_fields(part.value))
                shape = [decode_varint(bytes(entry.value)) for entry in entries if entry.number == TENSOR_DIMENSIONS]
                name = next(entry.text for entry in entries if entry.number == TENSOR_NAME)
                data = next(bytes(entry.value) for entry in entries if entry.number == TENSOR_DATA)
                yield name, np.frombuffer(data, np.float32).reshape(shape)


def decode_varint(encoded: bytes) -> int:
    """Return the integer of an encoded varint."""
    return sum((byte & 0x7F) << 7 * index for index, byte in enumerate(encoded))


def convert(tensors: dict[str, Weights]) -> dict[str, Weights]:
    """Convert the weights to matrices in the layout `features @ weights`."""
    weights = {"fourier": tensors["model.stft.forward_basis_buffer"][:, 0, :].T}
    for layer in range(4):
        kernel = tensors[f"model.encoder.{layer}.reparam_conv.weight"]  # (outputs, inputs, 3)
        weights[f"convolution_{layer}"] = kernel.transpose(2, 1, 0).reshape(-1, len(kernel))
        weights[f"bias_{layer}"] = tensors[f"model.encoder.{layer}.reparam_conv.bias"]
    recurrent = [tensors[f"model.decoder.rnn.weight_{part}"] for part in ("ih", "hh")]
    weights["recurrent"] = np.concatenate(recurrent, axis=1).T
    weights["recurrent_bias"] = tensors["model.decoder.rnn.bias_ih"] + tensors["model.decoder.rnn.bias_hh"]
    weights["output"] = tensors["model.decoder.decoder.2.weight"][0, :, 0]
    weights["output_bias"] = tensors["model.decoder.decoder.2.bias"]
    return weights


def write_arrays(path: Path, arrays: dict[str, Weights]) -> None:
    """Write an .npz file whose bytes depend on the arrays alone."""
    with ZipFile(path, "w", ZIP_DEFLATED, compresslevel=9) as archive:
        for name, array in arrays.items():
            data = io.BytesIO()
            np.lib.format.write_array(data, np.ascontiguousarray(array), allow_pickle=False)
            archive.writestr(ZipInfo(f"{name}.npy", FIRST_DATE), data.getvalue(), ZIP_DEFLATED, 9)


def main(wheel: Path) -> None:
    """Convert the model in a wheel."""
    with ZipFile(wheel) as archive:
        tensors = dict(read_tensors(archive.read(MODEL_NAME)))
    write_arrays(WEIGHTS_FILE, convert(tensors))
    sys.stdout.write(f"{WEIGHTS_FILE}: {WEIGHTS_FILE.stat().st_size} bytes\n")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
