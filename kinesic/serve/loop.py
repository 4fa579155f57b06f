"""The live loop: a thread that hands a command to every sink 100 times a second, whatever else goes on.

It only swaps trajectories and agendas that the planner proposes, and refuses what comes too late or would be a step.
An emergency stop is its own work: it needs no planner.
"""

from collections import deque
from collections.abc import Callable, Mapping, Sequence
from contextlib import ExitStack, suppress
from math import isnan
from multiprocessing.connection import Connection, wait
from operator import attrgetter
from threading import Event, Thread
from time import monotonic, sleep

from kinesic.body.arrays import Flags
from kinesic.body.command import RATE
from kinesic.body.limits import Limits
from kinesic.controller.play import SETTLE
from kinesic.face.display import DisplayError
from kinesic.hardware.protocol.wire import BusError
from kinesic.motion.stopping import stop
from kinesic.motion.trajectory import Trajectory, stay
from kinesic.planning.setup import Setup
from kinesic.realizer.realizer import ScheduledFeedback
from kinesic.serve.arrival_monitor import ArrivalMonitor
from kinesic.serve.clock import Clock
from kinesic.serve.messages import (
    FeedbackNotice,
    Halted,
    LoopStart,
    PlannerReady,
    Proposal,
    ProposalVerdict,
    RequestDone,
)
from kinesic.serve.sinks import MeasuringSink, ServoSink, TimedSink, steady
from kinesic.serve.tracks import Effects

PERIOD = 1 / RATE
GRACE = 0.03  # [s] in which the way to rest is found, while the motion goes on
PATIENCE = 0.1  # [s] that a message waits for the body to be seen where it is to be
HICCUP = 0.25  # [s] by which the loop may be late; beyond, time has stood still


