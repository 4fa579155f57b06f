"""A live loop without real time: its clock only goes on while it waits, and a script acts between its ticks."""

from collections.abc import Generator, Sequence
from dataclasses import dataclass, field, fields
from multiprocessing import Pipe
from multiprocessing.connection import Connection

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.command import Command
from kinesic.motion.easing import minimum_jerk
from kinesic.motion.trajectory import STEP, Trajectory
from kinesic.planning.setup import Setup
from kinesic.realizer.feedback import ScheduledFeedback
from kinesic.serve.loop import Loop
from kinesic.serve.messages import Clock, LoopStart, News, PlannerReady, Proposal, ProposalVerdict, RequestDone
from kinesic.serve.sinks.real_time import RealTimeSink
from kinesic.serve.tracks import Effects

BEGIN = 1000.0  # [s] of the machine's clock
MOST_SLEEPS = 20_000  # of one run; more are a loop without an end
LATE_WAKE = 1e-5  # [s] that each sleep takes longer than asked
READ_TIME = 1e-6  # [s] from one look at the clock to the next
Messages = tuple[ScheduledFeedback, ...]
Script = Generator[float, None, None]  # yields simulated times [s] after the begin, and acts when they come


class Recorder:
    """A sink that keeps all commands, and can fail."""

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
    """A loop, its clock, the planner's end of its pipe, and all that it says."""

    setup: Setup
    time: float = BEGIN  # [s] of the machine's clock
    told: list[tuple[float, str, int]] = field(default_factory=list)  # when [s], message, receiver
    news: list[PlannerReady | RequestDone | None] = field(default_factory=list)
    sleeps: int = 0  # so far
    effects: Effects = field(default_factory=lambda: Effects(face=True))

    def make(self, sinks: Sequence[RealTimeSink] = ()) -> Loop:
        self.clock = Clock()
        self.loop = Loop(
            self.setup,
            sinks,
            self.clock,
            effects=self.effects,
            tell=lambda message, sender: self.told.append((self.now, message, sender)),
            news=self.news.append,
        )
        return self.loop

    @property
    def now(self) -> float:
        """[s] since the begin, whatever the loop's clock says."""
        return self.time - BEGIN

    def link(self, beginning: LoopStart | None = None) -> Connection:
        """Connects a planner that the test plays; its end of the pipe."""
        ours, planner = Pipe()
        self.loop.link(ours, self.loop.beginning() if beginning is None else beginning)
        return planner

    def run(self, script: Script) -> None:
        """Runs the loop in this thread until the script ends."""
        self._script, self._due = script, BEGIN
        self.loop.run()

    def read(self) -> float:
        """Machine's clock [s]; a little time passes from one look to the next."""
        self.time += READ_TIME
        return self.time

    def sleep(self, seconds: float) -> None:
        """Let time pass, at most until the script acts."""
        self.sleeps += 1
        assert self.sleeps < MOST_SLEEPS, "the loop never comes to its end"
        self.time += max(0.0, min(seconds, self._due - self.time)) + LATE_WAKE
        while self.time >= self._due:
            try:
                self._due = BEGIN + next(self._script)
            except StopIteration:
                self.loop.leave()
                self._due = np.inf

    def wait(self, pipes: Sequence[Connection], seconds: float) -> list[Connection]:
        """As `multiprocessing.connection.wait`, in simulated time."""
        if not any(pipe.poll(0) for pipe in pipes):
            self.sleep(seconds)
        return [pipe for pipe in pipes if pipe.poll(0)]


def proposal(
    stops: int = 0, now: float = 0.0, cut: float = 0.0, *, said: Messages = (), agenda: Messages = (), **parts: object
) -> Proposal:
    """A proposal that changes nothing, but for some parts; `said` comes in no later one."""
    known = {each.name for each in fields(Proposal)}
    feedback = {"said": said, "agenda": agenda} if "said" in known else {"agenda": (*said, *agenda)}
    empty = {"motion": None, "owed": frozenset(), "moving": {}, "tracks": {}}
    return Proposal(stops, now, cut, **empty | feedback | parts)


def feedback_of(proposed: Proposal) -> Messages:
    """All messages of a proposal."""
    return (*getattr(proposed, "said", ()), *proposed.agenda)


def verdict(planner: Connection) -> ProposalVerdict:
    """What the loop said last of a proposal."""
    answer = None
    while planner.poll(0):
        said: News = planner.recv()
        answer = said if isinstance(said, ProposalVerdict) else answer
    assert answer is not None, "no verdict has come"
    return answer


def nod(setup: Setup, begin: float, seconds: float = 2.0, turn: float = 0.3) -> Trajectory:
    """A motion from rest within the limits: all hinges turn inwards, which begins at a time [s] of the clock."""
    rest, limits = setup.robot.skeleton.rest, setup.limits
    inwards = np.where(rest < (limits.lower + limits.upper) / 2, turn, -turn)
    rising = minimum_jerk(np.linspace(0.0, 1.0, round(seconds / STEP)))
    shares = np.concatenate([np.zeros(3), rising, np.ones(3)])
    return Trajectory(sealed(rest + shares[:, None] * inwards), 0.0, begin)
