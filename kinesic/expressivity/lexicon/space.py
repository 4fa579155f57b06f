"""Gesture space: McNeill's sectors as coordinates, and conversion to the world.

Axes, for a hand's own side: forward, outward (to the hand's own side) and up. The origin is
`Robot.gesture_origin` (midline, depth of the shoulders, height of the hanging elbows), the unit is the arm length.
"""

from collections.abc import Mapping
from dataclasses import replace
from math import sqrt
from typing import Literal

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.robot import SIDES, Robot, Side
from kinesic.expressivity.lexicon.form import HandPose, StrokeKey

Axis = Literal["x", "y", "z"]

# Centres of McNeill's sectors [arm lengths], after Greta's `SymbolicPosition` (thesis 8.7).
SECTOR_CENTRES: Mapping[Axis, Mapping[str, float]] = {
    "x": {"XEP": 0.8, "XP": 0.5, "XC": 0.25, "XCC": 0.0, "XOppC": -0.25},
    "y": {
        "YUpperEP": 1.2,
        "YUpperP": 0.9,
        "YUpperC": 0.6,
        "YCC": 0.25,
        "YLowerC": 0.0,
        "YLowerP": -0.3,
        "YLowerEP": -0.5,
    },
    "z": {"ZNear": 0.4, "ZMiddle": 0.65, "ZFar": 0.95},
}

EASY_REACH = 0.95  # [arm lengths] largest distance from the shoulder to which spatial extent moves a hand
CAPTURED_REACH = 0.97  # [arm lengths] largest distance of a captured wrist from the shoulder of a robot
MAX_COORDINATE = 5.0  # [arm lengths] largest accepted coordinate, beyond the reach of any hand
HAND_GAP = 0.24  # [arm lengths] smallest distance between wrists or fingertips; hands are about 0.12 thick

_HAND_LENGTH = 0.2  # [arm lengths] distance from wrist to fingertips
# [arm lengths] position of a hanging elbow in gesture space: forward, outward from the midline, up from YLowerC.
_HANGING_ELBOW = sealed([0.02, 0.42, 0.0])
_SECTORS_BY_NAME = {
    axis: {name.lower(): value for name, value in sectors.items()} for axis, sectors in SECTOR_CENTRES.items()
}
_GROWTH_FACTORS = sealed([0.25, 1.3, 0.6])  # relative growth forward, outward, up per unit of extent above 0
_SHRINKING_FACTORS = sealed([0.25, 0.7, 0.35])  # relative shrinking forward, outward, up per unit of extent below 0


def sector(axis: Axis, name: str) -> float:
    """Return the centre of a sector on one axis [arm lengths].

    Raises:
        ValueError: the axis has no such sector.
    """
    try:
        return _SECTORS_BY_NAME[axis][name.lower()]
    except KeyError:
        raise ValueError(f"{name} is no sector of {axis}; known: {', '.join(SECTOR_CENTRES[axis])}") from None


def position(x: str | float, y: str | float, z: str | float) -> Floats:
    """Convert sector names or numbers of three axes to gesture space coordinates.

    Args:
        x: outward, a sector such as `XC` or [arm lengths].
        y: up, a sector such as `YCC` or [arm lengths].
        z: forward, a sector such as `ZNear` or [arm lengths].

    Returns:
        (3,) forward, outward, up [arm lengths].

    Raises:
        ValueError: a name is no sector of its axis, or a number is out of reach of any hand.
    """
    outward, up, forward = (
        sector(axis, value) if isinstance(value, str) else float(value)
        for axis, value in zip(SECTOR_CENTRES, (x, y, z), strict=True)
    )
    for name, value in (("outward", outward), ("up", up), ("forward", forward)):
        if not abs(value) <= MAX_COORDINATE:
            problem = f"a hand is {value:g} arm lengths {name}, outside [{-MAX_COORDINATE:g}, {MAX_COORDINATE:g}]"
            raise ValueError(f"{problem}; arms are 1 long, and hands are within 2 of the body's middle")
    return sealed([forward, outward, up])


def direction_in_world(side: Side, direction: Floats) -> Floats:
    """Convert a direction (3,) forward, outward, up to world axes.

    World axes: x forward, y left, z up.
    """
    forward, outward, up = direction
    return np.array([forward, outward if side == "l" else -outward, up])


def to_world(robot: Robot, side: Side, position: Floats) -> Floats:
    """Convert a gesture space position to the world with the torso upright.

    Args:
        robot: gives the origin and the arm length.
        side: of the hand.
        position: (3,) forward, outward, up [arm lengths].

    Returns:
        (3,) [m].
    """
    return np.asarray(robot.gesture_origin + robot.arm_length * direction_in_world(side, position))


def to_gesture_space(robot: Robot, side: Side, position: Floats) -> Floats:
    """Convert a world position [m] to gesture space, with the torso upright.

    It is the inverse of `to_world`: (3,) forward, outward, up [arm lengths].
    """
    return direction_in_world(side, position - robot.gesture_origin) / robot.arm_length


