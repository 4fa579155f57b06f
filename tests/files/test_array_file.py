"""Tests of reading .npz files from untrusted sources."""

import io
import re
import struct
import zipfile
from pathlib import Path

import numpy as np
import pytest

from kinesic.body.config import ConfigError
from kinesic.files.array_file import MAX_DIMENSIONS, MAX_HEADER_SIZE, integers_of, numbers_of, read_arrays, text_of

ENOUGH_BYTES = 1_000_000  # [bytes] size limit of the archives
NPY_START = b"\x93NUMPY"  # first bytes of an .npy file
PLAIN_HEADER = "{'descr': '<f8', 'fortran_order': False, 'shape': (2,)}"  # header of an array of two numbers
TWO_NUMBERS = np.array([1.5, -2.5]).tobytes()  # bytes of an array of two numbers


def packed(array: np.ndarray, version: tuple[int, int] = (1, 0)) -> bytes:
    stream = io.BytesIO()
    np.lib.format.write_array(stream, array, version=version, allow_pickle=True)
    return stream.getvalue()


def npy(header: str, body: bytes = TWO_NUMBERS, *, start: bytes = NPY_START + b"\1\0") -> bytes:
    text = header.encode("latin-1")
    return start + struct.pack("<H", len(text)) + text + body


def archive(path: Path, *, method: int = zipfile.ZIP_DEFLATED, **entries: bytes) -> Path:
    with zipfile.ZipFile(path, "w", method) as file:
        for name, data in entries.items():
            file.writestr(f"{name}.npy", data)
    return path


def parse(tmp_path: Path, data: bytes) -> np.ndarray:
    return read_arrays(archive(tmp_path / "some.npz", array=data), max_size=ENOUGH_BYTES)["array"]


@pytest.mark.parametrize(
    "array",
    [
        np.array([1.5, -2.5]),
        np.arange(6, dtype=np.int16).reshape(2, 3),
        np.asfortranarray(np.arange(6.0).reshape(2, 3)),
        np.array(["l_elbow", "neck"]),
        np.array([True, False]),
        np.array(7.0),
        np.arange(4, dtype=">u4"),
        np.zeros((3, 0)),
        np.zeros((1,) * MAX_DIMENSIONS),
    ],
)
@pytest.mark.parametrize("version", [(1, 0), (2, 0), (3, 0)])
def test_written_npy_arrays_are_read_back(tmp_path: Path, array: np.ndarray, version: tuple[int, int]):
    block = parse(tmp_path, packed(array, version))
    assert (block.dtype, block.shape) == (array.dtype, array.shape)
    np.testing.assert_array_equal(block, array)


@pytest.mark.parametrize("write", [np.savez, np.savez_compressed])
def test_npz_arrays_are_returned_by_name(tmp_path: Path, write):
    write(tmp_path / "two.npz", times=np.arange(3.0), names=np.array(["a"]))
    arrays = read_arrays(tmp_path / "two.npz", max_size=ENOUGH_BYTES)
    assert {name: array.tolist() for name, array in arrays.items()} == {"times": [0.0, 1.0, 2.0], "names": ["a"]}


def test_npz_archive_above_the_size_limit_is_refused(tmp_path: Path):
    data, more = packed(np.zeros(1000)), packed(np.zeros(3))
    path = archive(tmp_path / "large.npz", array=data, more=more)
    size = len(data) + len(more)
    assert len(read_arrays(path, max_size=size)) == 2
    with pytest.raises(ConfigError, match=r"large\.npz: unpacks to 0 MB, at most 0 are read"):
        read_arrays(path, max_size=size - 1)
    with pytest.raises(ConfigError, match=r"unpacks to 80 MB, at most 1 are read"):
        read_arrays(archive(tmp_path / "bomb.npz", array=packed(np.zeros(10_000_000))), max_size=ENOUGH_BYTES)


@pytest.mark.parametrize(
    ("data", "said"),
    [
        (b"", "an entry is no .npy"),
        (NPY_START, "an entry is no .npy"),
        (npy(PLAIN_HEADER, start=b"\x93NUMPI\1\0"), "an entry is no .npy"),
        (npy(PLAIN_HEADER, start=NPY_START + b"\4\0"), "an entry is no .npy"),
        (npy(PLAIN_HEADER, start=NPY_START + b"\0\0"), "an entry is no .npy"),
        (NPY_START + b"\1\0" + struct.pack("<H", 60) + b"{}", "array is too long"),
        (npy(PLAIN_HEADER.ljust(MAX_HEADER_SIZE)), "array is too long"),
        (npy("{'descr': "), "cannot be read"),
        (npy("open('secret')"), "cannot be read"),
        (npy("[1]"), "cannot be read"),
        (npy("{'descr': '<f8', 'shape': (2,)}"), "cannot be read"),
        (npy("(" * 3000), "cannot be read"),
        (npy(PLAIN_HEADER.replace("'<f8'", "[('x', '<f8')]")), "holds records"),
        (npy(PLAIN_HEADER.replace("(2,)", "2")), "holds records"),
        (npy(PLAIN_HEADER.replace("(2,)", "(2, 1, 1, 1, 1, 1, 1, 1, 1)")), "holds records"),
        (packed(np.array([{}], dtype=object)), "type object"),
        (npy(PLAIN_HEADER.replace("<f8", "f4,f4")), r"is of type \["),
        (npy(PLAIN_HEADER.replace("<f8", "<c16")), "type complex128"),
        (npy(PLAIN_HEADER.replace("<f8", "no type")), "no type"),
        (npy(PLAIN_HEADER.replace("(2,)", "(-1, -2)")), r"shape \(-1, -2\)"),
        (npy(PLAIN_HEADER.replace("(2,)", "(2.0,)")), r"shape \(2\.0,\)"),
        (npy(PLAIN_HEADER.replace("(2,)", "(3,)")), r"an array of shape \(3,\) has 16 bytes"),
        (npy(PLAIN_HEADER.replace("(2,)", "(1,)")), r"an array of shape \(1,\) has 16 bytes"),
        (npy(PLAIN_HEADER.replace("(2,)", "(0,)")), r"an array of shape \(0,\) has 16 bytes"),
        (npy(PLAIN_HEADER.replace("(2,)", "(1000000000, 1000000000, 1000000000)")), "has 16 bytes"),
    ],
)
def test_broken_or_unsupported_npy_arrays_are_refused_with_a_reason(tmp_path: Path, data: bytes, said: str):
    with pytest.raises(ConfigError, match=rf"some\.npz: no \.npz of arrays \(.*{said}"):
        parse(tmp_path, data)


