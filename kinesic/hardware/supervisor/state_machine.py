"""Stages, events, actions and flags of the supervisor's state machine."""

from dataclasses import dataclass
from enum import Enum
from typing import Literal


class Stage(Enum):
    """Operating stage of the supervisor, a state of its state machine."""

    CLOSED = "closed"  # no port is open
    PROBE = "probe"  # the supervisor compares the servos with the manifest
    CONFIGURE = "configure"  # the supervisor sets the registers, without torque
    LIMP = "limp"  # the registers are set, and the torque is off
    ARM = "arm"  # torque is switched on at the current positions, with low power first
    HOLD = "hold"  # the goals do not change
    APPROACH = "approach"  # the robot moves to the current point of the performance
    ACTIVE = "active"  # performance time runs
    DEGRADED = "degraded"  # performance time decelerates to a stop
    FOLD = "fold"  # the robot moves to the rest posture
    WAITING = "waiting"  # a raised limb cannot move to rest, and is held until it can, or until a person lets it fall
    RELEASE = "release"  # torque is switched off
    STOPPED = "stopped"  # emergency stop: the robot holds until a person resumes or ends the performance
    LOST = "lost"  # a port is gone; its servos stop by themselves
    IDENTIFY = "identify"  # the supervisor identifies the servos behind a reopened port
    ADOPT = "adopt"  # the supervisor takes over servos with torque at their positions

    @property
    def runs(self) -> bool:
        """Whether performance time runs or decelerates."""
        return self in (Stage.ACTIVE, Stage.DEGRADED)


Event = Literal[
    "tick",  # no event besides the observation
    "open",  # opening the ports was requested
    "done",  # the procedure of the stage has succeeded
    "refused",  # the procedure of the stage has failed
    "estop",  # an emergency stop was requested
    "lost",  # a port is gone
    "back",  # all ports are open again
    "tripped",  # a bus watchdog has stopped servos
    "failed",  # a servo has shut down or is blocked
    "mended",  # a servo that failed or was silent works again
    "resumed",  # a person or client has requested to continue
]

Action = Literal[
    "check",  # compare the servos with the manifest
    "configure",  # set the registers
    "arm",  # switch torque on at the current positions
    "identify",  # identify the servos behind a reopened port
    "adopt",  # take over servos with torque at their positions
    "hold",  # keep the current goals
    "approach",  # move to the current point of the performance
    "follow",  # play the performance
    "slow",  # decelerate to a stop
    "fold",  # move to the rest posture
    "release",  # switch torque off
    "close",  # close the ports; torque does not change
]

Awaited = Literal["nothing", "commands", "servos", "port", "consent", "confirmation"]


@dataclass(frozen=True)
class SupervisorState:
    """Stage of the supervisor, and the data kept across stages."""

    stage: Stage = Stage.CLOSED
    checked: bool = False  # the servos match the manifest
    powered: bool = False  # torque has been switched on, or was on before
    armed: bool = False  # all servos have had torque, so that interruptions count from now on
    stopped: bool = False  # an emergency stop is active
    paused: bool = False  # after an emergency stop or long interruption, the motion continues only on a resume request
    faulty: bool = False  # a servo has failed, and the performance has ended
    refused: bool = False  # torque could not be switched on; the supervisor does not try again until a servo recovers
    careful: bool = False  # the supervisor holds before it moves to rest, because a blocked limb may come free
    folded: bool = False  # the robot has moved to rest since the last performance
    approaching: bool = False  # the stage `degraded` began during `approach`


POWERED_STAGES = frozenset(Stage) - {Stage.CLOSED, Stage.PROBE, Stage.CONFIGURE, Stage.LIMP, Stage.RELEASE}
"""Stages in which servos may have torque."""

MOVING_STAGES = frozenset({Stage.APPROACH, Stage.ACTIVE, Stage.FOLD})  # Stages in which a move or performance runs
