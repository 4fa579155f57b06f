"""Finds the posture for an elbow, the trunk or the gaze that somebody drags, and what keeps it from going farther.

An elbow moves on its circle about the line from shoulder to hand, which stays where it is; the trunk leans so that the
neck goes where it is pulled; the head turns so that the eyes look at a place.
"""

from collections.abc import Callable
from typing import Literal

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.dynamics import Distances
from kinesic.body.robot import Robot, Side
from kinesic.body.skeleton import Frames
from kinesic.ik.box_lm import Box, descend
from kinesic.serve.desk.reach import DraggedPosture, at_limit

Part = Literal["elbow", "trunk", "gaze"]
Rows = Callable[[Frames], Floats]  # of postures (m, ...), what is wrong with each (m, rows), of order one

PROBE = 1e-6  # [rad] for the gradient
HELD = 10.0  # weight of a hand that stays where it is, beside that of its elbow
NEAR = 1e-4  # length of the rows that is good enough
STEPS = 16  # on the way to a posture in which segments would meet
ARRIVED = 2e-3  # arm lengths, or radians, from where it was pulled


def drag_part(
    robot: Robot, distances: Distances, part: Part, side: Side, target: Floats, start: Floats
) -> DraggedPosture:
    """Finds the posture that brings a part of the body as near to a place as it can go; all else stays.

    Args:
        robot: whose body.
        distances: between its segments.
        part: that is dragged.
        side: of the elbow.
        target: (3,) [m] in the world: of the elbow, of the neck, or where the eyes look.
        start: (n,) [rad] posture to stay close to.

    Returns:
        The posture, inside the ranges and clear of the body; `residual` is how far it falls short of the nearest place
        that this part could have if nothing stopped it: of a gaze, of the line of sight from the target.
    """
    near = sealed(robot.skeleton.clamp(start))
    joints, rows, scale = _PARTS[part](robot, side, np.asarray(target, dtype=np.float64), near)
    posture = _solve(robot, joints, rows, near)
    posture, contact = _keep_clear(robot, distances, near, posture)
    miss = float(np.linalg.norm(rows(robot.skeleton.frames(posture[None]))[0, :3]))
    stopped = miss > ARRIVED
    limits = tuple(at_limit(robot, posture, joints)) if stopped and contact is None else ()
    return DraggedPosture(posture, miss * scale, limits, contact if stopped else None, reached=not stopped)


def _elbow(robot: Robot, side: Side, target: Floats, near: Floats) -> tuple[tuple[int, ...], Rows, float]:
    """An elbow on its circle; what raises the shoulder stays."""
    arm, frames, size = robot.arm(side), robot.skeleton.frames(near), robot.arm_length
    shoulder, elbow, hand = (frames.origins[k] for k in (arm.shoulder, arm.elbow, arm.wrist))
    line = hand - shoulder
    line = line / max(float(np.linalg.norm(line)), PROBE)
    middle = shoulder + line * float(line @ (elbow - shoulder))
    out = target - middle - line * float(line @ (target - middle))
    radius, far = float(np.linalg.norm(elbow - middle)), float(np.linalg.norm(out))
    place = elbow if far < PROBE else middle + out * (radius / far)

    def rows(frames: Frames) -> Floats:
        origins = frames.origins
        stray = HELD * (hand - origins[:, arm.wrist]) / size
        return np.concatenate([(place - origins[:, arm.elbow]) / size, stray], axis=1)

    return tuple(joint for joint in arm.joints if joint not in arm.lifting), rows, size


def _trunk(robot: Robot, _side: Side, target: Floats, near: Floats) -> tuple[tuple[int, ...], Rows, float]:
    """The neck, as far from where the trunk turns as it is; what turns the trunk about itself stays."""
    skeleton, joints = robot.skeleton, robot.joints("torso")
    base, neck = (skeleton.segment(robot.chains[name][0]) for name in ("torso", "neck"))
    frames = skeleton.frames(near)
    height = float(np.linalg.norm(frames.origins[neck] - frames.origins[base]))
    way = target - frames.origins[base]
    place = frames.origins[base] + way * (height / max(float(np.linalg.norm(way)), PROBE))

    def rows(frames: Frames) -> Floats:
        return np.asarray((place - frames.origins[:, neck]) / height)

    return joints, rows, height


def _gaze(robot: Robot, _side: Side, target: Floats, near: Floats) -> tuple[tuple[int, ...], Rows, float]:
    """The line of sight, through the place."""
    head, eyes = robot.skeleton.segment(robot.chains["neck"][-1]), robot.sites["eyes"]
    frames = robot.skeleton.frames(near)
    distance = float(np.linalg.norm(target - frames.origins[head]))

    def rows(frames: Frames) -> Floats:
        rotations = frames.rotations[:, head]
        way = target - frames.origins[:, head] - rotations @ eyes.position
        return np.asarray(way / np.linalg.norm(way, axis=1, keepdims=True) - rotations @ eyes.facing)

    return robot.joints("neck"), rows, distance


_PARTS = {"elbow": _elbow, "trunk": _trunk, "gaze": _gaze}


def _solve(robot: Robot, joints: tuple[int, ...], rows: Rows, near: Floats) -> Floats:
    """The posture nearest to where the part is pulled, inside the ranges; only these joints move."""
    chosen = list(joints)
    lower, upper = robot.skeleton.lower[chosen], robot.skeleton.upper[chosen]

    def errors(angles: Floats) -> tuple[Floats, Floats]:
        postures = np.tile(near, (len(chosen) + 1, 1))
        postures[:, chosen] = angles
        postures[np.arange(1, len(postures)), chosen] += PROBE
        found = rows(robot.skeleton.frames(postures))
        return found[0], (found[0] - found[1:]).T / PROBE

    box = Box(lower, upper, near[chosen], np.ones(len(chosen)))
    posture = np.array(near)
    posture[chosen] = descend(errors, near[chosen], box, tolerance=NEAR).angles
    return sealed(posture)


def _keep_clear(
    robot: Robot, distances: Distances, near: Floats, posture: Floats
) -> tuple[Floats, tuple[str, str] | None]:
    """The last posture on the way that keeps clear of the body, and the pair that would meet next."""
    way = near + np.linspace(0.0, 1.0, STEPS + 1)[:, None] * (posture - near)
    found = distances.clearance(way)
    close = np.flatnonzero(found.distances < np.minimum(robot.least_clearance, found.distances[0]))
    if not close.size:
        return posture, None
    return sealed(way[max(0, close[0] - 1)]), found.pairs[close[0]]
