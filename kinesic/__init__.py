"""kinesic performs BML on humanoids with servos."""

from importlib import import_module
from typing import TYPE_CHECKING

__all__ = ["Robot", "__version__", "client", "perform", "plan"]

if TYPE_CHECKING:
    from kinesic import client
    from kinesic.body.robot import Robot
    from kinesic.controller.perform import perform, plan
    from kinesic.version import __version__


def __getattr__(name: str) -> object:
    """Imports the public functions when they are first asked for: `import kinesic` stays fast."""
    if name == "Robot":
        from kinesic.body.robot import Robot  # noqa: PLC0415 - only when asked for

        return Robot
    if name == "__version__":
        from kinesic.version import __version__  # noqa: PLC0415 - only when asked for

        return __version__
    if name == "client":
        return import_module("kinesic.client")
    if name in ("plan", "perform"):
        from kinesic.controller import perform as module  # noqa: PLC0415 - only when asked for

        return getattr(module, name)
    raise AttributeError(f"module kinesic has no attribute {name}")
