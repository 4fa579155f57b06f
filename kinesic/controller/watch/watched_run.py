"""Performs a plan in a twin whose errors leave too little clearance: slower there, and not to the end if need be."""

from dataclasses import dataclass, replace
from math import inf

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.command import RATE, Command, Measurements
from kinesic.controller.feedforward import FeedForward
from kinesic.controller.observer import Observer
from kinesic.controller.observer_stream import InputStream
from kinesic.controller.play import command_times
from kinesic.controller.watch.clearance import LOOK, ClearanceWatch, coming_times, look_ahead
from kinesic.hardware.supervisor.player import DONE, TimeScale, advance_time
from kinesic.motion.trajectory import Trajectory
from kinesic.planning.plan import Plan
from kinesic.sim.twin import Twin

PERIOD = 1 / RATE
TICKS = round(LOOK * RATE)  # of commands between two looks
FEWEST = 2  # commands: less than that is no motion, and has no speed
SLOWING = 0.2  # [s] in which time comes to a stop


@dataclass(frozen=True, eq=False)
class WatchedRun:
    """A performance whose time did not run evenly."""

    times: Floats  # (m,) [s] performance time of each command, one every `PERIOD`
    duties: Floats  # (m, n) that the motion needed at its pace
    measured: Measurements  # its times are those of the performance
    least_pace: float  # seconds of the performance per second, where it was slowed down most


@dataclass(frozen=True, eq=False)
class Slowed:
    """A motion at one moment of its performance, as it goes on from there at a pace."""

    trajectory: Trajectory
    time: float  # [s] of the performance
    pace: float

    def sample(self, times: Floats) -> tuple[Floats, Floats, Floats]:
        """Angles, speeds and accelerations, each (k, n), so many seconds from that moment on."""
        angles, speeds, accelerations = self.trajectory.sample(self.time + self.pace * times)
        return angles, self.pace * speeds, self.pace**2 * accelerations


def perform_watched(plan: Plan, twin: Twin, feedforward: FeedForward, observer: Observer | None) -> WatchedRun:
    """Performs a plan while its clearance is watched.

    Args:
        plan: what is performed.
        twin: at the plan's first posture, with contacts.
        feedforward: gives the goals.
        observer: corrects them, of this one body; None: nobody does.
    """
    setup, end = plan.setup, float(command_times(plan.duration)[-1])
    clock, watch = TimeScale(0.0, 1.0), ClearanceWatch()
    times: list[float] = []
    paces: list[float] = []
    duties: list[Floats] = []
    inputs = InputStream(observer) if observer else None
    belief = observer.begin() if observer else None
    strayed = np.zeros(len(setup.robot.skeleton.hinges))
    while len(times) < FEWEST or not watch.over:
        now = Slowed(plan.trajectory, clock.time, clock.scale)
        angles, speeds, accelerations = (sealed(rows[0]) for rows in now.sample(np.zeros(1)))
        led = feedforward.lead(now, np.zeros(1))
        goals = led.goals[0]
        if observer and inputs and belief:
            taught = inputs.add(angles, led)
            if times:
                belief = observer.after(belief, strayed, taught, 0)
                goals = belief.goals
        twin.write(Command(len(times) * PERIOD, angles, speeds, accelerations, goals))
        strayed = twin.positions() - angles
        if len(times) % TICKS == 0:
            coming = plan.trajectory.sample(coming_times(clock.time, end))[0]
            watch = look_ahead(watch, coming, strayed, setup.distances, least=setup.robot.least_clearance)
        times.append(clock.time)
        duties.append(led.duties[0])
        paces.append(clock.scale)
        if clock.time >= end - DONE:
            break
        clock = advance_time(clock, PERIOD, target=watch.pace, end=inf, slow=SLOWING)
    twin.close()
    measured = replace(twin.measurements(), times=sealed(times))
    return WatchedRun(sealed(times), sealed(duties), measured, min(paces))
