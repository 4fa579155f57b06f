"""Performs a plan on the robot: hands its goals to the servos, and keeps what their supervisor reports.

All commands are handed over at once: the supervisor keeps them, owns the time from then on, and folds the robot to
rest at the end. Here is only listened, and handed on what somebody at the keyboard wants.
"""

import signal
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cached_property
from types import FrameType
from typing import Literal

import numpy as np

from kinesic.body.arrays import Flags, Floats, sealed
from kinesic.controller.arrival import lags, part_paths
from kinesic.controller.feedforward import FeedForward
from kinesic.controller.performance import MOVING, Performance
from kinesic.controller.play import command_times, commands
from kinesic.controller.servo_log import angles_at, usable
from kinesic.controller.watch.servos import ServoWatch
from kinesic.hardware.protocol.wire import BusError
from kinesic.hardware.servos import Servos
from kinesic.hardware.supervisor.channel import Note, Status
from kinesic.planning.plan import Plan
from kinesic.planning.syncs import SyncTime

DELAY = 0.002  # [s] from a command's time until its goals have gone over the wire
POLL = 0.02  # [s] between two looks at supervisor and keyboard
ENDING = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
TOO_NEAR = "stopped before contact: the servos' errors leave too little clearance (`kinesic twin fit` finds why)"
FULL_PACE = 0.999  # scale of time that is all of it

RunRequest = Literal["go on", "stop", "resume", "end"]  # "stop": at once; "resume": consents; "end": fold to rest
Ending = Literal["performed", "ended", "stopped", "failed"]


@dataclass(frozen=True, eq=False)
class ServoRun:
    """A plan as the servos performed it."""

    performance: Performance  # of the twin, with the plan
    history: tuple[Status, ...]  # of every cycle in which performance time ran
    notes: tuple[Note, ...]
    ending: Ending
    why: str = ""  # it failed

    @cached_property
    def _rows(self) -> tuple[Status, ...]:
        """The rows of the history in which time went on and every servo had been read."""
        return usable(self.history)

    @cached_property
    def clocks(self) -> Floats:
        """(k,) [s] since the first."""
        return sealed([status.clock - self._rows[0].clock for status in self._rows])

    @cached_property
    def times(self) -> Floats:
        """(k,) [s] performance time."""
        return sealed([status.time for status in self._rows])

    @cached_property
    def angles(self) -> Floats:
        """(k, n) [rad] measured, each at its own time."""
        return self._table("angles")

    @cached_property
    def taken(self) -> Floats:
        """(k, n) [s] when each angle was measured, since the clock of the first row."""
        return sealed(self._table("taken") - (self._rows[0].clock if self._rows else 0.0))

    @cached_property
    def followed(self) -> Floats:
        """(k, n) [rad] measured, as it was at the clock of each row."""
        if not self._rows:
            return self.angles
        return angles_at(self.clocks, self.taken, self.angles)

    @cached_property
    def goals(self) -> Floats:
        """(k, n) [rad] sent."""
        return self._table("goals")

    def _table(self, name: Literal["angles", "goals", "taken"]) -> Floats:
        joints = len(self.performance.plan.setup.robot.skeleton.hinges)
        return sealed(np.reshape([getattr(status, name) for status in self._rows], (len(self._rows), joints)))

    @cached_property
    def errors(self) -> Floats:
        """(k, n) [rad] measured minus planned at the performance time when it was measured.

        NaN where nothing new was measured, where the hinge is not moving, and while time is slowed down: the plan's
        speeds do not hold then.
        """
        if not self._rows:
            return self.angles
        trajectory = self.performance.plan.trajectory
        planned = np.empty((2, *self.angles.shape))
        for k, taken in enumerate(self.taken.T):
            found = trajectory.sample(np.interp(taken, self.clocks, self.times))
            planned[:, :, k] = found[0][:, k], found[1][:, k]
        moving: Flags = np.abs(planned[1]) > MOVING * self.performance.plan.setup.limits.speed
        whole = np.array([[status.scale > FULL_PACE] for status in self._rows], dtype=np.bool_).reshape(-1, 1)
        news: Flags = np.diff(self.taken, axis=0, prepend=-np.inf) > 0.0
        return np.where(moving & whole & news, self.angles - planned[0], np.nan)

    @cached_property
    def performed(self) -> float:
        """Share of the plan that was performed, whether every servo was read or not."""
        end = self.performance.reference.times[-1]
        reached = max((status.time for status in self.history if np.isfinite(status.time)), default=0.0)
        return float(reached / end) if end > 0.0 else 0.0

    @cached_property
    def full_pace(self) -> float:
        """Share of the samples in which time ran at full pace; 0 where there is none."""
        return float(np.mean([status.scale > FULL_PACE for status in self._rows])) if self._rows else 0.0

    @cached_property
    def lags(self) -> dict[SyncTime, float | None]:
        """How much later than planned each sync point was met by the robot [s]; None: never."""
        wanted = self.performance.reference.arrivals
        if len(self.times) < 2:
            return dict.fromkeys(wanted)
        return lags(wanted, self.times, part_paths(self.followed, self.performance.plan.setup.robot))


