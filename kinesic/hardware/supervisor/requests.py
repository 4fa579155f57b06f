"""Reads what planner and persons ask of the supervisor, and whether the planner is still there."""

from collections.abc import Callable

from kinesic.hardware.supervisor.channel import PACES, POLICIES, Channel
from kinesic.hardware.supervisor.settings import Policy
from kinesic.hardware.supervisor.state_machine import Event


class Requests:
    """The words of the channel, looked at once a cycle."""

    def __init__(self, channel: Channel, planner: Callable[[], bool]) -> None:
        """Nothing is asked yet; `planner` tells whether its process lives."""
        self._channel, self._planner = channel, planner
        self._halted = self._resumed = self._void = 0  # what was seen; releases that an emergency stop made void
        self.alone = False  # whether the planner's process is gone
        self.ended = False  # whether no command is to follow those that are in the channel

    @property
    def release(self) -> bool:
        """Whether somebody has asked for the end since the last emergency stop."""
        return self._channel.word("release") > self._void

    @property
    def confirmed(self) -> bool:
        """Whether a person lets fall what is raised."""
        return bool(self._channel.word("confirm"))

    @property
    def pace(self) -> float:
        """How fast, 0..1, whoever watches the clearance lets time run; 1 where nobody does."""
        asked = self._channel.word("pace")
        return min(1.0, (asked - 1) / PACES) if asked else 1.0

    def policy(self, usual: Policy) -> Policy:
        """Returns what an emergency stop is to do, if it does not say so itself."""
        stop = self._channel.word("estop")
        return POLICIES[stop - 1] if stop else usual

    def look(self) -> None:
        """Looks at the planner, before commands are taken: it says that it has ended after the last of them."""
        self.alone = not self._planner()
        self.ended = bool(self._channel.word("ended"))

    def events(self) -> tuple[Event, ...]:
        """Returns what was asked since the last call; a stop that still stands makes a consent void."""
        halted, resumed = self._channel.word("estop"), self._channel.word("resume")
        stops, resumes = halted > self._halted, resumed > self._resumed and not halted
        self._halted, self._resumed = halted, resumed
        if stops:
            self._void = self._channel.word("release")
            return ("estop",)
        return ("resumed",) if resumes else ()
