"""Identification of servo parameters from the first motion that an output performs.

It runs in a separate process while the performance continues.
"""

from collections import deque
from collections.abc import Iterable
from concurrent.futures import Future, ThreadPoolExecutor

import numpy as np

from kinesic.body.robot import Robot
from kinesic.child import Child, PipeEnd, child_context
from kinesic.controller.learned_gains import (
    IDENTIFICATION_TIME,
    INITIAL_REST,
    MOVING_FRACTION,
    Identification,
    identify_servos,
)
from kinesic.hardware.supervisor.channel import Status
from kinesic.host import lower_priority
from kinesic.metrics.servo_log import make_servo_log
from kinesic.sim.log import Log
from kinesic.sim.servo_factors import Factors

LEARNER_NICENESS = 10  # niceness of the learner: lower priority than loop and planners
MIN_MOTION_DURATION = 0.5  # [s] duration of motion needed for servo identification
REST_DURATION = 1.0  # [s] duration of rest after which a recorded motion counts as ended
MAX_ATTEMPTS = 3  # largest number of motions tried for a servo identification
CYCLE_RATE = 100  # [Hz] approximate rate of servo cycles


class ServoLearner:
    """Collector of servo control cycles that identifies the servo parameters once."""

    def __init__(self, robot: Robot, estimate: Factors) -> None:
        """Create a learner without data.

        Args:
            robot: robot with servos as in their data sheets.
            estimate: initial estimate of the servo parameters.
        """
        self._robot, self._estimate = robot, estimate
        self._cycles: deque[Status] = deque(
            maxlen=round((IDENTIFICATION_TIME + REST_DURATION + INITIAL_REST) * CYCLE_RATE)
        )
        self._motion_time = self._rest_time = 0.0  # [s] with motion, and since the last motion
        self._thread = ThreadPoolExecutor(1, thread_name_prefix="learner")
        self._result: Future[Identification] | None = None
        self._child: Child | None = None
        self._attempts = 0

    def see(self, cycles: Iterable[Status]) -> None:
        """Add new servo cycles without blocking.

        Enough motion, followed by rest, starts the identification.
        """
        if self._result is None and self._attempts < MAX_ATTEMPTS:
            for cycle in cycles:
                self._add(cycle)
            if self._motion_time >= MIN_MOTION_DURATION and (
                self._rest_time >= REST_DURATION or len(self._cycles) == self._cycles.maxlen
            ):
                self._attempts += 1
                self._result = self._thread.submit(self._identify, tuple(self._cycles))

    def lesson(self) -> Identification | None:
        """Return the result of a finished servo identification once, otherwise None."""
        if self._result is None or not self._result.done():
            return None
        lesson, self._result = self._result.result(), None
        self._attempts = self._attempts if lesson.why else MAX_ATTEMPTS
        self._reset()
        return lesson

    def close(self) -> None:
        """Kill the identification process if it still runs."""
        self._attempts = MAX_ATTEMPTS
        self._thread.shutdown(wait=False, cancel_futures=True)
        if self._child is not None:
            self._child.kill(wait=False)

    def _add(self, cycle: Status) -> None:
        if not (cycle.stage.runs and np.isfinite(cycle.time)):
            self._reset()
            return
        last = self._cycles[-1] if self._cycles else cycle
        self._cycles.append(cycle)
        span = cycle.clock - last.clock
        if span > 0.0 and np.any(
            np.abs(cycle.setpoints - last.setpoints) > MOVING_FRACTION * span * self._robot.drives.no_load
        ):
            self._motion_time, self._rest_time = self._motion_time + span, 0.0
        else:
            self._rest_time += span
        if not self._motion_time or (self._rest_time >= REST_DURATION and self._motion_time < MIN_MOTION_DURATION):
            self._keep_rest()

    def _keep_rest(self) -> None:
        """Discard recorded cycles except those at rest before the next motion."""
        self._motion_time = 0.0
        while len(self._cycles) > round(INITIAL_REST * CYCLE_RATE):
            self._cycles.popleft()

    def _reset(self) -> None:
        self._cycles.clear()
        self._motion_time = self._rest_time = 0.0

    def _identify(self, cycles: tuple[Status, ...]) -> Identification:
        """Identify the servo parameters in a child process and wait for it."""
        log = make_servo_log(cycles)
        if len(log.times) < 2:
            return Identification(self._estimate, why="no servo telemetry was recorded")
        context = child_context()
        parent_end, child_end = context.Pipe()
        self._child = Child(context, _learn, child_end, log, self._robot, self._estimate, name="learner")
        try:
            lesson: Identification = parent_end.recv()
        except (EOFError, ConnectionError):
            lesson = Identification(self._estimate, why="the identification process died")
        parent_end.close()
        return lesson


def _learn(line: PipeEnd, log: Log, robot: Robot, estimate: Factors) -> None:
    lower_priority(LEARNER_NICENESS)
    line.send(identify_servos(log, robot, estimate))
