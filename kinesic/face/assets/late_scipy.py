"""SciPy, imported when a mesh is built, as the extra `face` installs it."""

from importlib import import_module
from importlib.util import find_spec
from typing import TYPE_CHECKING

from kinesic.extras import install_extra
from kinesic.face.display import DisplayError

if TYPE_CHECKING:
    from types import ModuleType

    import scipy

__all__ = ["scipy"]


class _LateScipy:
    """Stand-in for SciPy that imports its subpackages at their first use."""

    def __getattr__(self, name: str) -> "ModuleType":
        """Import a subpackage.

        Raises:
            DisplayError: SciPy is not installed.
        """
        if name.startswith("_"):
            raise AttributeError(name)
        try:
            module = import_module(f"scipy.{name}")
        except ModuleNotFoundError:
            if find_spec("scipy"):
                raise
            raise DisplayError(f"scipy is not installed: {install_extra('face')}") from None
        setattr(self, name, module)
        return module


if not TYPE_CHECKING:
    scipy = _LateScipy()