def perform_live(
    performance: Performance,
    servos: Servos,
    *,
    requested: Callable[[], RunRequest] = lambda: "go on",
    shown: Callable[[Status], None] = lambda status: None,
) -> ServoRun:
    """Lets the servos perform what a twin has performed before; returns when the robot is limp again.

    Args:
        performance: of the twin.
        servos: opened, and closed here.
        requested: looked up every `POLL` seconds. After "stop", or when the servos were out of hand for more than a
            second, they hold until "resume", or "end"; who never resumes finds them folded and released after a minute.
        shown: gets each new status.
    """
    plan = performance.plan
    times = command_times(plan.duration)
    known = plan.setup
    leading = FeedForward.of(known.robot, known.dynamics, performance.believed, delay=DELAY)
    setpoints = leading.lead(plan.trajectory, times)
    history: list[Status] = []
    notes: list[Note] = []
    requests: list[RunRequest] = []
    watch = watch_of(plan)
    with ThreadPoolExecutor(1) as pool:
        try:
            for command in commands(plan.trajectory, times, setpoints):
                servos.write(command)
        finally:
            closing = pool.submit(servos.close)
        try:
            while not closing.done():
                news = _listen(servos, history, notes, shown)
                _heed(servos, watch, news, requests, notes)
                _obey(servos, requested(), requests)
                time.sleep(POLL)
        except BaseException:
            servos.release()  # nobody listens to the keyboard any more
            raise
    _listen(servos, history, notes, shown)
    error = closing.exception()
    if error is not None and not isinstance(error, BusError):
        raise error
    ran = tuple(status for status in history if status.stage.runs)
    ending, why = _ending(history, notes, requests, error)
    return ServoRun(performance, ran, tuple(notes), ending, why)


@contextmanager
def interrupted() -> Iterator[Callable[[], bool]]:
    """Catches Ctrl-C, SIGTERM and a terminal that closes: yields a function that tells whether one came since its call.

    Outside the main thread, which alone hears them, none ever comes. One that is ignored, as under nohup, stays so.
    """
    if threading.current_thread() is not threading.main_thread():
        yield lambda: False
        return
    waiting: list[int] = []

    def note(number: int, _frame: FrameType | None) -> None:
        waiting.append(number)

    heard = [number for number in ENDING if signal.getsignal(number) is not signal.SIG_IGN]
    before = {number: signal.signal(number, note) for number in heard}
    try:
        yield lambda: bool(waiting and waiting.pop())
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


def watch_of(plan: Plan) -> ServoWatch:
    """Makes the watch of the clearance of a plan that servos perform."""
    known, end = plan.setup, plan.trajectory.duration

    def reference(times: Floats) -> Floats:
        return plan.trajectory.sample(np.minimum(times, end))[0]

    return ServoWatch(reference, known.distances, least=known.robot.least_clearance)


def _heed(
    servos: Servos, watch: ServoWatch, news: Sequence[Status], requests: list[RunRequest], notes: list[Note]
) -> None:
    """Slows the servos down where their errors leave too little clearance, and stops them before contact."""
    if watch.see(news):
        servos.slow_to(watch.pace)
        if watch.over and not requests:
            servos.stop()
            requests.append("stop")
            notes.append(Note(news[-1].clock, -1, "clearance", TOO_NEAR))


def _listen(
    servos: Servos, history: list[Status], notes: list[Note], shown: Callable[[Status], None]
) -> tuple[Status, ...]:
    news = servos.history()
    history += news
    notes += servos.events()
    if news:
        shown(news[-1])
    return news


def _obey(servos: Servos, request: RunRequest, requests: list[RunRequest]) -> None:
    if request == "go on":
        return
    if request == "stop":
        servos.stop()
    elif request == "resume":
        servos.resume()
        requests.clear()
        return
    else:
        servos.release()
    requests.append(request)


def _ending(
    history: list[Status], notes: list[Note], requests: list[RunRequest], error: BaseException | None
) -> tuple[Ending, str]:
    if error is not None:
        return "failed", str(error)
    if any(status.faulty for status in history):
        return "failed", _last_of(notes, "failed", "refused", "error") or "a servo has failed"
    if requests:
        return ("stopped", _last_of(notes, "clearance")) if "stop" in requests else ("ended", "")
    performed = max((status.clock for status in history if status.stage.runs), default=0.0)
    why = _last_of([note for note in notes if note.clock >= performed], "paused", "supply")
    return ("failed", why) if why else ("performed", "")


def _last_of(notes: list[Note], *kinds: str) -> str:
    return next((note.text for note in reversed(notes) if note.kind in kinds), "")
