"""Freed memory is returned to the system despite fragmentation."""

import gc
import subprocess
import sys
from types import SimpleNamespace

import pytest

from kinesic import heap

HEAP_PROGRAM = """
import sys
from pathlib import Path
from time import sleep
from kinesic import heap

def resident():
    return int(Path("/proc/self/statm").read_text().split()[1]) * 4096

size = int(sys.argv[1])
heap.TRIM_PERIOD = 0.2
heap.bound_heap()
large = bytes(30_000_000)  # from now on glibc keeps blocks of this size
del large
before = resident()
blocks, pins = [], []
for _ in range(100_000_000 // size):
    blocks.append(bytearray(b"x" * size))
    pins.append(bytearray(b"x" * 1_000))  # between two of them
blocks.clear()
sleep(1.0)
print((resident() - before) // 1_000_000)
"""
MAX_RETAINED = 10  # [MB] largest memory that stays allocated after 100 MB were freed
MIN_FROZEN_OBJECTS = 10_000  # smallest number of frozen objects; the imports of this test alone have more


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="only glibc is configured")
@pytest.mark.parametrize("size", [1_000_000, 50_000])  # [bytes] mapped separately, and within the heap
def test_freed_heap_memory_is_returned_to_the_system(size: int) -> None:
    run = subprocess.run([sys.executable, "-c", HEAP_PROGRAM, str(size)], capture_output=True, text=True, check=True)
    assert int(run.stdout) < MAX_RETAINED


def test_freezing_the_heap_excludes_nine_tenths_of_the_objects_from_collection() -> None:
    heap.freeze_heap()  # stays frozen: otherwise the garbage of other tests would be collected in this one
    count = gc.get_freeze_count()
    assert count > MIN_FROZEN_OBJECTS
    assert len(gc.get_objects()) < count / 10


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="only glibc is configured")
def test_glibc_gets_two_heaps_and_fixed_limits_of_kept_memory(monkeypatch: pytest.MonkeyPatch) -> None:
    settings: dict[int, int] = {}
    library = SimpleNamespace(mallopt=lambda name, value: settings.update({name: value}))
    monkeypatch.setattr(heap.ctypes, "CDLL", lambda name: library)
    monkeypatch.setattr(heap, "_start_trimming", lambda: None)
    heap.bound_heap()
    assert settings == {-8: 2, -3: 128 * 1024, -1: 1024 * 1024}  # numbers of <malloc.h>
