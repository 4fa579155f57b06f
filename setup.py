"""Adds the optional compiled kernel; everything else is in pyproject.toml."""

from pathlib import Path

import nanobind
import numpy
from setuptools import Extension, setup

NANOBIND = Path(nanobind.__file__).parent
KERNEL = Path("kinesic/ik/kernel")

kernel = Extension(
    "kinesic.ik._kernel",
    sources=[*sorted(str(path) for path in KERNEL.glob("*.cpp")), str(NANOBIND / "src" / "nb_combined.cpp")],
    depends=sorted(str(path) for path in KERNEL.glob("*.h")),
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
    optional=True,  # without a compiler the NumPy specification runs
)

setup(ext_modules=[kernel])
