"""A twin is sent what a log says was sent."""

from itertools import pairwise

import msgspec
import numpy as np

from kinesic.body.arrays import Floats
from kinesic.body.command import Command
from kinesic.body.robot import Robot
from kinesic.sim.log import Log
from kinesic.sim.servo_factors import Factors
from kinesic.sim.twin import Twin

STEP = 0.002  # [s] of the physics, at most: half the twin's, as what its steps do wrong would go into the fit
SAME = 1e-9  # of a step, below which what is left over is none


def replay_log(log: Log, robot: Robot, factors: Factors) -> Floats:
    """Where a twin is at the times of a log.

    Goals that arrive within a step of the physics count by their share of it: a step that is cut in two where they
    arrive would make the angles jump with the latency, and no fit could follow.

    Args:
        log: begins at rest.
        robot: as its data sheets describe it.
        factors: how far the twin is from it.

    Returns:
        (m, n) [rad].
    """
    spans = np.diff(log.times)
    counts = np.ceil(spans / STEP - SAME).astype(int)
    pieces = [np.linspace(a, b, n + 1)[:-1] for (a, b), n in zip(pairwise(log.times), counts, strict=True)]
    steps = np.append(np.concatenate(pieces), log.times[-1])
    goals = np.diff(_sums(log, steps - factors.latency), axis=0) / np.diff(steps)[:, None]
    still, prompt = np.zeros(len(robot.drives)), msgspec.structs.replace(factors, latency=0.0)
    twin = Twin(robot, factors=prompt, start=log.angles[0], rounds=False, step=STEP)
    seen, angles = {0, *np.cumsum(counts).tolist()}, []
    for k, (time, goal) in enumerate(zip(steps.tolist(), [*goals, goals[-1]], strict=True)):
        twin.write(Command(time, goal, still, still, goal))
        if k in seen:
            angles.append(twin.state().angles)
    return np.array(angles)


def _sums(log: Log, times: Floats) -> Floats:
    """(k, n) [rad s] integral of the goals in force up to (k,) [s]; before the first, of where the log begins."""
    last = np.searchsorted(log.times, times, side="right") - 1
    in_force = np.where((last < 0)[:, None], log.angles[0], log.goals[last])
    so_far = np.cumsum(log.goals[:-1] * np.diff(log.times)[:, None], axis=0)
    whole = np.concatenate([np.zeros((1, log.goals.shape[1])), so_far])[np.maximum(last, 0)]
    sums: Floats = whole + in_force * (times - log.times[np.maximum(last, 0)])[:, None]
    return sums