def extend_position(position: Floats, spatial: float, fixed: tuple[bool, bool, bool] = (False, False, False)) -> Floats:
    """Scale a position by spatial extent.

    The factors are Greta's (thesis 8.7), except for stronger upward shrinking.

    Args:
        position: (3,) forward, outward, up [arm lengths].
        spatial: -1 tight .. 1 wide.
        fixed: axes that do not change.

    Returns:
        (3,) forward, outward, up [arm lengths].
    """
    scale = 1.0 + spatial * (_GROWTH_FACTORS if spatial > 0 else _SHRINKING_FACTORS)
    return np.where(fixed, position, position * scale)


def widen_key(key: StrokeKey, spatial: float, robot: Robot) -> StrokeKey:
    """Scale a stroke key by spatial extent, within easy reach.

    Two hands that would meet are moved apart, unless they touch or outward is fixed in both.
    """
    shoulder = _shoulder(robot)
    hands = {
        side: replace(pose, position=_at_extent(pose.position, spatial, pose.fixed, shoulder))
        for side, pose in key.hands.items()
    }
    wide = StrokeKey(hands)
    return wide if all(pose.fixed[1] for pose in hands.values()) else spread_hands(wide)


def _shoulder(robot: Robot) -> Floats:
    """Return the centre of a shoulder, (3,) forward, outward, up [arm lengths]."""
    centre = robot.skeleton.zero_frames.origins[robot.arm("l").shoulder]
    return sealed((centre - robot.gesture_origin) / robot.arm_length)


def _at_extent(position: Floats, spatial: float, fixed: tuple[bool, bool, bool], shoulder: Floats) -> Floats:
    """Scale a position [arm lengths] by spatial extent, within easy reach.

    Above 0 the shift is proportional to the extent, so that the widest position is still within easy reach.
    """
    if spatial <= 0.0:
        return extend_position(position, spatial, fixed)
    widest = _limit_reach(position, extend_position(position, 1.0, fixed), shoulder)
    return np.asarray(position + spatial * (widest - position))


def shift_position(position: Floats, shift: Floats, robot: Robot) -> Floats:
    """Shift a position [arm lengths], limited to easy reach."""
    return _limit_reach(position, position + shift, _shoulder(robot))


def widen_position(position: Floats, spatial: float, fixed: tuple[bool, bool, bool], robot: Robot) -> Floats:
    """Scale a position by spatial extent, within easy reach [arm lengths]."""
    return _at_extent(position, spatial, fixed, _shoulder(robot))


def pull_within_reach(position: Floats, robot: Robot) -> Floats:
    """Move a position towards the shoulder into the arm's reach [arm lengths]."""
    shoulder = _shoulder(robot)
    distance = float(np.linalg.norm(position - shoulder))
    return position if distance <= CAPTURED_REACH else shoulder + (CAPTURED_REACH / distance) * (position - shoulder)


def _limit_reach(position: Floats, wide: Floats, shoulder: Floats) -> Floats:
    """Move a position towards a wider position, within easy reach [arm lengths]."""
    step, out = wide - position, position - shoulder
    radius = max(EASY_REACH, float(np.linalg.norm(out)))
    if float(np.linalg.norm(wide - shoulder)) <= radius:
        return wide
    a, b, c = float(step @ step), float(step @ out), float(out @ out) - radius**2
    return np.asarray(position + (sqrt(max(0.0, b * b - a * c)) - b) / a * step)


def spread_hands(key: StrokeKey) -> StrokeKey:
    """Move both hands outward until wrists and fingertips are clear.

    Hands that touch each other stay.
    """
    if len(key.hands) < 2 or any(pose.touch == "hand" for pose in key.hands.values()):
        return key
    left, right = (_ends(side, key.hands[side]) for side in SIDES)
    along, across, height = np.moveaxis(left[:, None] - right[None, :], -1, 0)
    needed = np.sqrt(np.maximum(HAND_GAP**2 - along**2 - height**2, 0.0))
    missing = float(np.max(np.where(needed > 0, needed - across, 0.0)))
    if missing <= 0:
        return key
    step = np.array([0.0, missing / 2, 0.0])
    return StrokeKey({side: replace(pose, position=pose.position + step) for side, pose in key.hands.items()})


def _ends(side: Side, pose: HandPose) -> Floats:
    """Estimate the wrist and fingertip positions of a hand pose.

    The hand lies half-way between the line of the forearm and its requested direction, as far as a wrist bends.

    Returns:
        (2, 3) x forward, y left, z up [arm lengths].
    """
    along = _unit(pose.position - _HANGING_ELBOW)
    if pose.pointing is not None:
        along = _unit(along + pose.pointing)
    return np.array([direction_in_world(side, pose.position + far * along) for far in (0.0, _HAND_LENGTH)])


def _unit(vector: Floats) -> Floats:
    """Normalise a vector.

    The zero vector stays zero.
    """
    length = float(np.linalg.norm(vector))
    return vector / length if length > 0 else vector
