"""The live loop: a thread that hands a command to every sink 100 times a second, whatever else goes on.

It only swaps trajectories and agendas that the planner proposes, and refuses what comes too late or would be a step.
An emergency stop needs no planner.
"""

from collections import deque
from collections.abc import Callable, Mapping, Sequence
from contextlib import ExitStack, suppress
from math import inf, isnan
from multiprocessing.connection import Connection, wait
from operator import attrgetter
from select import POLLOUT, poll
from threading import Event, Thread
from time import monotonic, sleep

import numpy as np

from kinesic.body.arrays import Flags
from kinesic.body.command import RATE
from kinesic.controller.play import SETTLE
from kinesic.face.display import DisplayError
from kinesic.hardware.protocol.wire import BusError
from kinesic.motion.stopping import stop
from kinesic.motion.trajectory import STEP, Trajectory, stay
from kinesic.planning.setup import Setup
from kinesic.realizer.realizer import ScheduledFeedback
from kinesic.serve.arrival_monitor import ArrivalMonitor
from kinesic.serve.messages import (
    BodyReport,
    Clock,
    FeedbackNotice,
    Halted,
    LoopProperties,
    LoopStart,
    PlannerReady,
    Proposal,
    ProposalVerdict,
    RequestDone,
)
from kinesic.serve.priority import urgent
from kinesic.serve.sinks.real_time import ConsentingSink, MeasuringSink, RealTimeSink, ServoSink, TimedSink, is_steady
from kinesic.serve.tracks import Effects

PERIOD = 1 / RATE
GRACE = 0.03  # [s] in which the way to rest is found, while the motion goes on
PATIENCE = 0.1  # [s] that a message waits for the body to arrive
REHEARSED = 0.1  # share of the greatest speed at which a stop is rehearsed
HICCUP = 0.25  # [s] by which the loop may be late; beyond, time has stood still


