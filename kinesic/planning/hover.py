"""Keeps the hands of one posture clear of the body, and lays them on it where they touch: as a hover."""

from collections.abc import Mapping

from kinesic.body.arrays import Floats
from kinesic.body.dynamics import Distances
from kinesic.body.robot import Robot, Side
from kinesic.expressivity.keyframes import Hand, Touch
from kinesic.planning.apart import apart

HOVER = 0.015  # [m]
NEAR_ENOUGH = 0.12  # [m] a hand that is farther from what it touches stays where it is
OTHER: Mapping[Side, Side] = {"l": "r", "r": "l"}


def clear_hands(angles: Floats, hands: Mapping[Side, Hand], robot: Robot, distances: Distances) -> Floats:
    """Moves arms as little as needed until the posture keeps the hover distance; touching hands come as near as it.

    Args:
        angles: (n,) [rad] the posture as solved.
        hands: that may move.
        robot: the robot.
        distances: its self-distance.

    Returns:
        (n,) [rad]; the posture as it was when none near it keeps the distance.
    """
    moving = {side: hand for side, hand in hands.items() if hand.reach is not None}
    joints = [joint for side in moving for joint in robot.joints(f"{side}_arm")]
    if not moving:
        return angles
    gaps = distances.gaps(angles[None])[0]
    asked = {touched(side, hand.touch, robot) for side, hand in moving.items() if hand.touch is not None}
    touching = sorted(pair for pair in asked if pair is not None and gaps[pair] <= NEAR_ENOUGH)
    if gaps.min(initial=HOVER) >= HOVER and not touching:
        return angles
    found = apart(angles, joints, robot, distances, least=HOVER, touching=touching)
    if found is None and touching:
        found = apart(angles, joints, robot, distances, least=HOVER)
    return angles if found is None else found


def touched(side: Side, touch: Touch, robot: Robot) -> int | None:
    """Index among the counted pairs of a hand and what it touches; None when this pair does not count."""
    hand, part = robot.chains[f"{side}_arm"][-1], _segment(side, touch, robot)
    found = [k for k, pair in enumerate(robot.counted_pairs) if set(pair) == {hand, part}]
    return found[0] if found else None


def _segment(side: Side, touch: Touch, robot: Robot) -> str | None:
    """The segment that a word names, for a hand; None when the robot lacks it."""
    arm, torso, neck = robot.chains[f"{OTHER[side]}_arm"], robot.chains.get("torso"), robot.chains.get("neck")
    match touch:
        case "hand":
            return arm[-1]
        case "forearm":
            return arm[-2]
        case "upper_arm":
            return arm[-3]
        case "head":
            return neck[-1] if neck else None
        case "chest":
            return torso[-1] if torso else None
        case "lap":
            return robot.skeleton.segments[robot.skeleton.segment(torso[0])].parent if torso else None
