"""SciPy, imported when a mesh of the face is built."""

from importlib import import_module
from typing import TYPE_CHECKING

from kinesic.face.display import DisplayError, explain_missing_packages

if TYPE_CHECKING:
    from types import ModuleType

    import scipy

__all__ = ["scipy"]


class _LateScipy:
    """Stand-in for SciPy that imports its subpackages at their first use."""

    def __getattr__(self, name: str) -> "ModuleType":
        """Import and return a subpackage of SciPy.

        Raises:
            DisplayError: SciPy is not installed.
        """
        if name.startswith("_"):
            raise AttributeError(name)
        try:
            module = import_module(f"scipy.{name}")
        except ModuleNotFoundError:
            if (problem := explain_missing_packages()) is None:
                raise
            raise DisplayError(problem) from None
        setattr(self, name, module)
        return module


if not TYPE_CHECKING:
    scipy = _LateScipy()
