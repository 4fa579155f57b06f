"""Perform plans on servos through the supervisor process.

All setpoints are sent at once. The supervisor stores them, owns the time and folds the robot to rest at the end. This
process only listens and forwards requests from the keyboard.
"""

import signal
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from types import FrameType
from typing import Literal

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.controller.feedforward import FeedForward
from kinesic.controller.play import commands
from kinesic.controller.servo_caps import compute_caps
from kinesic.controller.watch.servos import ServoWatch
from kinesic.hardware.protocol.wire import BusError
from kinesic.hardware.servos import Servos
from kinesic.hardware.supervisor.channel import Status
from kinesic.hardware.supervisor.notes import Note
from kinesic.host import ENDING_SIGNALS
from kinesic.metrics.dry_run import DryRun
from kinesic.metrics.servo_run import Ending, ServoRun
from kinesic.planning.plan import Plan

BUS_DELAY = 0.002  # [s] delay from a command's time until its setpoints are on the bus
POLL_PERIOD = 0.02  # [s] interval between polls of the supervisor and the keyboard
CLEARANCE_STOP_REASON = (
    "stopped before contact: the servos' errors leave too little clearance (`kinesic twin fit` finds the cause)"
)

RunRequest = Literal["go on", "stop", "resume", "end"]  # "stop": at once; "resume": confirm; "end": fold to rest


def perform_live(
    performance: DryRun,
    servos: Servos,
    *,
    requested: Callable[[], RunRequest] = lambda: "go on",
    shown: Callable[[Status], None] = lambda status: None,
) -> ServoRun:
    """Perform a plan on the servos, from torque on to torque off.

    Args:
        performance: dry run of the plan.
        servos: opened; closed here.
        requested: polled every `POLL_PERIOD` seconds. After "stop", or an interruption of more than a second, the
            servos hold until "resume" or "end"; without either they fold and release after a minute.
        shown: receives each new status.
    """
    plan = performance.plan
    times, setup = plan.command_times, plan.setup
    feed_forward = FeedForward.of(setup.robot, setup.dynamics, performance.servo_estimate, delay=BUS_DELAY)
    setpoints = feed_forward.compute_setpoints(plan.trajectory, times)
    history: list[Status] = []
    notes: list[Note] = []
    requests: list[RunRequest] = []
    watch = make_clearance_watch(plan)
    with ThreadPoolExecutor(1) as pool:
        try:
            if setup.policy is not None:
                servos.limit(compute_caps(setpoints, setup, pace=servos.settings.pace))
            for command in commands(plan.trajectory, times, setpoints):
                servos.write(command)
        finally:
            closing = pool.submit(servos.close)
        try:
            while not closing.done():
                statuses = _listen(servos, history, notes, shown)
                _apply_watch(servos, watch, statuses, requests, notes)
                _forward_request(servos, requested(), requests)
                time.sleep(POLL_PERIOD)
        except BaseException:
            servos.release()  # the keyboard is no longer read
            raise
    _listen(servos, history, notes, shown)
    error = closing.exception()
    if error is not None and not isinstance(error, BusError):
        raise error
    ran = tuple(status for status in history if status.stage.runs)
    ending, why = _ending(history, notes, requests, error)
    return ServoRun(performance, ran, tuple(notes), ending, why)


@contextmanager
def catch_interrupts() -> Iterator[Callable[[], bool]]:
    """Catch Ctrl-C, SIGTERM and SIGHUP while the context is active.

    Only the main thread receives signals; elsewhere none is reported. Ignored signals stay ignored, as under nohup.

    Yields:
        Function that returns whether a signal came since its last call.
    """
    if threading.current_thread() is not threading.main_thread():
        yield lambda: False
        return
    waiting: list[int] = []

    def record(number: int, _frame: FrameType | None) -> None:
        waiting.append(number)

    handled = [number for number in ENDING_SIGNALS if signal.getsignal(number) is not signal.SIG_IGN]
    before = {number: signal.signal(number, record) for number in handled}
    try:
        yield lambda: bool(waiting and waiting.pop())
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


def make_clearance_watch(plan: Plan) -> ServoWatch:
    """Make the clearance watch for a plan performed by servos."""
    setup, end = plan.setup, plan.trajectory.duration

    def reference(times: Floats) -> Floats:
        return plan.trajectory.sample(np.minimum(times, end))[0]

    return ServoWatch(reference, setup.distances, min_clearance=setup.robot.min_clearance)


def _apply_watch(
    servos: Servos, watch: ServoWatch, statuses: Sequence[Status], requests: list[RunRequest], notes: list[Note]
) -> None:
    """Slow or stop the servos if the clearance watch requires it."""
    if watch.ingest(statuses):
        servos.slow_to(watch.pace)
        if watch.over and not requests:
            servos.stop()
            requests.append("stop")
            notes.append(Note(statuses[-1].clock, -1, "clearance", CLEARANCE_STOP_REASON))


def _listen(
    servos: Servos, history: list[Status], notes: list[Note], shown: Callable[[Status], None]
) -> tuple[Status, ...]:
    statuses = servos.history()
    history += statuses
    notes += servos.events()
    if statuses:
        shown(statuses[-1])
    return statuses


def _forward_request(servos: Servos, request: RunRequest, requests: list[RunRequest]) -> None:
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
