"""Puts the keys of fingers among the postures of a block.

They are keys on a path: the motion follows them as far as its limits allow, and never moves a stroke for them.
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

KEY_SPACING = 1e-4  # [s] between keys of fingers and others
Fingers = Mapping[Side, Sequence[FingerKey]]


def set_fingers(angles: Floats, time: float, fingers: Fingers, robot: Robot) -> None:
    """Bends the fingers in a posture (n,) [rad] as they are at a block time [s]."""
    for side, keys in fingers.items():
        after = bisect_right([key.time for key in keys], time)
        here, there = keys[max(after - 1, 0)], keys[min(after, len(keys) - 1)]
        share = (time - here.time) / (there.time - here.time) if 0 < after < len(keys) else 0.0
        angles[list(finger_joints(robot, side))] = here.angles + share * (there.angles - here.angles)


def with_finger_keys(postures: Sequence[KeyPosture], fingers: Fingers, robot: Robot) -> tuple[KeyPosture, ...]:
    """Adds the keys of both hands' fingers between the first and the last posture, none at the time of another one."""
    if not fingers or len(postures) < 2:
        return tuple(postures)
    taken = {posture.time for posture in postures}
    added: dict[float, KeyPosture] = {}
    first, last = postures[0].time, postures[-1].time
    for side, keys in fingers.items():
        joints = list(finger_joints(robot, side))
        for key in keys:
            time = key.time
            while time in taken:
                time += KEY_SPACING
            if first < time < last:
                added[time] = _keyed(added.get(time), time, joints, key.angles, robot)
    return tuple(sorted([*postures, *added.values()], key=lambda posture: posture.time))


def _keyed(before: KeyPosture | None, time: float, joints: list[int], angles: Floats, robot: Robot) -> KeyPosture:
    """A key of some fingers, and of those that have one at the same time."""
    base = before or KeyPosture(time, robot.skeleton.rest, (False,) * len(robot.skeleton.hinges), firm=False)
    found, keyed = base.angles.copy(), np.array(base.keyed)
    found[joints], keyed[joints] = angles, True
    return replace(base, angles=sealed(found), keyed=tuple(bool(key) for key in keyed))
