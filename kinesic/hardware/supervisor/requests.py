"""Requests of planner and persons to the supervisor."""

from collections.abc import Callable

from kinesic.hardware.supervisor.channel import PACE_STEPS, STOP_POLICIES, Channel
from kinesic.hardware.supervisor.settings import Policy
from kinesic.hardware.supervisor.state_machine import Event


class Requests:
    """Reader of requests from planner and operator, polled once per cycle."""

    def __init__(self, channel: Channel, planner: Callable[[], bool]) -> None:
        """Start without any request.

        Args:
            channel: channel to the planner.
            planner: returns whether the planner process is alive.
        """
        self._channel, self._planner = channel, planner
        self._halted = self._resumed = self._void = 0  # requests seen so far; releases void by an emergency stop
        self.alone = False  # whether the planner's process is gone
        self.ended = False  # whether the channel holds the last command

    @property
    def release(self) -> bool:
        """Whether a release was requested since the last emergency stop."""
        return self._channel.word("release") > self._void

    @property
    def confirmed(self) -> bool:
        """Whether a person has confirmed to let raised limbs fall."""
        return bool(self._channel.word("confirm"))

    @property
    def pace(self) -> float:
        """Upper limit of the time scale, 0..1, requested by the clearance watch.

        1 without one.
        """
        request = self._channel.word("pace")
        return min(1.0, (request - 1) / PACE_STEPS) if request else 1.0

    def policy(self, usual: Policy) -> Policy:
        """Return the policy of the emergency stop, or the given default."""
        stop = self._channel.word("estop")
        return STOP_POLICIES[stop - 1] if stop else usual

    def look(self) -> None:
        """Check whether the planner is alive and has sent its last command.

        Call it before commands are taken, because the planner reports its end after the last one.
        """
        self.alone = not self._planner()
        self.ended = bool(self._channel.word("ended"))

    def events(self) -> tuple[Event, ...]:
        """Return an emergency stop or resume requested since the last call.

        A resume request is ignored during an emergency stop.
        """
        halted, resumed = self._channel.word("estop"), self._channel.word("resume")
        stops, resumes = halted > self._halted, resumed > self._resumed and not halted
        self._halted, self._resumed = halted, resumed
        if stops:
            self._void = self._channel.word("release")
            return ("estop",)
        return ("resumed",) if resumes else ()
