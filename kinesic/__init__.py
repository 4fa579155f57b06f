"""kinesic performs BML on servo humanoids."""

from typing import TYPE_CHECKING

from kinesic.importing import import_at_once

__all__ = [
    "BmlError",
    "BusError",
    "Client",
    "ConfigError",
    "Performance",
    "Performer",
    "Plan",
    "Robot",
    "Style",
    "__version__",
    "certify",
    "perform",
    "plan",
    "solve_ik",
    "track_ik",
]

if TYPE_CHECKING:
    from kinesic import client as client
    from kinesic import ik as ik
    from kinesic import motion as motion
    from kinesic.bml.block import BmlError
    from kinesic.body.config import ConfigError
    from kinesic.body.robot import Robot
    from kinesic.client import Client
    from kinesic.expressivity.style.style import Style
    from kinesic.hardware.protocol.wire import BusError
    from kinesic.ik.solve import solve as solve_ik
    from kinesic.ik.track import track as track_ik
    from kinesic.performer import Performer, perform
    from kinesic.planning.plan import Plan
    from kinesic.report.run import Performance
    from kinesic.session.certify import certify
    from kinesic.session.plan import plan
    from kinesic.version import __version__

_LAZY_MODULES = ("client", "ik", "motion")
_LAZY_NAMES = {
    "BmlError": ("kinesic.bml.block", "BmlError"),
    "BusError": ("kinesic.hardware.protocol.wire", "BusError"),
    "Client": ("kinesic.client", "Client"),
    "ConfigError": ("kinesic.body.config", "ConfigError"),
    "Performance": ("kinesic.report.run", "Performance"),
    "Performer": ("kinesic.performer", "Performer"),
    "Plan": ("kinesic.planning.plan", "Plan"),
    "Robot": ("kinesic.body.robot", "Robot"),
    "Style": ("kinesic.expressivity.style.style", "Style"),
    "__version__": ("kinesic.version", "__version__"),
    "certify": ("kinesic.session.certify", "certify"),
    "perform": ("kinesic.performer", "perform"),
    "plan": ("kinesic.session.plan", "plan"),
    "solve_ik": ("kinesic.ik.solve", "solve"),
    "track_ik": ("kinesic.ik.track", "track"),
}


def __getattr__(name: str) -> object:
    """Import public names at first use, so that `import kinesic` stays fast."""
    if name in _LAZY_MODULES:
        return import_at_once(f"kinesic.{name}")
    if name not in _LAZY_NAMES:
        raise AttributeError(f"module kinesic has no attribute {name}")
    module, attribute = _LAZY_NAMES[name]
    return getattr(import_at_once(module), attribute)


def __dir__() -> list[str]:
    return sorted({*__all__, *_LAZY_MODULES})
