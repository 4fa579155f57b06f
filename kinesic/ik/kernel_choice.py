"""Which implementation of inverse kinematics runs: the compiled kernel, or its specification in NumPy."""

from importlib import import_module
from os import environ
from typing import Literal

Kernel = Literal["compiled", "numpy"]


def _present() -> Kernel:
    """Compiled, unless set-up found no compiler or KINESIC_KERNEL=numpy asks for the specification."""
    if environ.get("KINESIC_KERNEL") == "numpy":
        return "numpy"
    try:
        import_module("kinesic.ik._kernel")
    except ImportError:
        return "numpy"
    return "compiled"


KERNEL: Kernel = _present()  # which implementation runs
