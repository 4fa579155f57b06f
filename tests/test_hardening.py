"""Compiled kernels are hardened, so that memory faults cannot run foreign code."""

import struct
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent
KERNELS = sorted((ROOT / "kinesic" / "_kernel").glob("*.so"))
DYNAMIC_SEGMENT, STACK_SEGMENT, RELRO_SEGMENT = 2, 0x6474E551, 0x6474E552  # ELF segment types
EXECUTABLE_FLAG = 1  # flag of an executable segment
FLAGS_1_ENTRY = 0x6FFFFFFB  # tag DT_FLAGS_1 of an entry of the dynamic segment
BIND_NOW_FLAG = 1  # flag in DT_FLAGS_1: all addresses are bound at load time


def segments(image: bytes) -> dict[int, tuple[int, bytes]]:
    """Return flags and content of each segment of a 64-bit ELF file."""
    offset, size, count = struct.unpack_from("<Q", image, 32)[0], *struct.unpack_from("<HH", image, 54)
    results = {}
    for number in range(count):
        kind, flags, start, _, _, length = struct.unpack_from("<IIQQQQ", image, offset + number * size)
        results[kind] = (flags, image[start : start + length])
    return results


@pytest.mark.parametrize("kernel", KERNELS, ids=lambda path: path.parent.name)
def test_compiled_kernels_have_full_relro_and_a_non_executable_stack(kernel: Path):
    if kernel.stat().st_mtime < (ROOT / "setup.py").stat().st_mtime:
        pytest.skip("built before setup.py was changed; make builds it anew")
    image = kernel.read_bytes()
    if not image.startswith(b"\x7fELF\x02\x01"):
        pytest.skip("no ELF file of 64 bits")
    result = segments(image)
    entries = dict(struct.iter_unpack("<QQ", result[DYNAMIC_SEGMENT][1]))
    assert RELRO_SEGMENT in result
    assert entries.get(FLAGS_1_ENTRY, 0) & BIND_NOW_FLAG
    assert not result[STACK_SEGMENT][0] & EXECUTABLE_FLAG
