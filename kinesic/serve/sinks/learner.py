"""Learns from the first motion of a sink how its servos are, in a process of its own, while it goes on."""

import os
from collections import deque
from collections.abc import Iterable
from concurrent.futures import Future, ThreadPoolExecutor
from multiprocessing.connection import Connection

import numpy as np

from kinesic.body.robot import Robot
from kinesic.child import Child, child_context
from kinesic.controller.learned_gains import ENOUGH, MOVING, REST, Lesson, learn
from kinesic.controller.servo_log import log_of_cycles
from kinesic.hardware.supervisor.channel import Status
from kinesic.sim.log import Log
from kinesic.sim.servo_factors import Factors

NICE = 10  # behind whatever performs or plans
LEAST = 0.5  # [s] of motion that is worth looking at
QUIET = 1.0  # [s] without motion after which one is over
TRIES = 3  # motions that are looked at until one tells something
CYCLES = 100  # per second, about


class ServoLearner:
    """Collects the cycles of one motion, and has them looked at; what is learned is told once."""

    def __init__(self, robot: Robot, believed: Factors) -> None:
        """Has seen nothing.

        Args:
            robot: as its data sheets describe it.
            believed: how its servos are believed to be.
        """
        self._robot, self._believed = robot, believed
        self._cycles: deque[Status] = deque(maxlen=round((ENOUGH + QUIET + REST) * CYCLES))
        self._moved = self._stood = 0.0  # [s] with and, lately, without motion
        self._thread = ThreadPoolExecutor(1, thread_name_prefix="learner")
        self._coming: Future[Lesson] | None = None
        self._child: Child | None = None
        self._tries = 0

    def see(self, cycles: Iterable[Status]) -> None:
        """Takes cycles that are new; never waits."""
        if self._coming is None and self._tries < TRIES:
            for cycle in cycles:
                self._add(cycle)
            if self._moved >= LEAST and (self._stood >= QUIET or len(self._cycles) == self._cycles.maxlen):
                self._tries += 1
                self._coming = self._thread.submit(self._look, tuple(self._cycles))

    def lesson(self) -> Lesson | None:
        """What was learned from a motion, once; None as long as there is nothing new."""
        if self._coming is None or not self._coming.done():
            return None
        found, self._coming = self._coming.result(), None
        self._tries = self._tries if found.why else TRIES
        self._begin_anew()
        return found

    def close(self) -> None:
        """Ends the process, if it is still at work."""
        self._tries = TRIES
        self._thread.shutdown(wait=False, cancel_futures=True)
        if self._child is not None:
            self._child.kill(wait=False)

    def _add(self, cycle: Status) -> None:
        if not (cycle.stage.runs and np.isfinite(cycle.time)):
            self._begin_anew()
            return
        last = self._cycles[-1] if self._cycles else cycle
        self._cycles.append(cycle)
        span = cycle.clock - last.clock
        if span > 0.0 and np.any(np.abs(cycle.goals - last.goals) > MOVING * span * self._robot.drives.no_load):
            self._moved, self._stood = self._moved + span, 0.0
        else:
            self._stood += span
        if not self._moved or (self._stood >= QUIET and self._moved < LEAST):
            self._keep_rest()

    def _keep_rest(self) -> None:
        """Keeps what comes just before a motion."""
        self._moved = 0.0
        while len(self._cycles) > round(REST * CYCLES):
            self._cycles.popleft()

    def _begin_anew(self) -> None:
        self._cycles.clear()
        self._moved = self._stood = 0.0

    def _look(self, cycles: tuple[Status, ...]) -> Lesson:
        """Has a process look at a motion, in a thread that waits for it."""
        log = log_of_cycles(cycles)
        if len(log.times) < 2:
            return Lesson(self._believed, why="servos were not read")
        context = child_context()
        ours, theirs = context.Pipe()
        self._child = Child(context, _learn, theirs, log, self._robot, self._believed, name="learner")
        try:
            lesson: Lesson = ours.recv()
        except (EOFError, ConnectionError):
            lesson = Lesson(self._believed, why="the process that looked at the motion has ended")
        ours.close()
        return lesson


def _learn(line: Connection, log: Log, robot: Robot, believed: Factors) -> None:
    os.nice(NICE)
    line.send(learn(log, robot, believed))
