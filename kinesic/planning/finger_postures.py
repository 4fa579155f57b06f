"""Insertion of finger keys between the postures of a block.

The motion follows them within its limits, without moving strokes.
"""

from bisect import bisect_right
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.robot import Robot, Side
from kinesic.expressivity.hands.fingers import finger_joints
from kinesic.expressivity.keyframes import FingerKey
from kinesic.motion.keys import KeyPosture

KEY_SPACING = 1e-4  # [s] delay of a finger key at the time of another key
Fingers = Mapping[Side, Sequence[FingerKey]]


def set_fingers(angles: Floats, time: float, fingers: Fingers, robot: Robot) -> None:
    """Interpolate finger keys at a block time [s], writing into a posture."""
    for side, keys in fingers.items():
        after = bisect_right([key.time for key in keys], time)
        here, there = keys[max(after - 1, 0)], keys[min(after, len(keys) - 1)]
        fraction = (time - here.time) / (there.time - here.time) if 0 < after < len(keys) else 0.0
        angles[list(finger_joints(robot, side))] = here.angles + fraction * (there.angles - here.angles)


def add_finger_keys(postures: Sequence[KeyPosture], fingers: Fingers, robot: Robot) -> tuple[KeyPosture, ...]:
    """Add finger keys between the first and the last posture.

    Their times differ from those of all other keys.
    """
    if not fingers or len(postures) < 2:
        return tuple(postures)
    used_times = {posture.time for posture in postures}
    added: dict[float, KeyPosture] = {}
    first, last = postures[0].time, postures[-1].time
    for side, keys in fingers.items():
        joints = list(finger_joints(robot, side))
        for key in keys:
            time = key.time
            while time in used_times:
                time += KEY_SPACING
            if first < time < last:
                added[time] = _keyed(added.get(time), time, joints, key.angles, robot)
    return tuple(sorted([*postures, *added.values()], key=lambda posture: posture.time))


def _keyed(before: KeyPosture | None, time: float, joints: list[int], angles: Floats, robot: Robot) -> KeyPosture:
    """Return a copied key, or a new one, with finger angles."""
    base = before or KeyPosture(time, robot.skeleton.rest, (False,) * len(robot.skeleton.hinges), is_exact=False)
    new_angles, keyed = base.angles.copy(), np.array(base.keyed)
    new_angles[joints], keyed[joints] = angles, True
    return replace(base, angles=sealed(new_angles), keyed=tuple(bool(key) for key in keyed))
