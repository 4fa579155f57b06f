"""Stand-in for the base classes of lerobot.robots, written from its guide to own hardware."""

import abc
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType

import pytest

PLUGIN_FOLDER = Path(__file__).parents[2] / "plugins" / "lerobot_robot_kinesic"


@dataclass(kw_only=True)
class RobotConfig:
    """Options that all robots have."""

    id: str | None = None
    calibration_dir: Path | None = None

    registry = {}  # noqa: RUF012 - shared by all robots

    @classmethod
    def register_subclass(cls, name: str):
        def register(subclass: type) -> type:
            cls.registry[name] = subclass
            return subclass

        return register


class Robot(abc.ABC):
    """Interface of robots."""

    config_class: type[RobotConfig]
    name: str

    def __init__(self, config: RobotConfig) -> None:
        self.id = config.id

    def __str__(self) -> str:
        return f"{self.id} {type(self).__name__}"

    @property
    @abc.abstractmethod
    def observation_features(self) -> dict: ...

    @property
    @abc.abstractmethod
    def action_features(self) -> dict: ...

    @property
    @abc.abstractmethod
    def is_connected(self) -> bool: ...

    @property
    @abc.abstractmethod
    def is_calibrated(self) -> bool: ...

    @abc.abstractmethod
    def connect(self, calibrate: bool = True) -> None: ...

    @abc.abstractmethod
    def calibrate(self) -> None: ...

    @abc.abstractmethod
    def configure(self) -> None: ...

    @abc.abstractmethod
    def get_observation(self) -> dict: ...

    @abc.abstractmethod
    def send_action(self, action: dict) -> dict: ...

    @abc.abstractmethod
    def disconnect(self) -> None: ...


@contextmanager
def provided_lerobot() -> Iterator[None]:
    """Make the stand-in and the plug-in importable within the context."""
    robots = ModuleType("lerobot.robots")
    robots.Robot, robots.RobotConfig = Robot, RobotConfig
    with pytest.MonkeyPatch.context() as patch:
        patch.setitem(sys.modules, "lerobot", ModuleType("lerobot"))
        patch.setitem(sys.modules, "lerobot.robots", robots)
        patch.syspath_prepend(str(PLUGIN_FOLDER))
        yield
