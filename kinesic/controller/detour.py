"""Leads a motion around the body: a key is put into the path where two segments would come too near."""

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.dynamics import Clearance, Distances
from kinesic.body.robot import SIDES, Robot
from kinesic.controller.condition import Conditioned
from kinesic.controller.postures import Posture
from kinesic.controller.trajectory import Trajectory

SCAN_RATE = 100  # [Hz]
ROOM = 0.025  # [m] clearance that a detour aims at
ENOUGH = 0.018  # [m] with which it is content
PROBE = 1e-3  # [rad] for the gradient
STRIDE = 0.06  # [rad] of one step of the ascent
STRIDES = 15
LEAST_STEP = 0.06  # [s] between a detour and the keys of the same arm


def scan(trajectory: Trajectory, distances: Distances) -> tuple[Floats, Clearance]:
    """Performance times (m,) and the clearance at them."""
    times = np.append(np.arange(0.0, trajectory.duration, 1.0 / SCAN_RATE), trajectory.duration)
    return times, distances.clearance(trajectory.sample(times)[0])


def detour(
    postures: tuple[Posture, ...],
    motion: Conditioned,
    time: float,
    pair: tuple[str, str],
    robot: Robot,
    distances: Distances,
) -> tuple[Posture, ...] | None:
    """The same postures with one more, which clears a pair of segments.

    Args:
        postures: of the block.
        motion: what came of them.
        time: [s] block time of the closest approach, as planned.
        pair: the segments that come too near.
        robot: the robot.
        distances: its self-distance.

    Returns:
        None when no arm of the pair has room for another key there, or no posture nearby is clear.
    """
    joints = [joint for side in SIDES for joint in _arm_in(pair, robot, side)]
    keys = np.flatnonzero([any(posture.keyed[joint] for joint in joints) for posture in postures])
    if not joints or np.abs(motion.planned[keys] - time).min(initial=np.inf) < LEAST_STEP:
        return None
    angles = motion.trajectory.at(time + motion.trajectory.zero).angles
    clear = _ascent(angles, joints, robot, distances)
    if clear is None:
        return None
    keyed = tuple(joint in joints for joint in range(len(angles)))
    order = np.argsort(motion.planned)
    asked = float(np.interp(time, motion.planned[order], motion.asked[order]))
    return tuple(sorted((*postures, Posture(asked, sealed(clear), keyed)), key=lambda posture: posture.time))


def _arm_in(pair: tuple[str, str], robot: Robot, side: str) -> tuple[int, ...]:
    """Joints of an arm that takes part in a pair, without its wrist."""
    segments = robot.chains[f"{side}_arm"]
    return robot.skeleton.joints_of(segments[:-1]) if set(pair) & set(segments) else ()


def _ascent(angles: Floats, joints: list[int], robot: Robot, distances: Distances) -> Floats | None:
    """The posture that gains clearance along its gradient over some joints; None if it stays too near."""
    posture = np.array(angles)
    for _ in range(STRIDES):
        probes = np.repeat(posture[None, :], len(joints) + 1, axis=0)
        probes[np.arange(1, len(joints) + 1), joints] += PROBE
        found = distances.clearance(probes).distances
        if found[0] >= ROOM:
            return posture
        gradient = (found[1:] - found[0]) / PROBE
        size = np.linalg.norm(gradient)
        if size == 0.0:
            return None
        posture[joints] += STRIDE * gradient / size
        posture = robot.skeleton.clamp(posture)
    return posture if found[0] >= ENOUGH else None
