"""Performance in a twin that slows down when the clearance shrinks."""

from dataclasses import dataclass, replace
from math import inf

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.command import COMMAND_RATE, Command, Measurements
from kinesic.controller.feedforward import FeedForward
from kinesic.controller.observer import Observer
from kinesic.controller.observer_stream import InputStream
from kinesic.controller.watch.clearance import ClearanceWatch, look_ahead, lookahead_times
from kinesic.hardware.supervisor.player import END_TOLERANCE, TimeScale, advance_time
from kinesic.metrics.clearance_forecast import LOOK_PERIOD
from kinesic.motion.trajectory import Trajectory
from kinesic.planning.plan import Plan
from kinesic.sim.twin import Twin

COMMAND_PERIOD = 1 / COMMAND_RATE  # [s] time between two commands
TICKS_PER_LOOK = round(LOOK_PERIOD * COMMAND_RATE)  # commands between clearance checks
MIN_COMMANDS = 2  # number of commands kept of a stopped run, so that velocities can be computed
SLOWING_TIME = 0.2  # [s] time to slow down from full speed to a stop


@dataclass(frozen=True, eq=False)
class WatchedRun:
    """Record of a performance in a twin with a varying time scale."""

    times: Floats  # (m,) [s] performance time of each command, one per `COMMAND_PERIOD`
    duties: Floats  # (m, n) required duty cycles at the actual time scale
    measured: Measurements  # measured motion at the performance times
    min_pace: float  # smallest time scale, in seconds of performance per second


@dataclass(frozen=True, eq=False)
class SlowedMotion:
    """Remainder of a motion, slowed by a constant time scale."""

    trajectory: Trajectory
    time: float  # [s] performance time
    pace: float  # time scale

    def sample(self, times: Floats) -> tuple[Floats, Floats, Floats]:
        """Return angles, velocities and accelerations at times (k,) from now [s].

        Each is (k, n), in [rad] and its time derivatives. The motion advances by `pace` times `times` [s].
        """
        angles, speeds, accelerations = self.trajectory.sample(self.time + self.pace * times)
        return angles, self.pace * speeds, self.pace**2 * accelerations


def perform_watched(plan: Plan, twin: Twin, feedforward: FeedForward, observer: Observer | None) -> WatchedRun:
    """Perform a plan in a twin under the clearance watch.

    Args:
        plan: to be performed.
        twin: in the first posture of the plan, with contacts.
        feedforward: computes the setpoints.
        observer: of this one body; None: no correction.
    """
    setup, end = plan.setup, float(plan.command_times[-1])
    clock, watch = TimeScale(0.0, 1.0), ClearanceWatch()
    times: list[float] = []
    paces: list[float] = []
    duties: list[Floats] = []
    inputs = InputStream(observer) if observer else None
    estimate = observer.begin() if observer else None
    tracking_error = np.zeros(len(setup.robot.skeleton.hinges))
    while len(times) < MIN_COMMANDS or not watch.over:
        now = SlowedMotion(plan.trajectory, clock.time, clock.scale)
        angles, speeds, accelerations = (sealed(rows[0]) for rows in now.sample(np.zeros(1)))
        feed_forward = feedforward.compute_setpoints(now, np.zeros(1))
        goals = feed_forward.setpoints[0]
        if observer and inputs and estimate:
            tick_inputs = inputs.add(angles, feed_forward)
            if times:
                estimate = observer.advance(estimate, tracking_error, tick_inputs, 0)
                goals = estimate.setpoints
        twin.write(Command(len(times) * COMMAND_PERIOD, angles, speeds, accelerations, goals))
        tracking_error = twin.positions() - angles
        if len(times) % TICKS_PER_LOOK == 0:
            coming = plan.trajectory.sample(lookahead_times(clock.time, end))[0]
            watch = look_ahead(watch, coming, tracking_error, setup.distances, min_clearance=setup.robot.min_clearance)
        times.append(clock.time)
        duties.append(feed_forward.duties[0])
        paces.append(clock.scale)
        if clock.time >= end - END_TOLERANCE:
            break
        clock = advance_time(clock, COMMAND_PERIOD, target=watch.pace, end=inf, slow=SLOWING_TIME)
    twin.close()
    measured = replace(twin.measurements(), times=sealed(times))
    return WatchedRun(sealed(times), sealed(duties), measured, min(paces))