class Loop(Thread):
    """Plays a motion on all sinks, and sends feedback when it is due."""

    def __init__(
        self,
        setup: Setup,
        sinks: Sequence[RealTimeSink],
        clock: Clock,
        *,
        effects: Effects,
        tell: Callable[[str, int], None],
        news: Callable[[PlannerReady | RequestDone | None], None],
    ) -> None:
        """Not running yet.

        Args:
            setup: robot, dynamics, limits.
            sinks: closed at the end.
            clock: set here alone.
            effects: faces and sounds beside the motion.
            tell: is given a message and the number of its receiver.
            news: is given what the planner says to the server; None when it is gone.
        """
        super().__init__(name="loop")
        self.robot = setup.robot.name
        self.motion = stay(setup.robot.skeleton.rest, start=clock.now())  # on the clock
        self.agenda: list[ScheduledFeedback] = []
        self.stops, self._stops_made = 0, 0  # emergency stops that were requested, and those that were made
        self.halted = False  # whether the last one still holds
        self.idles = False  # whether the motion is nothing but idle motion
        self.late = 0  # ticks that came more than a period late
        self.failed = False  # whether it ended by itself
        self.error: BusError | DisplayError | None = None  # why
        self._owed: frozenset[int] = frozenset()  # senders whose blocks are not over
        self._setup, self._sinks, self._clock = setup, sinks, clock
        self._tell, self._news, self._effects = tell, news, effects
        self._sent: set[ScheduledFeedback] = set()  # that the planner may propose again
        self._final = -inf  # [s] no later proposal has what is due until then
        self._moving: Mapping[tuple[str, str], Flags] = {}
        self._monitor = ArrivalMonitor()
        self._body = next((each.sink for each in reversed(sinks) if isinstance(each.sink, MeasuringSink)), None)
        self.servos = next((each.sink for each in sinks if isinstance(each.sink, ServoSink)), None)
        self._consenting = [each.sink for each in sinks if isinstance(each.sink, ConsentingSink)]
        self._orders: deque[Callable[[], None]] = deque()
        self._planner: Connection | None = None
        self._untold: Halted | None = None  # the last stop, until the planner is told
        self._out = clock.now()  # [s] until when commands are out
        self._leave = Event()
        _rehearse_stop(setup)

    def link(self, planner: Connection, beginning: LoopStart) -> None:
        """Connects a planner from the next tick on; it was started with this state of the loop."""
        self._orders.append(lambda: self._link(planner, beginning.stops))

    def halt(self) -> None:
        """Makes an emergency stop, from any thread: comes to rest in the least time, drops all feedback, never waits.

        It counts at once: whoever resumes before the next tick means this stop. Two at the same time may count as one.
        """
        self.stops += 1
        self._orders.appendleft(self._halt)

    def waits(self) -> bool:
        """Whether a sink holds until a client consents."""
        return any(each.waits() for each in self._consenting)

    def resume(self) -> None:
        """Lets all sinks go on that wait for consent."""
        for each in self._consenting:
            each.resume()

    def leave(self) -> None:
        """Ends after the present tick."""
        self._leave.set()

    def beginning(self) -> LoopStart:
        """The state from which a planner takes over."""
        return LoopStart(self.motion, self._stops_made, tuple(self.agenda))

    @property
    def properties(self) -> LoopProperties:
        """What planners are told before they take over."""
        return LoopProperties(self._clock, self._effects.accompaniment)

    def owes(self, sender: int) -> bool:
        """Whether a block of a client's is not over, or feedback of it is still to be sent."""
        return sender in self._owed or any(message.sender == sender for message in tuple(self.agenda))

    def body(self) -> BodyReport:
        """How the robot is now, from any thread: by the sink that the loop measures by, where it knows."""
        time = self._clock.now()
        seen = None if self._body is None else self._body.seen()
        planned = self.motion.sample(np.array([time]))[0][0]
        health = None if self.servos is None else self.servos.health()
        return BodyReport.of(time, planned, None if seen is None else seen[1], health)

    def arm(self) -> None:
        """Lets servos follow from the next tick on; they begin with the motion as it is then."""
        self._orders.append(self._arm)

    def _arm(self) -> None:
        if self.servos is not None:
            self.servos.arm()
            for each in self._sinks:
                each.repeat_from(self._out)

    def settled(self) -> bool:
        """Whether nothing moves and no feedback is to be sent."""
        return not self.agenda and self._out > self.motion.end + SETTLE

    def run(self) -> None:
        """Ticks until it is to leave, or a sink fails."""
        self.failed = True
        try:
            with urgent(), ExitStack() as closing:
                for each in self._sinks:
                    closing.callback(each.sink.close)
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
        self._tell_planner()
        now = self._now()
        self.late += now - self._out > 2 * PERIOD
        for each in self._sinks:
            each.follow(self.motion, now, self._setup, self._effects.face)
        self._out = max(self._out, now)
        if self._body is not None and (seen := self._body.seen()) is not None:
            self._monitor.add(*seen)
        while self.agenda and self.agenda[0].time <= now:
            message = self._measured(self.agenda[0], now)
            if message is None:
                break
            self._sent.add(self.agenda.pop(0))
            self._tell(message.xml, message.sender)

    def _measured(self, message: ScheduledFeedback, now: float) -> ScheduledFeedback | None:
        """Adds the time at which the body was there, where that is known; None: it is worth waiting a little."""
        point = message.content
        if self._body is None or isinstance(point, str) or point.behaviour is None:
            return message
        hinges = self._moving.get((point.block, point.behaviour))
        if hinges is None or not hinges.any():
            return message
        late = self._monitor.lateness(message.time, hinges, self.motion)
        if late is None and now < message.time + PATIENCE:
            return None
        return message if late is None or isnan(late) else message.measured_at(message.time + late)

    def _now(self) -> float:
        """Present time [s], by a sink that owns it, if there is one; never before commands that are out."""
        limp = self.servos is not None and not self.servos.armed
        clocks = [each.sink for each in self._sinks if isinstance(each.sink, TimedSink)]
        if clocks and not limp:
            time = clocks[0].time(monotonic())
            self._clock.set(self._out if time is None else max(self._out, time))
        elif self._clock.now() - self._out > HICCUP:
            self._clock.set(self._out + PERIOD)
        return self._clock.now()

    def _listen(self, until: float) -> None:
        """Receives from the planner until a time [s] of the machine's monotonic clock."""
        while (left := until - monotonic()) > 0.0:
            planner = self._planner
            if planner is None:
                sleep(left)
                return
            try:
                if wait([planner], left):
                    self._receive(planner.recv(), planner)
            except (EOFError, OSError):
                self._planner = None
                self._news(None)

    def _receive(self, message: PlannerReady | FeedbackNotice | RequestDone | Proposal, planner: Connection) -> None:
        match message:
            case Proposal():
                planner.send(ProposalVerdict(self._accept(message), self.stops, self._out))
            case FeedbackNotice():
                self._tell(message.message, message.sender)
            case _:
                self._news(message)

    def _accept(self, proposal: Proposal) -> bool:
        """Takes what the planner proposes, unless it comes too late or would be a step."""
        if proposal.stops != self.stops:
            return False
        if proposal.motion is not None:
            if proposal.cut < self._out or not is_steady(self.motion, proposal.motion, self._out):
                return False
            self._play(proposal.motion, proposal.cut)
            self.halted = False
        waiting = (message for message in self.agenda if message.time <= self._final)
        unsent = dict.fromkeys(message for message in (*waiting, *proposal.agenda) if message not in self._sent)
        self.agenda, self._final = sorted(unsent, key=attrgetter("time")), proposal.now
        self._sent = {message for message in self._sent if message.time > proposal.now}
        self._owed, self._moving, self.idles = proposal.owed, proposal.moving, proposal.idles
        self._effects.take(proposal.tracks)
        return True

    def _play(self, motion: Trajectory, cut: float) -> None:
        self.motion = motion
        for each in self._sinks:
            each.repeat_from(max(cut, self._out + PERIOD / 2))

    def _link(self, planner: Connection, stops: int) -> None:
        self._planner, self._untold = planner, None
        if stops != self._stops_made:
            self._tell_halt(self._out)

    def _halt(self) -> None:
        if self._stops_made == self.stops:
            return
        self._stops_made, self.halted = self.stops, True
        time = self._out + GRACE
        self._play(stop(self.motion, time, self._setup.limits).since(time - GRACE), time)
        self.agenda, self._sent = [], set()
        self._effects.clear()
        self._tell_halt(time)

    def _tell_halt(self, time: float) -> None:
        """Has the planner told the motion of the last emergency stop, which began at a time [s] of the clock."""
        self._untold = Halted(self._stops_made, time, self.motion)

    def _tell_planner(self) -> None:
        """Sends the planner the last stop as soon as it reads: the loop waits for nobody, however many stops come."""
        if self._untold is None or (self._planner is not None and not _takes_more(self._planner)):
            return
        if self._planner is not None:
            with suppress(OSError):  # it has died, and the next one begins from here
                self._planner.send(self._untold)
        self._untold = None


def _takes_more(pipe: Connection) -> bool:
    """Whether a message of some kB can be sent without waiting: at least three quarters of its buffer are free."""
    waiting = poll()
    waiting.register(pipe, POLLOUT)
    return bool(waiting.poll(0))


def _rehearse_stop(setup: Setup) -> None:
    """Makes one stop that nobody plays: the first one loads a solver, which takes longer than a stop may."""
    limits, rest = setup.limits, setup.robot.skeleton.rest
    rising = np.cumsum(np.linspace(0.0, REHEARSED, 30))[:, None] * STEP * limits.speed
    inwards = np.where(rest < (limits.lower + limits.upper) / 2, 1.0, -1.0)
    moving = Trajectory(rest + inwards * rising, 0.0)
    stop(moving, moving.duration / 2, limits)
