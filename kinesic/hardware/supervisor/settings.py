"""What a supervisor is started with: the figures by which it acts, and the order that its process gets."""

from dataclasses import dataclass
from typing import Literal

import msgspec

from kinesic.hardware.protocol.registers import WATCHDOG

Policy = Literal["hold", "limp"]


@dataclass(frozen=True)
class SupervisorSettings:
    """Figures by which the supervisor acts: times in seconds, except where a unit is named."""

    period: float = 0.01  # of cycles
    watchdog: float = 0.1  # without bytes after which a servo stops by itself
    patient_watchdog: float = 0.2  # the same on a host that grants no real time
    lead: float = 0.5  # of commands that must be there before time runs
    slow: float = 0.4  # in which time comes to a stop, or up to speed, when there is no hurry
    quick: float = 0.06  # in which it stops when the planner is gone, or at an emergency stop
    wary: float = 0.2  # in which it stops where the clearance goes
    patience: float = 5.0  # of holding without anything to perform before it folds
    startle: float = 0.85  # of an interruption that goes on by itself: it is seen, and motion to be seen, 0.1 s later
    consent: float = 60.0  # of waiting for consent, folded, before a performance is ended
    hopeless: float = 20.0  # without a port after which it gives up
    pace: float = 0.7  # [rad/s] of moves that nobody has planned: to rest, to the first command
    policy: Policy = "hold"  # what an emergency stop does

    def __post_init__(self) -> None:
        for name in ("period", "watchdog", "patient_watchdog", "lead", "slow", "quick", "wary", "pace"):
            if getattr(self, name) <= 0.0:
                raise ValueError(f"{name} is {getattr(self, name)}, must be > 0")
        for name in ("watchdog", "patient_watchdog"):
            if not 2 * self.period <= getattr(self, name) <= 127 * WATCHDOG:
                bounds = f"{2 * self.period:g}..{127 * WATCHDOG:g}"
                raise ValueError(f"{name} is {getattr(self, name)} s, must be {bounds} at a period of {self.period} s")


USUAL = SupervisorSettings()


class SupervisorOrder(msgspec.Struct, forbid_unknown_fields=True):
    """What a supervisor is started for."""

    robot: str  # path of its file
    ports: dict[str, str]  # bus -> path of the device
    memory: int  # descriptor of the channel's memory
    settings: SupervisorSettings
    log: str | None = None  # path of the journal
