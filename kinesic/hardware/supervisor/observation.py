"""Inputs of the supervisor's state machine, in addition to events."""

from dataclasses import dataclass

from kinesic.hardware.supervisor.settings import Policy


@dataclass(frozen=True)
class Observation:
    """State of servos, planner and requests at one instant."""

    energised: bool = False  # a servo has torque
    answering: bool = True  # every servo has answered recently
    well: bool = True  # every servo answers, has torque, and neither a fault nor overload stops it
    limp: bool = False  # a servo without errors has no torque
    begun: bool = False  # commands were received
    due: bool = False  # enough commands are buffered to continue
    ended: bool = False  # the planner has sent its last command, and no command is left to perform
    alone: bool = False  # the planner process is gone
    release: bool = False  # a release was requested since the last emergency stop
    weak: bool = False  # a servo reports a supply error and no other
    raised: bool = False  # a servo with torque may be away from the rest posture
    confirmed: bool = False  # a person has confirmed to let raised limbs fall
    interrupted: bool = False  # a long interruption has just ended or still lasts
    still: bool = True  # the performance or move has come to a stop (its time no longer advances)
    reached: bool = False  # the current move has ended
    idle: bool = False  # the hold has lasted long enough to fold
    hopeless: bool = False  # a port has been gone for longer than the supervisor waits
    policy: Policy = "hold"  # reaction to an emergency stop

    @property
    def limp_policy(self) -> bool:
        """Whether an emergency stop switches torque off."""
        return self.policy == "limp"
