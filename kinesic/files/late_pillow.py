"""Pillow, imported when the first picture is drawn, read or written.

Pillow belongs to extras, so that modules which also do other things can be imported without it.
"""

from importlib import import_module
from importlib.util import find_spec
from typing import TYPE_CHECKING

from kinesic.extras import install_extra

if TYPE_CHECKING:
    from PIL import Image, ImageDraw, ImageFilter, ImageFont

__all__ = ["Image", "ImageDraw", "ImageFilter", "ImageFont", "explain_missing_pillow"]


def explain_missing_pillow() -> str | None:
    """Return how to install Pillow, or None if it is installed."""
    return None if find_spec("PIL") else f"Pillow is not installed: {install_extra('film')}"


class _LateModule:
    """Stand-in for a module of Pillow, which is imported at first use."""

    def __init__(self, name: str) -> None:
        """Set the name of the module in the package PIL."""
        self._name = name

    def __getattr__(self, name: str) -> object:
        """Import the module, and return one of the module's attributes.

        Raises:
            ModuleNotFoundError: Pillow is not installed.
        """
        if name.startswith("_"):
            raise AttributeError(name)
        attribute: object = getattr(import_module(f"PIL.{self._name}"), name)
        setattr(self, name, attribute)
        return attribute


if not TYPE_CHECKING:
    Image, ImageDraw, ImageFilter, ImageFont = map(_LateModule, ("Image", "ImageDraw", "ImageFilter", "ImageFont"))
