"""Inverse kinematics for dragging an elbow, the trunk or the gaze.

The elbow moves on its circle around the line from shoulder to wrist, while the wrist stays in place. The trunk leans so
that the neck follows the target. The head rotates so that the eyes look at the target.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.dynamics import Distances
from kinesic.body.robot import Robot, Side
from kinesic.body.skeleton import Frames
from kinesic.ik.box_lm import Box, descend
from kinesic.serve.desk.reach import DraggedPosture, at_limit

Part = Literal["elbow", "trunk", "gaze"]
Rows = Callable[[Frames], Floats]  # dimensionless residuals (m, rows) of postures (m, ...)


@dataclass(frozen=True)
class DragTuning:
    """Step sizes, weights and tolerances of the drag solver."""

    gradient_step: float = 1e-6  # [rad] step of the numerical gradient; also the smallest usable length [m]
    wrist_weight: float = 10.0  # weight of the wrist position relative to the elbow position
    solve_tolerance: float = 1e-4  # norm of the residuals at which the solver stops
    path_steps: int = 16  # postures checked for collisions on the path from the start
    arrival_tolerance: float = 2e-3  # largest dimensionless residual norm of a reached target


DRAG_TUNING = DragTuning()  # values used for every drag


def drag_part(
    robot: Robot, distances: Distances, part: Part, side: Side, target: Floats, start: Floats
) -> DraggedPosture:
    """Return the posture that brings a body part closest to a target.

    All other parts stay in place.

    Args:
        robot: robot to pose.
        distances: distances between the bodies of the robot.
        part: dragged body part.
        side: side of the elbow.
        target: (3,) [m] in the world: position of the elbow or neck, or point to look at.
        start: (n,) [rad] posture to stay close to.

    Returns:
        The posture, within joint ranges and free of collisions. `residual` is the distance to the closest position that
        the part could reach without obstacles; for the gaze, the distance of the line of sight from the target.
    """
    near = sealed(robot.skeleton.clamp(start))
    joints, rows, scale = _PART_SOLVERS[part](robot, side, np.asarray(target, dtype=np.float64), near)
    posture = _solve(robot, joints, rows, near)
    posture, contact = _keep_clear(robot, distances, near, posture)
    residual = float(np.linalg.norm(rows(robot.skeleton.frames(posture[None]))[0, :3]))
    stopped = residual > DRAG_TUNING.arrival_tolerance
    limits = tuple(at_limit(robot, posture, joints)) if stopped and contact is None else ()
    return DraggedPosture(posture, residual * scale, limits, contact if stopped else None, reached=not stopped)


def _elbow(robot: Robot, side: Side, target: Floats, near: Floats) -> tuple[tuple[int, ...], Rows, float]:
    """Return joints, residual function and length scale [m] for swivelling the elbow.

    Joints that raise the shoulder are excluded.
    """
    arm, frames, size = robot.arm(side), robot.skeleton.frames(near), robot.arm_length
    shoulder, elbow, hand = (frames.origins[k] for k in (arm.shoulder, arm.elbow, arm.wrist))
    line = hand - shoulder
    line = line / max(float(np.linalg.norm(line)), DRAG_TUNING.gradient_step)
    centre = shoulder + line * float(line @ (elbow - shoulder))
    radial = target - centre - line * float(line @ (target - centre))
    radius, distance = float(np.linalg.norm(elbow - centre)), float(np.linalg.norm(radial))
    goal = elbow if distance < DRAG_TUNING.gradient_step else centre + radial * (radius / distance)

    def rows(frames: Frames) -> Floats:
        origins = frames.origins
        wrist_error = DRAG_TUNING.wrist_weight * (hand - origins[:, arm.wrist]) / size
        return np.concatenate([(goal - origins[:, arm.elbow]) / size, wrist_error], axis=1)

    return tuple(joint for joint in arm.joints if joint not in arm.shoulder_lift_joints), rows, size


def _trunk(robot: Robot, _side: Side, target: Floats, near: Floats) -> tuple[tuple[int, ...], Rows, float]:
    """Return joints, residual function and length scale [m] for leaning the trunk."""
    skeleton, joints = robot.skeleton, robot.joints("torso")
    base, neck = (skeleton.segment(robot.chains[name][0]) for name in ("torso", "neck"))
    frames = skeleton.frames(near)
    height = float(np.linalg.norm(frames.origins[neck] - frames.origins[base]))
    offset = target - frames.origins[base]
    goal = frames.origins[base] + offset * (height / max(float(np.linalg.norm(offset)), DRAG_TUNING.gradient_step))

    def rows(frames: Frames) -> Floats:
        return np.asarray((goal - frames.origins[:, neck]) / height)

    return joints, rows, height


def _gaze(robot: Robot, _side: Side, target: Floats, near: Floats) -> tuple[tuple[int, ...], Rows, float]:
    """Return joints, residual function and length scale [m] for turning the gaze."""
    head, eyes = robot.skeleton.segment(robot.chains["neck"][-1]), robot.sites["eyes"]
    frames = robot.skeleton.frames(near)
    distance = float(np.linalg.norm(target - frames.origins[head]))

    def rows(frames: Frames) -> Floats:
        rotations = frames.rotations[:, head]
        offset = target - frames.origins[:, head] - rotations @ eyes.position
        return np.asarray(offset / np.linalg.norm(offset, axis=1, keepdims=True) - rotations @ eyes.facing)

    return robot.joints("neck"), rows, distance


_PART_SOLVERS = {"elbow": _elbow, "trunk": _trunk, "gaze": _gaze}  # dragged body part -> its problem


def _solve(robot: Robot, joints: tuple[int, ...], rows: Rows, near: Floats) -> Floats:
    """Return joint angles [rad] of least squared residuals within their ranges."""
    indices = list(joints)
    lower, upper = robot.skeleton.lower[indices], robot.skeleton.upper[indices]

    def errors(angles: Floats) -> tuple[Floats, Floats]:
        postures = np.tile(near, (len(indices) + 1, 1))
        postures[:, indices] = angles
        postures[np.arange(1, len(postures)), indices] += DRAG_TUNING.gradient_step
        residuals = rows(robot.skeleton.frames(postures))
        return residuals[0], (residuals[0] - residuals[1:]).T / DRAG_TUNING.gradient_step

    box = Box(lower, upper, near[indices], np.ones(len(indices)))
    posture = np.array(near)
    posture[indices] = descend(errors, near[indices], box, tolerance=DRAG_TUNING.solve_tolerance).angles
    return sealed(posture)


def _keep_clear(
    robot: Robot, distances: Distances, near: Floats, posture: Floats
) -> tuple[Floats, tuple[str, str] | None]:
    """Return the last collision-free posture on a path, and the obstacle.

    The path runs straight in joint angles. The obstacle is the next colliding pair, or None if the path is free.
    """
    path = near + np.linspace(0.0, 1.0, DRAG_TUNING.path_steps + 1)[:, None] * (posture - near)
    clearance = distances.clearance(path)
    close = np.flatnonzero(clearance.distances < np.minimum(robot.min_clearance, clearance.distances[0]))
    if not close.size:
        return posture, None
    return sealed(path[max(0, close[0] - 1)]), clearance.pairs[close[0]]
