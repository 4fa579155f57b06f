"""Settings of a supervisor, and the startup data of its process."""

from dataclasses import dataclass
from typing import Literal

import msgspec

from kinesic.hardware.protocol.registers import WATCHDOG_UNIT

Policy = Literal["hold", "limp"]


@dataclass(frozen=True)
class SupervisorSettings:
    """Timing, velocity and emergency stop settings of the supervisor.

    Times in seconds unless a unit is given.
    """

    period: float = 0.01  # cycle period
    watchdog: float = 0.1  # time without bytes after which a servo stops by itself
    patient_watchdog: float = 0.2  # watchdog time on a host without real-time scheduling
    lead: float = 0.5  # duration of buffered commands that is required before performance time runs
    slow: float = 0.4  # normal time to stop or start performance time
    quick: float = 0.06  # time to stop if the planner is gone, or at an emergency stop
    wary: float = 0.2  # time to stop if the clearance gets too small
    patience: float = 5.0  # time of holding without commands until the robot moves to rest
    startle: float = 0.85  # longest interruption without a resume request; detection and visible motion take 0.1 s more
    consent: float = 60.0  # longest wait for a person's resume request, until the performance ends
    hopeless: float = 20.0  # time without a port until the supervisor gives up
    pace: float = 0.7  # [rad/s] largest joint velocity of moves to rest or to the performance
    policy: Policy = "hold"  # reaction to an emergency stop

    def __post_init__(self) -> None:
        for name in ("period", "watchdog", "patient_watchdog", "lead", "slow", "quick", "wary", "pace"):
            if getattr(self, name) <= 0.0:
                raise ValueError(f"{name} is {getattr(self, name)}, must be > 0")
        for name in ("watchdog", "patient_watchdog"):
            if not 2 * self.period <= getattr(self, name) <= 127 * WATCHDOG_UNIT:
                bounds = f"{2 * self.period:g}..{127 * WATCHDOG_UNIT:g}"
                raise ValueError(f"{name} is {getattr(self, name)} s, must be {bounds} at a period of {self.period} s")


DEFAULT_SETTINGS = SupervisorSettings()  # Settings without changes by the user


class SupervisorOrder(msgspec.Struct, forbid_unknown_fields=True):
    """Startup data of a supervisor process: robot, ports, memory, settings, log."""

    robot: str  # path of the robot file
    ports: dict[str, str]  # bus name -> path of the serial port
    memory: int  # file descriptor of the memory shared with the planner
    settings: SupervisorSettings
    log: str | None = None  # path of the event log
