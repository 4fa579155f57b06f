"""Tests of the kernel's memory allocations, counted by a replaced malloc."""

import ctypes.util
import os
import shutil
import subprocess
import sys

import pytest

# C library that counts calls of malloc, calloc and realloc
COUNTER_SOURCE = """
#include <stddef.h>
extern void *__libc_malloc(size_t), *__libc_calloc(size_t, size_t), *__libc_realloc(void *, size_t);
static unsigned long calls;
unsigned long memory_calls(void) { return calls; }
void *malloc(size_t size) { calls++; return __libc_malloc(size); }
void *calloc(size_t count, size_t size) { calls++; return __libc_calloc(count, size); }
void *realloc(void *old, size_t size) { calls++; return __libc_realloc(old, size); }
"""
# program that counts allocations of repeated solutions
TASK_SCRIPT = """
import ctypes
import numpy as np
from kinesic.body.robot import Robot
from kinesic.ik.arm.compiled import arm_of

chain, chance = Robot.load().arms["l"], np.random.default_rng(1)
arm = arm_of(chain)
targets = np.array([chain.hand(chance.uniform(chain.lower, chain.upper)) for _ in range(4000)])
angles, residuals = np.empty((len(targets), len(chain.rest))), np.empty(len(targets))
arm.reach_many(targets, chain.rest, 12, angles, residuals)
calls = ctypes.CDLL(None).memory_calls
calls.restype = ctypes.c_ulong
before = calls()
arm.reach_many(targets, chain.rest, 12, angles, residuals)
print(calls() - before)
upward = np.array([0.0, 0.0, 1.0])
arm.swing(targets[0], upward, None, chain.rest, angles[0], 3.0)
before = calls()
for target, found in zip(targets[:400], angles[:400]):
    arm.swing(target, upward, None, chain.rest, found, 3.0)
print(calls() - before)
ahead = np.array([1.0, 0.0, 0.0])
arm.hold(targets[0], upward, ahead, chain.rest)
before = calls()
for target in targets[:40]:
    arm.hold(target, upward, ahead, chain.rest)
print(calls() - before)
"""


@pytest.mark.skipif(shutil.which("cc") is None, reason="no C compiler for the counter")
@pytest.mark.skipif(ctypes.util.find_library("c") != "libc.so.6", reason="the counter needs glibc")
def test_ik_kernel_does_not_allocate_memory_for_each_solution(tmp_path):
    source, library = tmp_path / "counter.c", tmp_path / "counter.so"
    source.write_text(COUNTER_SOURCE)
    subprocess.run(["cc", "-shared", "-fPIC", "-O1", str(source), "-o", str(library)], check=True)
    result = subprocess.run(
        [sys.executable, "-c", TASK_SCRIPT],
        env={**os.environ, "LD_PRELOAD": str(library)},
        capture_output=True,
        text=True,
        check=True,
    )
    assert all(int(line) < 40 for line in result.stdout.splitlines())  # the calls themselves, from Python
