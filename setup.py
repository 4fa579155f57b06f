"""Adds the optional compiled kernels; everything else is in pyproject.toml."""

from pathlib import Path

import nanobind
import numpy
from setuptools import Extension, setup

NANOBIND = Path(nanobind.__file__).parent


def kernel(room: str) -> Extension:
    """Compiles the C++ of a room into its `_kernel`."""
    sources = Path("kinesic", room, "kernel")
    return Extension(
        f"kinesic.{room}._kernel",
        sources=[*sorted(str(path) for path in sources.glob("*.cpp")), str(NANOBIND / "src" / "nb_combined.cpp")],
        depends=sorted(str(path) for path in sources.glob("*.h")),
        include_dirs=[numpy.get_include(), nanobind.include_dir(), str(NANOBIND / "ext" / "robin_map" / "include")],
        extra_compile_args=[
            "-std=c++17",
            "-O3",
            "-DNDEBUG",
            "-g0",
            "-fvisibility=hidden",
            "-fno-strict-aliasing",
            "-ffp-contract=off",  # the same arithmetic with and without fused multiply-add
        ],
        extra_link_args=["-Wl,-s"],
        optional=True,  # without a compiler Python does the same, slower
    )


setup(ext_modules=[kernel(room) for room in ("ik", "motion", "controller", "sim")])
