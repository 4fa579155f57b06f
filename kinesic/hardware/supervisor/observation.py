"""Says what the state machine is told besides events: what is known of servos, planner and persons at one instant."""

from dataclasses import dataclass

from kinesic.hardware.supervisor.settings import Policy


@dataclass(frozen=True)
class Observation:
    """What is known from outside at this instant."""

    energised: bool = False  # some servo has torque
    answering: bool = True  # every servo has answered lately
    well: bool = True  # every servo has torque, answers, and may go on
    limp: bool = False  # some servo that could have torque has none
    begun: bool = False  # there is, or was, something to perform
    due: bool = False  # there is something to perform now, enough ahead
    ended: bool = False  # the planner will send nothing more, and all it sent has been performed or is void
    alone: bool = False  # the planner's process is gone
    release: bool = False  # asked to fold and release, since the last emergency stop
    weak: bool = False  # a servo complains of its supply, and of nothing else
    raised: bool = False  # some servo has torque, or may have, and is not near rest
    confirmed: bool = False  # a person lets fall what is raised
    interrupted: bool = False  # until now, the servos were out of hand for long
    still: bool = True  # time stands
    reached: bool = False  # the end of the present move
    idle: bool = False  # held for so long that it may fold
    hopeless: bool = False  # a port is gone for so long that it will not come back
    policy: Policy = "hold"  # at an emergency stop

    @property
    def over(self) -> bool:
        """Whether the performance is to end."""
        return self.ended or self.release or self.weak or self.confirmed

    @property
    def dismissed(self) -> bool:
        """Whether an emergency stop holds no longer: somebody wants the end, or nobody is there who could."""
        return self.release or self.confirmed or self.alone
