"""Tells which implementation runs: a compiled kernel, or the same in Python."""

from importlib import import_module
from os import environ
from typing import Literal

Kernel = Literal["compiled", "numpy"]


def find_kernel(module: str) -> Kernel:
    """Says `compiled`, unless set-up found no compiler or KINESIC_KERNEL=numpy asks for Python.

    Args:
        module: that the compiler makes, such as `kinesic.ik._kernel`.
    """
    if environ.get("KINESIC_KERNEL") == "numpy":
        return "numpy"
    try:
        import_module(module)
    except ImportError:
        return "numpy"
    return "compiled"