def test_npy_header_of_the_maximum_size_is_read(tmp_path: Path):
    whole = npy(PLAIN_HEADER.ljust(MAX_HEADER_SIZE - 10))
    assert parse(tmp_path, whole).tolist() == [1.5, -2.5]
    with pytest.raises(ConfigError, match="array is too long"):
        parse(tmp_path, npy(PLAIN_HEADER.ljust(MAX_HEADER_SIZE - 9)))


def test_npz_arrays_compressed_with_lzma_are_refused(tmp_path: Path):
    path = archive(tmp_path / "odd.npz", method=zipfile.ZIP_LZMA, array=packed(np.zeros(2)))
    with pytest.raises(ConfigError, match=r"array\.npy is packed by method 14"):
        read_arrays(path, max_size=ENOUGH_BYTES)
    assert read_arrays(archive(path, method=zipfile.ZIP_STORED, array=packed(np.zeros(2))), max_size=ENOUGH_BYTES)


def test_encrypted_npz_archives_are_refused(tmp_path: Path):
    path = archive(tmp_path / "secret.npz", array=packed(np.zeros(2)))
    data = bytearray(path.read_bytes())
    data[data.index(b"PK\1\2") + 8] |= 1  # flags in the directory of the archive
    path.write_bytes(data)
    with pytest.raises(ConfigError, match=r"array\.npy is encrypted"):
        read_arrays(path, max_size=ENOUGH_BYTES)


def test_missing_or_invalid_npz_archives_are_refused(tmp_path: Path):
    (tmp_path / "text.npz").write_text("no archive")
    with pytest.raises(ConfigError, match=r"text\.npz: no log; a log is a file \(File is not a zip file\)"):
        read_arrays(tmp_path / "text.npz", max_size=ENOUGH_BYTES, kind="log; a log is a file")
    with pytest.raises(ConfigError, match=r"none\.npz: No such file"):
        read_arrays(tmp_path / "none.npz", max_size=ENOUGH_BYTES)
    whole = archive(tmp_path / "cut.npz", array=packed(np.random.default_rng(1).normal(size=100))).read_bytes()
    damaged = bytearray(whole)
    damaged[200:300] = bytes(100)
    (tmp_path / "cut.npz").write_bytes(damaged)
    with pytest.raises(ConfigError, match=re.escape("cut.npz: no .npz of arrays (")):
        read_arrays(tmp_path / "cut.npz", max_size=ENOUGH_BYTES)


SAMPLE_ARRAYS = {
    "times": np.zeros(2),
    "counts": np.zeros((2, 2), np.int32),
    "flags": np.zeros(1, bool),
    "names": np.array(["a"]),
}


def test_requested_npz_array_is_returned_if_type_and_dimension_count_match():
    assert numbers_of(SAMPLE_ARRAYS, "times", 1) is SAMPLE_ARRAYS["times"]
    assert numbers_of(SAMPLE_ARRAYS, "counts", 2) is integers_of(SAMPLE_ARRAYS, "counts", 2) is SAMPLE_ARRAYS["counts"]
    assert numbers_of(SAMPLE_ARRAYS, "flags", 1) is SAMPLE_ARRAYS["flags"]
    assert text_of(SAMPLE_ARRAYS, "names", 1) is SAMPLE_ARRAYS["names"]


@pytest.mark.parametrize(
    ("read", "name", "dimensions", "said"),
    [
        (numbers_of, "angles", 1, "it lacks angles"),
        (numbers_of, "names", 1, "names holds <U1, must be numbers"),
        (integers_of, "times", 1, "times holds float64, must be integers"),
        (integers_of, "flags", 1, "flags holds bool, must be integers"),
        (text_of, "times", 1, "times holds float64, must be text"),
        (numbers_of, "times", 2, "times has 1 dimensions, must have 2"),
        (integers_of, "counts", 1, "counts has 2 dimensions, must have 1"),
        (text_of, "names", 0, "names has 1 dimensions, must have 0"),
    ],
)
def test_npz_files_with_missing_or_wrong_arrays_are_refused(read, name: str, dimensions: int, said: str):
    with pytest.raises(ValueError, match=said):
        read(SAMPLE_ARRAYS, name, dimensions)
