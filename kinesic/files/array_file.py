"""Reading of numeric and text arrays from untrusted .npz files.

`numpy.load` evaluates headers, allocates the declared sizes, and fails in many ways. Here the header is checked against
the bytes of the file, and every failure is a `ConfigError`.
"""

import ast
import zlib
from collections.abc import Mapping
from pathlib import Path
from typing import BinaryIO
from zipfile import ZIP_DEFLATED, ZIP_STORED, BadZipFile, ZipFile, ZipInfo

import numpy as np
from numpy.typing import NDArray

from kinesic.body.config import ConfigError
from kinesic.files.input_file import open_regular

Array = NDArray[np.generic]

NPY_MAGIC = b"\x93NUMPY"  # first bytes of an .npy file
MAX_HEADER_SIZE = 4096  # [bytes] largest .npy header, including magic and length
MAX_DIMENSIONS = 8  # Largest number of dimensions of an array
NUMBER_KINDS = "biuf"  # NumPy dtype kinds of numbers and booleans
INTEGER_KINDS = "iu"  # NumPy dtype kinds of signed and unsigned integers
TEXT_KINDS = "U"  # NumPy dtype kind of Unicode text
ENCRYPTED_FLAG = 1  # Flag of an encrypted zip entry


def read_arrays(path: Path, *, max_size: int, kind: str = ".npz of arrays") -> Mapping[str, Array]:
    """Read all arrays of an .npz file by name.

    Args:
        path: path of the file.
        max_size: [bytes] largest unpacked size.
        kind: kind of file, for messages.

    Raises:
        ConfigError: the file is missing, damaged, encrypted or too large, or contains other objects than arrays.
    """
    try:
        with open_regular(path) as file:
            return unpack_arrays(file, str(path), max_size=max_size, kind=kind)
    except OSError as error:
        raise ConfigError(f"{path}: {error.strerror or error}") from None


def unpack_arrays(file: BinaryIO, source: str, *, max_size: int, kind: str = ".npz of arrays") -> Mapping[str, Array]:
    """Read all arrays of an opened .npz file by name.

    Args:
        file: open for reading, or bytes in memory.
        source: name of the file, for messages.
        max_size: [bytes] largest unpacked size.
        kind: kind of file, for messages.

    Raises:
        ConfigError: the file is damaged, encrypted or too large, or contains other objects than arrays.
        OSError: the file cannot be read.
    """
    try:
        with ZipFile(file) as archive:
            entries = archive.infolist()
            if (size := sum(entry.file_size for entry in entries)) > max_size:
                raise ConfigError(f"{source}: unpacks to {size / 1e6:.0f} MB, at most {max_size / 1e6:.0f} are read")
            return {entry.filename.removesuffix(".npy"): _parse(_unpack(archive, entry)) for entry in entries}
    except ConfigError:
        raise
    except (ValueError, TypeError, EOFError, BadZipFile, zlib.error, NotImplementedError) as error:
        raise ConfigError(f"{source}: no {kind} ({error})") from None


def _unpack(archive: ZipFile, entry: ZipInfo) -> bytes:
    if entry.flag_bits & ENCRYPTED_FLAG:
        raise ValueError(f"{entry.filename} is encrypted")
    if entry.compress_type not in (ZIP_STORED, ZIP_DEFLATED):
        raise ValueError(f"{entry.filename} is packed by method {entry.compress_type}")
    return archive.read(entry)


def _parse(data: bytes) -> Array:
    """Parse the bytes of an .npy file.

    Raises:
        ValueError: it is damaged, or contains objects or records.
    """
    if data[:6] != NPY_MAGIC or data[6:7] not in (b"\1", b"\2", b"\3"):
        raise ValueError("an entry is no .npy")
    begin = 10 if data[6] == 1 else 12
    end = begin + int.from_bytes(data[8:begin], "little")
    if end > min(len(data), MAX_HEADER_SIZE):
        raise ValueError("the header of an array is too long")
    try:
        header = ast.literal_eval(data[begin:end].decode("latin-1").strip())
        kind, in_columns, shape = header["descr"], header["fortran_order"], header["shape"]
    except (SyntaxError, ValueError, TypeError, KeyError, MemoryError, RecursionError):
        raise ValueError("the header of an array cannot be read") from None
    if not isinstance(kind, str) or not isinstance(shape, tuple) or len(shape) > MAX_DIMENSIONS:
        raise ValueError("an array holds records")
    dtype = np.dtype(kind)
    if dtype.kind not in NUMBER_KINDS + TEXT_KINDS or not all(isinstance(size, int) and size >= 0 for size in shape):
        raise ValueError(f"an array is of type {dtype} and shape {shape}")
    count = 1
    for size in shape:
        count *= size
    if count * dtype.itemsize != len(data) - end:
        raise ValueError(f"an array of shape {shape} has {len(data) - end} bytes")
    if not count:
        return np.zeros(shape, dtype)
    values: Array = np.frombuffer(data, dtype, count, end)
    return values.reshape(shape, order="F" if in_columns else "C")


def numbers_of(arrays: Mapping[str, Array], name: str, dimensions: int) -> Array:
    """Return a numeric or boolean array, checking its number of dimensions.

    Raises:
        ValueError: the array is missing, not numeric, or has another number of dimensions.
    """
    return _checked(arrays, name, dimensions, NUMBER_KINDS, "numbers")


def integers_of(arrays: Mapping[str, Array], name: str, dimensions: int) -> Array:
    """Return an integer array, checking its number of dimensions.

    Raises:
        ValueError: the array is missing, of another type, or has another number of dimensions.
    """
    return _checked(arrays, name, dimensions, INTEGER_KINDS, "integers")


def text_of(arrays: Mapping[str, Array], name: str, dimensions: int) -> Array:
    """Return a text array, checking its number of dimensions.

    Raises:
        ValueError: the array is missing, not text, or has another number of dimensions.
    """
    return _checked(arrays, name, dimensions, TEXT_KINDS, "text")


def _checked(arrays: Mapping[str, Array], name: str, dimensions: int, kinds: str, expected: str) -> Array:
    if name not in arrays:
        raise ValueError(f"it lacks {name}")
    array = arrays[name]
    if array.dtype.kind not in kinds:
        raise ValueError(f"{name} holds {array.dtype}, must be {expected}")
    if array.ndim != dimensions:
        raise ValueError(f"{name} has {array.ndim} dimensions, must have {dimensions}")
    return array
