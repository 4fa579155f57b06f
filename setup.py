"""Compiles the extension kinesic._kernel.compiled, and prepares the README for PyPI; the rest is in pyproject.toml."""

import os
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import nanobind
import numpy
from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext

sys.path.insert(0, str(Path(__file__).parent))
from build_backend import needs_zig, published_readme, python_headers, target_processor, uses_stable_abi, write_zig

PACKAGES = ("controller", "ik", "metrics", "motion", "sim")  # that have C++ sources, each in its folder `kernel`
NANOBIND = Path(nanobind.__file__).parent
IS_MSVC = sys.platform == "win32"  # whose options are others
IS_STABLE = uses_stable_abi()
STDIO = ["/FIcstdio" if IS_MSVC else "-includecstdio"] if IS_STABLE else []  # nanobind prints; Python.h omits it there
ARITHMETIC = [  # the same results on all machines
    "-O3",
    "-fno-strict-aliasing",
    "-ffp-contract=off",  # the same arithmetic with and without fused multiply-add
]
HARDENING = [  # against memory errors; these options do not change arithmetic
    "-U_FORTIFY_SOURCE",  # some distributions set another level
    "-D_FORTIFY_SOURCE=2",
    "-fstack-protector-strong",
]
if target_processor() == "x86_64":
    HARDENING.append("-fcf-protection")  # other processors have no such instructions
HARDENED_LINKING = ["-Wl,-s", "-Wl,-z,relro", "-Wl,-z,now", "-Wl,-z,noexecstack"] if sys.platform == "linux" else []

sources = [
    *sorted(str(path) for package in PACKAGES for path in Path("kinesic", package, "kernel").glob("*.cpp")),
    "kinesic/_kernel/compiled.cpp",
    "kinesic/_kernel/nanobind.cpp",
]
headers = sorted(str(path) for package in PACKAGES for path in Path("kinesic", package, "kernel").glob("*.h"))


class BuildKernel(build_ext):
    """Compile the sources at the same time, by zig where the machine has no compiler."""

    def build_extensions(self) -> None:
        """Build the extension with as many compilers at once as there are processors."""
        for extension in self.extensions:
            extension.include_dirs += python_headers(Path(self.build_temp, "python-headers"))
        if needs_zig():
            zig = write_zig(Path(self.build_temp))
            self.compiler.set_executables(
                compiler_cxx=[zig],
                compiler_so=[zig, "-fPIC", "-fwrapv"],
                compiler_so_cxx=[zig, "-fPIC", "-fwrapv"],
                linker_so=[zig, "-shared"],
                linker_so_cxx=[zig, "-shared"],
            )
        compile_sources = self.compiler.compile

        def compile_in_parallel(sources: list[str], **options: object) -> list[str]:
            with ThreadPoolExecutor(os.cpu_count()) as pool:
                objects = pool.map(lambda source: compile_sources([source], **options), sources)
                return [name for names in objects for name in names]

        self.compiler.compile = compile_in_parallel
        super().build_extensions()


kernel = Extension(
    "kinesic._kernel.compiled",
    sources=sources,
    depends=headers,
    include_dirs=[
        numpy.get_include(),
        nanobind.include_dir(),
        *(str(NANOBIND / part) for part in ("src", "ext/robin_map/include")),
    ],
    define_macros=[("NDEBUG", None), *([("Py_LIMITED_API", "0x030C0000")] if IS_STABLE else [])],
    py_limited_api=IS_STABLE,
    extra_compile_args=["/std:c++17", "/O2", "/fp:precise", *STDIO]
    if IS_MSVC
    else ["-std=c++17", "-g0", "-fvisibility=hidden", *ARITHMETIC, *HARDENING, *STDIO],
    extra_link_args=HARDENED_LINKING,
)

setup(
    long_description=published_readme(),
    long_description_content_type="text/markdown",
    ext_modules=[kernel],
    cmdclass={"build_ext": BuildKernel},
    options={"bdist_wheel": {"py_limited_api": "cp312"}} if IS_STABLE else {},
)
