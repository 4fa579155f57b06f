"""Synthetic body motion with known measures."""

import numpy as np
from scipy.spatial.transform import Rotation

from kinesic.bench.naturalness.whole_body.motion import BodyMotion

RATE = 30.0  # [Hz]
ARM = 0.5  # [m] arm length
SYNCS = {"start": 0.0, "ready": 0.5, "strokeStart": 0.5, "stroke": 1.0, "strokeEnd": 1.0, "relax": 1.5, "end": 2.5}


def make_body(
    *,
    seconds=2.5,
    trunk=0.0,
    pelvis=0.0,
    head=0.0,
    turning=0.0,
    lift=0.0,
    swing=(0.0, 0.0),
    bend=(20.0, 20.0),
    scale=1.0,
    syncs=SYNCS,
    name="a",
    set_name="test",
    performance="p",
):
    """Make a body motion from rest to an extreme posture and back.

    Args:
        seconds: duration [s].
        trunk: rotation of the chest at the extreme [deg].
        pelvis: rotation of the pelvis to the left at the extreme [deg].
        head: rotation of the head at the extreme [deg].
        turning: rotation of both hands at the extreme [deg].
        lift: shoulder lift at the extreme [m].
        swing: forward displacement of left and right wrist at the extreme [m].
        bend: elbow flexion of left and right arm [deg].
        scale: size of the body.
        syncs: times of sync points [s].
        name: name of the clip.
        set_name: name of its set.
        performance: name of its performance.
    """
    times = np.arange(0.0, seconds + 1e-9, 1 / RATE)
    shape = 0.5 - 0.5 * np.cos(2 * np.pi * times / times[-1])
    shoulders = np.zeros((2, len(times), 3))
    elbows, wrists = shoulders.copy(), shoulders.copy()
    for arm, side in enumerate((1.0, -1.0)):
        flexion = np.radians(bend[arm])
        shoulders[arm] = [0.0, 0.2 * side, 0.4]
        shoulders[arm, :, 2] += lift * shape
        elbows[arm] = shoulders[arm] + [0.0, 0.0, -0.25]
        wrists[arm] = elbows[arm] + 0.25 * np.array([np.sin(flexion), 0.0, -np.cos(flexion)])
        wrists[arm, :, 0] += swing[arm] * shape
    return BodyMotion(
        name=name,
        set_name=set_name,
        performance=performance,
        times=times,
        syncs=syncs,
        arm=ARM * scale,
        hip_lines=turn("z", pelvis * shape) @ [0.0, 0.2, 0.0],
        chest=np.zeros((len(times), 3)),
        shoulders=shoulders * scale,
        elbows=elbows * scale,
        wrists=wrists * scale,
        chest_rotations=turn("y", trunk * shape),
        head_rotations=turn("z", head * shape),
        hand_rotations=np.stack([turn("z", turning * shape)] * 2),
        hand_axes=np.array([[0.0, 0.0, -1.0]] * 2),
    )


def turn(axis, degrees):
    """Return rotation matrices about an axis."""
    return Rotation.from_euler(axis, np.atleast_1d(degrees)[:, None], degrees=True).as_matrix()
