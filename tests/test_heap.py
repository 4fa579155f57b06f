"""Freed memory goes back to the system, however it was fragmented."""

import subprocess
import sys

import pytest

WORK = """
import sys
from pathlib import Path
from kinesic.heap import bound_heap

def resident():
    return int(Path("/proc/self/statm").read_text().split()[1]) * 4096

if sys.argv[1] == "bound":
    bound_heap()
large = bytes(30_000_000)  # from now on glibc keeps blocks of this size
del large
before = resident()
blocks, pins = [], []
for _ in range(100):
    blocks.append(bytearray(b"x" * 1_000_000))
    pins.append(bytearray(b"x" * 1_000))  # between two of them
blocks.clear()
print((resident() - before) // 1_000_000)
"""
MAX_KEPT = 10  # [MB] of 100 that were freed


def kept(how: str) -> int:
    run = subprocess.run([sys.executable, "-c", WORK, how], capture_output=True, text=True, check=True)
    return int(run.stdout)


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="only glibc is configured")
def test_freed_blocks_are_returned_to_the_system() -> None:
    assert kept("bound") < MAX_KEPT
