"""Gesture space: McNeill's sectors as numbers, and the way from there into the world.

Three axes, written for a hand's own side: forward, outward (to the hand's own side) and up. The origin is
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
SECTORS: Mapping[Axis, Mapping[str, float]] = {
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

EASY_REACH = 0.95  # [arm lengths] from the shoulder, beyond which spatial extent takes no hand
FARTHEST_PLACE = 5.0  # [arm lengths] from the origin that a place may be: any hand falls short of it
HAND_GAP = 0.24  # [arm lengths] least distance between wrists or fingertips of two hands, each about 0.12 thick

_HAND_LENGTH = 0.2  # [arm lengths] wrist to fingertips
_HANGING_ELBOW = sealed([0.02, 0.42, 0.0])  # forward, outward, up: where the forearm comes from
_FOLDED = {axis: {name.lower(): value for name, value in sectors.items()} for axis, sectors in SECTORS.items()}
_GROWTH = sealed([0.25, 1.3, 0.6])  # forward, outward, up: spatial extent above 0
_SHRINKING = sealed([0.25, 0.7, 0.35])  # and below


def sector(axis: Axis, name: str) -> float:
    """Looks up the centre of a sector on one axis [arm lengths]; case does not matter.

    Raises:
        ValueError: the axis has no such sector.
    """
    try:
        return _FOLDED[axis][name.lower()]
    except KeyError:
        raise ValueError(f"{name} is no sector of {axis}; known: {', '.join(SECTORS[axis])}") from None


def position(x: str | float, y: str | float, z: str | float) -> Floats:
    """Converts sector names or numbers in Greta's order to a position in gesture space.

    Args:
        x: outward, a sector such as `XC` or [arm lengths].
        y: up, a sector such as `YCC` or [arm lengths].
        z: forward, a sector such as `ZNear` or [arm lengths].

    Returns:
        (3,) forward, outward, up [arm lengths].

    Raises:
        ValueError: a name is no sector of its axis, or a number is where no hand can be.
    """
    outward, up, forward = (
        sector(axis, value) if isinstance(value, str) else float(value)
        for axis, value in zip(SECTORS, (x, y, z), strict=True)
    )
    for name, value in (("outward", outward), ("up", up), ("forward", forward)):
        if not abs(value) <= FARTHEST_PLACE:
            what = f"a hand is {value:g} arm lengths {name}, outside [{-FARTHEST_PLACE:g}, {FARTHEST_PLACE:g}]"
            raise ValueError(f"{what}; arms are 1 long, and hands are within 2 of the body's middle")
    return sealed([forward, outward, up])


def direction_in_world(side: Side, direction: Floats) -> Floats:
    """Converts (3,) forward, outward, up of one side to x forward, y left, z up."""
    forward, outward, up = direction
    return sealed([forward, outward if side == "l" else -outward, up])


def to_world(robot: Robot, side: Side, position: Floats) -> Floats:
    """Converts (3,) forward, outward, up [arm lengths] to (3,) [m] in the world, torso upright."""
    return sealed(robot.gesture_origin + robot.arm_length * direction_in_world(side, position))


def extend_position(position: Floats, spatial: float, fixed: tuple[bool, bool, bool] = (False, False, False)) -> Floats:
    """Puts a position under spatial extent (thesis 8.7; Greta's factors, but for more upward shrinking).

    Args:
        position: (3,) forward, outward, up [arm lengths].
        spatial: -1 tight .. 1 wide.
        fixed: axes that stay as they are.

    Returns:
        (3,) forward, outward, up [arm lengths].
    """
    scale = 1.0 + spatial * (_GROWTH if spatial > 0 else _SHRINKING)
    return sealed(np.where(fixed, position, position * scale))


def widen_key(key: StrokeKey, spatial: float, robot: Robot) -> StrokeKey:
    """Puts a stroke key under spatial extent, as far as the arms reach with ease.

    Two hands that would meet are moved apart, unless outward is fixed in both.
    """
    shoulder = _shoulder(robot)
    hands = {
        side: replace(pose, position=_at_extent(pose.position, spatial, pose.fixed, shoulder))
        for side, pose in key.hands.items()
    }
    wide = StrokeKey(hands)
    return wide if all(pose.fixed[1] for pose in hands.values()) else spread_hands(wide)


def _shoulder(robot: Robot) -> Floats:
    """(3,) forward, outward, up of a shoulder's centre [arm lengths]."""
    centre = robot.skeleton.straight.origins[robot.arm("l").shoulder]
    return sealed((centre - robot.gesture_origin) / robot.arm_length)


def _at_extent(position: Floats, spatial: float, fixed: tuple[bool, bool, bool], shoulder: Floats) -> Floats:
    """A position under spatial extent; above 0 in proportion, so that the widest is still reached with ease."""
    if spatial <= 0.0:
        return extend_position(position, spatial, fixed)
    widest = _reached(position, extend_position(position, 1.0, fixed), shoulder)
    return sealed(position + spatial * (widest - position))


def shift_position(position: Floats, shift: Floats, robot: Robot) -> Floats:
    """Moves a position (3,) by a shift (3,) [arm lengths], as far as the arm reaches with ease."""
    return sealed(_reached(position, position + shift, _shoulder(robot)))


def _reached(position: Floats, wide: Floats, shoulder: Floats) -> Floats:
    """On the way from a position to a wider one, the last that the arm reaches with ease, or the position itself."""
    way, out = wide - position, position - shoulder
    radius = max(EASY_REACH, float(np.linalg.norm(out)))
    if float(np.linalg.norm(wide - shoulder)) <= radius:
        return wide
    a, b, c = float(way @ way), float(way @ out), float(out @ out) - radius**2
    return sealed(position + (sqrt(max(0.0, b * b - a * c)) - b) / a * way)


def spread_hands(key: StrokeKey) -> StrokeKey:
    """Moves both hands outward by equal parts, as far as wrists and fingertips need to pass clear."""
    if len(key.hands) < 2:
        return key
    left, right = (_ends(side, key.hands[side]) for side in SIDES)
    along, across, height = np.moveaxis(left[:, None] - right[None, :], -1, 0)
    needed = np.sqrt(np.maximum(HAND_GAP**2 - along**2 - height**2, 0.0))
    missing = float(np.max(np.where(needed > 0, needed - across, 0.0)))
    if missing <= 0:
        return key
    step = np.array([0.0, missing / 2, 0.0])
    return StrokeKey({side: replace(pose, position=sealed(pose.position + step)) for side, pose in key.hands.items()})


def _ends(side: Side, pose: HandPose) -> Floats:
    """(2, 3) x forward, y left, z up [arm lengths] of wrist and fingertips.

    The hand is taken half-way between the line of the forearm and the direction asked for, as far as a wrist bends.
    """
    along = _unit(pose.position - _HANGING_ELBOW)
    if pose.pointing is not None:
        along = _unit(along + pose.pointing)
    return np.array([direction_in_world(side, pose.position + far * along) for far in (0.0, _HAND_LENGTH)])


def _unit(vector: Floats) -> Floats:
    """A vector of length 1; zero stays zero."""
    length = float(np.linalg.norm(vector))
    return vector / length if length > 0 else vector
