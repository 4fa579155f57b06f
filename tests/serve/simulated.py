"""Control loop in simulated time, with a script that acts between its ticks."""

from collections.abc import Generator, Sequence
from dataclasses import dataclass, field
from multiprocessing import Pipe
from multiprocessing.connection import Connection

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.command import Command
from kinesic.motion.easing import minimum_jerk
from kinesic.motion.trajectory import KNOT_INTERVAL, Trajectory
from kinesic.planning.setup import Setup
from kinesic.realizer.feedback import ScheduledFeedback
from kinesic.serve.loop import Loop
from kinesic.serve.messages import Clock, LoopStart, News, PlannerReady, Proposal, ProposalVerdict, RequestDone
from kinesic.serve.sinks.real_time import RealTimeSink
from kinesic.serve.tracks import TrackEffects

START_TIME = 1000.0  # [s] monotonic clock time at the start of the simulation
MAX_SLEEPS = 20_000  # largest number of sleeps per run; more indicate an endless loop
WAKE_DELAY = 1e-5  # [s] excess duration of each sleep
READ_TIME = 1e-6  # [s] simulated time between two clock reads
Messages = tuple[ScheduledFeedback, ...]
Script = Generator[
    float, None, None
]  # generator that yields simulated times [s] since the start and acts at these times


class Recorder:
    """Sink that records all commands and can fail."""

    def __init__(self) -> None:
        self.commands: list[Command] = []
        self.closed = 0
        self.fault: Exception | None = None

    def write(self, command: Command, /) -> None:
        if self.fault is not None:
            raise self.fault
        self.commands.append(command)

    def close(self) -> None:
        self.closed += 1

    @property
    def times(self) -> list[float]:
        return [command.time for command in self.commands]

    @property
    def angles(self) -> Floats:
        return np.array([command.angles for command in self.commands])


@dataclass
class Simulation:
    """Loop with its clock, the planner's pipe end and a record of its messages."""

    setup: Setup
    time: float = START_TIME  # [s] monotonic clock time
    told: list[tuple[float, str, int]] = field(default_factory=list)  # tuples of time [s], message and receiver
    news: list[PlannerReady | RequestDone | None] = field(default_factory=list)
    sleeps: int = 0  # number of sleeps until now
    effects: TrackEffects = field(default_factory=lambda: TrackEffects(face=True))

    def make(self, sinks: Sequence[RealTimeSink] = ()) -> Loop:
        self.clock = Clock()
        self.loop = Loop(
            self.setup,
            sinks,
            self.clock,
            effects=self.effects,
            send_feedback=lambda message, sender: self.told.append((self.now, message, sender)),
            notify_server=self.news.append,
        )
        return self.loop

    @property
    def now(self) -> float:
        """Simulated time [s] since the start, independent of the loop's clock."""
        return self.time - START_TIME

    def link(self, beginning: LoopStart | None = None) -> Connection:
        """Connect a planner simulated by the test, and return its pipe end."""
        ours, planner = Pipe()
        self.loop.connect_planner(ours, self.loop.snapshot() if beginning is None else beginning)
        return planner

    def run(self, script: Script) -> None:
        """Run the loop in this thread until the script ends."""
        self._script, self._due = script, START_TIME
        self.loop.run()

    def read(self) -> float:
        """Return the monotonic clock time [s], which advances slightly at each call."""
        self.time += READ_TIME
        return self.time

    def sleep(self, seconds: float) -> None:
        """Advance the time, at most until the script acts."""
        self.sleeps += 1
        assert self.sleeps < MAX_SLEEPS, "the loop never comes to its end"
        self.time += max(0.0, min(seconds, self._due - self.time)) + WAKE_DELAY
        while self.time >= self._due:
            try:
                self._due = START_TIME + next(self._script)
            except StopIteration:
                self.loop.shut_down()
                self._due = np.inf

    def wait(self, pipes: Sequence[Connection], seconds: float) -> list[Connection]:
        """Simulate `multiprocessing.connection.wait`."""
        if not any(pipe.poll(0) for pipe in pipes):
            self.sleep(seconds)
        return [pipe for pipe in pipes if pipe.poll(0)]


def proposal(
    stops: int = 0, now: float = 0.0, cut: float = 0.0, *, final: Messages = (), agenda: Messages = (), **parts: object
) -> Proposal:
    """Return a proposal that changes only the given parts."""
    feedback = {"final_feedback": final, "agenda": agenda}
    empty = {"motion": None, "owed": frozenset(), "moving": {}, "tracks": {}}
    return Proposal(stops, now, cut, **empty | feedback | parts)


def feedback_of(proposed: Proposal) -> Messages:
    """Return all messages of a proposal."""
    return (*proposed.final_feedback, *proposed.agenda)


def verdict(planner: Connection) -> ProposalVerdict:
    """Return the loop's last verdict."""
    answer = None
    while planner.poll(0):
        said: News = planner.recv()
        answer = said if isinstance(said, ProposalVerdict) else answer
    assert answer is not None, "no verdict has come"
    return answer


def nod(setup: Setup, begin: float, seconds: float = 2.0, turn: float = 0.3) -> Trajectory:
    """Return a motion of all hinges from rest, starting at a clock time [s]."""
    rest, limits = setup.robot.skeleton.rest, setup.limits
    inwards = np.where(rest < (limits.lower + limits.upper) / 2, turn, -turn)
    rising = minimum_jerk(np.linspace(0.0, 1.0, round(seconds / KNOT_INTERVAL)))
    shares = np.concatenate([np.zeros(3), rising, np.ones(3)])
    return Trajectory(sealed(rest + shares[:, None] * inwards), 0.0, begin)
