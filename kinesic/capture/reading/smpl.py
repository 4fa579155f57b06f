"""Reader of SMPL, SMPL-H and SMPL-X motion files (.npz).

AMASS, BEAT2 and motion generators use these formats.
"""

from collections.abc import Mapping

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.capture.reading.text import MAX_NUMBER, CaptureError, check_numbers, check_times
from kinesic.capture.skeleton_motion import ROTATION_CHANNEL, CapturedJoint, CapturedMotion
from kinesic.files.array_file import Array, numbers_of

RATE_NAMES = ("mocap_frame_rate", "mocap_framerate", "fps")  # accepted names of the npz array with the frame rate [Hz]
DEFAULT_RATE = 30.0  # [Hz] assumed frame rate of files that lack it
BODY_COLUMNS = 66  # number of leading columns of `poses`: rotations of pelvis and body
BODY_POSE_COLUMNS = 63  # number of leading columns of `pose_body`, without the pelvis
NO_TURN = sealed(np.zeros(3))  # (3,) [rad] rotation of a joint in the zero pose


def _joint(name: str, parent: str | None, x: float, y: float, z: float) -> CapturedJoint:
    return CapturedJoint(name, parent, sealed([x, y, z]), NO_TURN)


# Offsets from the parent in the zero pose [m]: x left, y up, z forward. The lengths are of an average adult, as those
# of the model are licensed. The directions of the arm bones are those of published motion: a straight T-pose errs by 16
# degrees.
UPPER_BODY: Mapping[int, CapturedJoint] = {  # by SMPL joint index
    0: _joint("pelvis", None, 0.0, 0.0, 0.0),
    3: _joint("spine1", "pelvis", 0.0, 0.12, -0.03),
    6: _joint("spine2", "spine1", 0.0, 0.14, 0.0),
    9: _joint("spine3", "spine2", 0.0, 0.06, 0.03),
    12: _joint("neck", "spine3", 0.0, 0.21, -0.04),
    13: _joint("left_collar", "spine3", 0.08, 0.12, -0.02),
    14: _joint("right_collar", "spine3", -0.08, 0.12, -0.02),
    15: _joint("head", "neck", 0.0, 0.09, 0.05),
    16: _joint("left_shoulder", "left_collar", 0.10, 0.04, -0.02),
    17: _joint("right_shoulder", "right_collar", -0.10, 0.04, -0.02),
    18: _joint("left_elbow", "left_shoulder", 0.250, -0.065, -0.036),
    19: _joint("right_elbow", "right_shoulder", -0.250, -0.065, -0.036),
    20: _joint("left_wrist", "left_elbow", 0.250, 0.020, -0.003),
    21: _joint("right_wrist", "right_elbow", -0.250, 0.020, -0.003),
}


def is_smpl(arrays: Mapping[str, Array]) -> bool:
    """Return whether the arrays are those of an SMPL motion."""
    return "poses" in arrays or "pose_body" in arrays


def read_smpl(arrays: Mapping[str, Array], source: str) -> tuple[tuple[CapturedJoint, ...], CapturedMotion, str]:
    """Read the upper body of an SMPL motion.

    Returns:
        Joints, motion, and a guess about the frame rate, empty if the file states it.

    Raises:
        CaptureError: the arrays have other shapes, or numbers that are not finite.
    """
    try:
        poses = _body_poses(arrays)
        rate, guess = _frame_rate(arrays)
    except ValueError as error:
        raise CaptureError(f"{source}: {error}") from None
    check_numbers(poses, f"{source}: poses")
    if not 0.0 < rate <= MAX_NUMBER:
        raise CaptureError(f"{source}: the frame rate is {rate:g}; it must be positive")
    times = np.arange(len(poses)) / rate
    check_times(times, source)
    columns = {(joint.name, ROTATION_CHANNEL): slice(3 * index, 3 * index + 3) for index, joint in UPPER_BODY.items()}
    return tuple(UPPER_BODY.values()), CapturedMotion(sealed(times), columns, sealed(poses), {}), guess


def _body_poses(arrays: Mapping[str, Array]) -> Floats:
    """Return rotation vectors of pelvis and body, (m, 66) [rad]."""
    if "pose_body" in arrays:
        body = numbers_of(arrays, "pose_body", 2).astype(np.float64)
        if body.shape[1] < BODY_POSE_COLUMNS:
            raise ValueError(f"pose_body has {body.shape[1]} columns, must have {BODY_POSE_COLUMNS}")
        return np.concatenate([np.zeros((len(body), 3)), body[:, :BODY_POSE_COLUMNS]], axis=1)
    poses = numbers_of(arrays, "poses", 2).astype(np.float64)
    if poses.shape[1] < BODY_COLUMNS:
        raise ValueError(f"poses has {poses.shape[1]} columns, must have at least {BODY_COLUMNS}")
    return poses[:, :BODY_COLUMNS]


def _frame_rate(arrays: Mapping[str, Array]) -> tuple[float, str]:
    name = next((name for name in RATE_NAMES if name in arrays), None)
    if name is None:
        return DEFAULT_RATE, f"frame rate taken as {DEFAULT_RATE:g} Hz"
    rate = arrays[name]
    if rate.dtype.kind not in "iuf" or rate.size != 1:
        raise ValueError(f"{name} must be one number")
    return float(rate.reshape(-1)[0]), ""
