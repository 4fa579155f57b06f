"""Retargeting of captured clips to a robot's joints."""

from collections.abc import Sequence

import numpy as np
from scipy.spatial.transform import Rotation

from kinesic.body.arrays import Floats, sealed
from kinesic.body.robot import SIDE_NAMES, Robot, Side
from kinesic.capture.arm_proportions import fit_proportions
from kinesic.capture.arm_smoothing import smooth_arms
from kinesic.capture.arm_tracking import track_arm
from kinesic.capture.clip import ArmPath, BodyClip, Clip, JointClip
from kinesic.capture.derivatives import compute_time_stretch
from kinesic.capture.reading.text import CaptureError
from kinesic.capture.resampling import resample, resample_times, smooth_paths
from kinesic.capture.robot_motion import RobotMotion, arm_paths
from kinesic.motion.keys import RANGE_MARGIN
from kinesic.planning.setup import Setup
from kinesic.planning.torso import compute_torso_turn, set_turn

MAX_DURATION = 300.0  # [s] longest accepted clip
HEAD_AXES = "ZYX"  # intrinsic Euler axes of the neck: torsion, tilt and roll
MAX_LISTED_NAMES = 5  # largest number of joint names in a message


def retarget(clip: Clip, setup: Setup, source: str) -> RobotMotion:
    """Return a robot's joint angles that imitate a clip.

    `RobotMotion.angles` stay in the joint ranges, but may exceed the other limits.

    A body's wrists and elbows are followed by inverse kinematics, in arm lengths; the head by the neck. Joint angles
    are taken by name.

    Args:
        clip: of a body or of the robot's own joints.
        setup: robot and limits.
        source: name of the file, for messages.

    Raises:
        CaptureError: the clip is too long, or has no joint of the robot.
    """
    if clip.times[-1] > MAX_DURATION:
        raise CaptureError(f"{source}: it lasts {clip.times[-1]:.0f} s, at most {MAX_DURATION:.0f} s; cut it")
    times = resample_times(clip.times)
    if isinstance(clip, JointClip):
        return _take_joints(clip, times, setup.robot, source)
    return _follow_body(clip, times, setup)


def _follow_body(clip: BodyClip, times: Floats, setup: Setup) -> RobotMotion:
    robot = setup.robot
    angles = np.tile(robot.skeleton.rest, (len(times), 1))
    notes = list(clip.guesses)
    arms, targets = {}, {}
    paths = [path for arm in clip.arms.values() for path in (arm.elbow, arm.wrist)]
    *paths, heads = smooth_paths(clip.times, [*paths, unwrap_vectors(clip.head)], times)
    for k, side in enumerate(clip.arms):
        arms[side] = ArmPath(*paths[2 * k : 2 * k + 2])
        chain = robot.arms[side]
        targets[side] = fit_proportions(arms[side], chain, robot.arm_length)
        angles[:, list(chain.indices)], leaps = track_arm(chain, targets[side], robot.arm_length)
        if leaps:
            notes.append(f"{leaps} leaps of the {SIDE_NAMES[side]} arm bridged, where it cannot follow")
    turns = Rotation.from_rotvec(heads.copy()).as_euler(HEAD_AXES)
    set_turn(robot, "neck", turns - compute_torso_turn(robot, "torso", angles), angles)
    fast = {side: arm for side, arm in targets.items() if _exceeds_limits(angles, side, setup)}
    angles = smooth_arms(angles, fast, setup) if fast else angles
    return RobotMotion(sealed(times), sealed(angles), _inside(angles, robot), arms, clip.syncs, tuple(notes))


def _exceeds_limits(angles: Floats, side: Side, setup: Setup) -> bool:
    """Return whether an arm exceeds a velocity, acceleration, jerk or duty limit."""
    hinges = np.array(setup.robot.arms[side].indices)
    return float(compute_time_stretch(angles[:, hinges], setup.limits.part(hinges)).max()) > 1.0


def _take_joints(clip: JointClip, times: Floats, robot: Robot, source: str) -> RobotMotion:
    joints = robot.source_joints
    columns = joints.find_hinges(clip.names)
    if not columns:
        raise CaptureError(
            f"{source}: no joint of {robot.name}; it has {_list_names(clip.names)}, "
            f"the robot {_list_names(joints.names)}"
        )
    angles = np.tile(robot.skeleton.rest, (len(times), 1))
    given = [joints.hinge_angles(hinge, clip.names[k], clip.angles[:, k]) for hinge, k in columns.items()]
    angles[:, list(columns)] = resample(clip.times, np.stack(given, axis=1), times)
    unknown = [name for name in clip.names if name not in {*joints.names, *joints.hinges}]
    notes = (*clip.guesses, *([f"unknown joints: {_list_names(unknown)}"] if unknown else ()))
    return RobotMotion(sealed(times), sealed(angles), _inside(angles, robot), arm_paths(robot, angles), {}, notes)


def _inside(angles: Floats, robot: Robot) -> Floats:
    """Clip angles (m, n) to joint ranges narrowed by `RANGE_MARGIN`."""
    lower, upper = robot.skeleton.lower, robot.skeleton.upper
    margin = np.minimum(RANGE_MARGIN, (upper - lower) / 2.0)
    return sealed(np.clip(angles, lower + margin, upper - margin))


def unwrap_vectors(vectors: Floats) -> Floats:
    """Make rotation vectors (m, 3) continuous over time."""
    rotations = Rotation.from_rotvec(vectors.copy())
    quaternions = rotations.as_quat()
    signs = np.where(np.sum(quaternions[1:] * quaternions[:-1], axis=1) < 0.0, -1.0, 1.0)
    quaternions[1:] *= np.cumprod(signs)[:, None]
    sines = np.linalg.norm(quaternions[:, :3], axis=1)
    half_angles = np.arctan2(sines, quaternions[:, 3])
    scale = np.where(sines > 1e-9, 2.0 * half_angles / np.maximum(sines, 1e-9), 2.0)
    unwrapped: Floats = quaternions[:, :3] * scale[:, None]
    return unwrapped


def _list_names(names: Sequence[str]) -> str:
    listed = ", ".join(name[:40] for name in names[:MAX_LISTED_NAMES])
    return f"{listed} ..." if len(names) > MAX_LISTED_NAMES else listed