class Loop(Thread):
    """What is played, what is to be told, and who follows."""

    def __init__(
        self,
        setup: Setup,
        followers: Sequence[ServoSink],
        clock: Clock,
        *,
        effects: Effects,
        tell: Callable[[str, int], None],
        news: Callable[[PlannerReady | RequestDone | None], None],
    ) -> None:
        """Not running yet.

        Args:
            setup: robot, dynamics, limits.
            followers: sinks; closed at the end.
            clock: set here alone.
            effects: what is seen and heard beside the motion.
            tell: is given what a sender is to be told.
            news: is given what the planner says to the server; None when it is gone.
        """
        super().__init__(name="loop")
        self.motion = stay(setup.robot.skeleton.rest, start=clock.now())  # on the clock
        self.agenda: list[ScheduledFeedback] = []
        self.stops, self._done = 0, 0  # emergency stops that were asked for, and those that were made
        self.halted = False  # whether the last one still holds
        self.late = 0  # ticks that came more than a period late
        self.failed = False  # whether it ended by itself
        self.error: BusError | DisplayError | None = None  # why
        self._owed: frozenset[int] = frozenset()  # senders whose blocks are not over
        self._setup, self._followers, self._clock = setup, followers, clock
        self._tell, self._news, self._effects = tell, news, effects
        self._told: set[ScheduledFeedback] = set()  # that the planner may propose again
        self._moving: Mapping[tuple[str, str], Flags] = {}
        self._gauge = ArrivalMonitor()
        self._body = next((each.sink for each in reversed(followers) if isinstance(each.sink, MeasuringSink)), None)
        self._orders: deque[Callable[[], None]] = deque()
        self._mail: Connection | None = None
        self._out = clock.now()  # [s] until when commands are out
        self._leave = Event()

    def link(self, mail: Connection, beginning: LoopStart) -> None:
        """Listens from the next tick on to a planner, which knows the motion as it was at its beginning."""
        self._orders.append(lambda: self._link(mail, beginning.stops))

    def halt(self) -> None:
        """Emergency stop: to rest in the least time, and nothing more to tell. Never waits.

        It counts at once: whoever resumes before the next tick means this stop.
        """
        self.stops += 1
        self._orders.appendleft(self._halt)

    def leave(self) -> None:
        """Ends after the present tick."""
        self._leave.set()

    def beginning(self) -> LoopStart:
        """Where a planner takes over."""
        return LoopStart(self.motion, self._done, tuple(self.agenda), self._effects.senses)

    def owes(self, sender: int) -> bool:
        """Whether a block of a sender's is not over, or something is still to be told of it."""
        return sender in self._owed or any(due.sender == sender for due in tuple(self.agenda))

    def settled(self) -> bool:
        """Whether nothing moves and nothing is to be told."""
        return not self.agenda and self._out > self.motion.end + SETTLE

    def run(self) -> None:
        """Until told to leave, or a sink fails."""
        self.failed = True
        try:
            with ExitStack() as closing:
                for follower in self._followers:
                    closing.callback(follower.sink.close)
                while not self._leave.is_set():
                    self._tick()
                    self._listen(monotonic() + PERIOD - self._clock.now() % PERIOD)
                self.failed = False
        except (BusError, DisplayError) as error:
            self.failed, self.error = True, error
        finally:
            self._leave.set()

    def _tick(self) -> None:
        while self._orders:
            self._orders.popleft()()
        now = self._now()
        self.late += now - self._out > 2 * PERIOD
        for follower in self._followers:
            follower.follow(self.motion, now, self._setup, self._effects.face)
        self._out = max(self._out, now)
        if self._body is not None and (seen := self._body.seen()) is not None:
            self._gauge.add(*seen)
        while self.agenda and self.agenda[0].time <= now:
            told = self._measured(self.agenda[0], now)
            if told is None:
                break
            self._told.add(self.agenda.pop(0))
            self._tell(told.xml, told.sender)

    def _measured(self, due: ScheduledFeedback, now: float) -> ScheduledFeedback | None:
        """With the time at which the body was there, where that can be told; None: it is worth waiting a little."""
        point = due.content
        if self._body is None or isinstance(point, str) or point.behaviour is None:
            return due
        hinges = self._moving.get((point.block, point.behaviour))
        if hinges is None or not hinges.any():
            return due
        late = self._gauge.lateness(due.time, hinges, self.motion)
        if late is None and now < due.time + PATIENCE:
            return None
        return due if late is None or isnan(late) else due.measured_at(due.time + late)

    def _now(self) -> float:
        """[s] now, by a sink that owns the time, if there is one; never before what is out."""
        clocks = [follower.sink for follower in self._followers if isinstance(follower.sink, TimedSink)]
        if clocks:
            told = clocks[0].time(monotonic())
            self._clock.set(self._out if told is None else max(self._out, told))
        elif self._clock.now() - self._out > HICCUP:
            self._clock.set(self._out + PERIOD)
        return self._clock.now()

    def _listen(self, until: float) -> None:
        """Reads what the planner sends, until a time [s] of the machine's monotonic clock."""
        while (left := until - monotonic()) > 0.0:
            mail = self._mail
            if mail is None:
                sleep(left)
                return
            try:
                if wait([mail], left):
                    self._heard(mail.recv(), mail)
            except (EOFError, OSError):
                self._mail = None
                self._news(None)

    def _heard(self, message: PlannerReady | FeedbackNotice | RequestDone | Proposal, mail: Connection) -> None:
        match message:
            case Proposal():
                mail.send(ProposalVerdict(self._taken(message), self.stops, self._out))
            case FeedbackNotice():
                self._tell(message.message, message.sender)
            case _:
                self._news(message)

    def _taken(self, proposal: Proposal) -> bool:
        """Takes what the planner proposes, unless it comes too late or would be a step."""
        if proposal.stops != self.stops:
            return False
        if proposal.motion is not None:
            if proposal.cut < self._out or not steady(self.motion, proposal.motion, self._out):
                return False
            self._play(proposal.motion, proposal.cut)
            self.halted = False
        self.agenda = sorted((due for due in proposal.agenda if due not in self._told), key=attrgetter("time"))
        self._told = {due for due in self._told if due.time > proposal.now}
        self._owed, self._moving = proposal.owed, proposal.moving
        self._effects.take(proposal.tracks)
        return True

    def _play(self, motion: Trajectory, cut: float) -> None:
        self.motion = motion
        for follower in self._followers:
            follower.again(max(cut, self._out + PERIOD / 2))

    def _link(self, mail: Connection, stops: int) -> None:
        self._mail = mail
        if stops != self._done:
            self._tell_halt(self._out)

    def _halt(self) -> None:
        if self._done == self.stops:
            return
        self._done, self.halted = self.stops, True
        time = self._out + GRACE
        self._play(_halt(self.motion, time, self._setup.limits), time)
        self.agenda, self._told = [], set()
        self._effects.clear()
        self._tell_halt(time)

    def _tell_halt(self, time: float) -> None:
        """Tells the planner what plays since the last emergency stop, from a time [s] of the clock."""
        if self._mail is not None:
            with suppress(OSError):  # it has died, and the next one begins from here
                self._mail.send(Halted(self._done, time, self.motion))


def _halt(motion: Trajectory, time: float, limits: Limits) -> Trajectory:
    """To rest from a time [s] of the clock, without what is past."""
    return stop(motion, time, limits).since(time - GRACE)
