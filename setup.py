"""Adds the optional compiled kernels; everything else is in pyproject.toml."""

import platform
import sys
from pathlib import Path

import nanobind
import numpy
from setuptools import Extension, setup

NANOBIND = Path(nanobind.__file__).parent
HARDENING = [  # against faults in memory; none of these changes arithmetic
    "-U_FORTIFY_SOURCE",  # some distributions set another level
    "-D_FORTIFY_SOURCE=2",
    "-fstack-protector-strong",
]
HARDENED_LINKING = ["-Wl,-z,relro", "-Wl,-z,now", "-Wl,-z,noexecstack"] if sys.platform == "linux" else []
if platform.machine() == "x86_64":
    HARDENING.append("-fcf-protection")  # other processors have no such instructions


def kernel(room: str) -> Extension:
    """Compiles the C++ of a room into its `_kernel`."""
    sources = Path("kinesic", room, "kernel")
    return Extension(
        f"kinesic.{room}._kernel",
        sources=[*sorted(str(path) for path in sources.glob("*.cpp")), "kinesic/nanobind.cpp"],
        depends=sorted(str(path) for path in sources.glob("*.h")),
        include_dirs=[
            numpy.get_include(),
            nanobind.include_dir(),
            *(str(NANOBIND / part) for part in ("src", "ext/robin_map/include")),
        ],
        extra_compile_args=[
            "-std=c++17",
            "-O3",
            "-DNDEBUG",
            "-g0",
            "-fvisibility=hidden",
            "-fno-strict-aliasing",
            "-ffp-contract=off",  # the same arithmetic with and without fused multiply-add
            *HARDENING,
        ],
        extra_link_args=["-Wl,-s", *HARDENED_LINKING],
        optional=True,  # without a compiler Python does the same, slower
    )


setup(ext_modules=[kernel(room) for room in ("ik", "motion", "controller", "sim")])
