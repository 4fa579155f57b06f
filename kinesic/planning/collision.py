"""Keeps postures clear of the body: the nearest one whose segments keep apart, and hands that hover where they touch.

The nearest posture is found by least squares with linear rows, a few times over.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import scipy

from kinesic.body.arrays import Floats
from kinesic.body.dynamics import Distances
from kinesic.body.robot import OTHER_SIDE, SIDES, Robot, Side
from kinesic.expressivity.keyframes import Hand, Touch

ROUNDS = 12
EXACT = 2e-4  # [m] over what is asked, by which the last round may fall short
SLACK = 3e-3  # [m] by which a touching pair may be farther apart than asked
SIGHT = 0.08  # [m] over what was asked: pairs farther apart play no part in a step
PROBE = 1e-4  # [rad] for the gradient
STRIDE = 0.15  # [rad] that a hinge turns in one round
DISPLACEMENT = 0.05  # [m] of a hand that counts like a turn of 1 rad of a hinge: elbows swing before hands move
UNMOVED = 1e-6  # [m/rad] a pair whose gap changes less is not moved by the joints
NONE = 1e-9
HOVER = 0.015  # [m]
NEAR_ENOUGH = 0.12  # [m] a hand that is farther from what it touches stays where it is


@dataclass(frozen=True)
class Spacing:
    """How far apart segments are kept."""

    least: float  # [m] between those of every counted pair
    room: float | None = None  # [m] to which pairs go apart that are nearer, and within which no others come nearer
    touching: tuple[int, ...] = ()  # counted pairs that come as near as `least`


def separate(
    angles: Floats, joints: Sequence[int], robot: Robot, distances: Distances, spacing: Spacing
) -> Floats | None:
    """Finds the posture near another one in which every counted pair that some joints move keeps a distance.

    Each round takes the smallest step for which all gaps suffice to first order. Small means: little turning of
    hinges, and above all little displacement of wrists and palms, so that elbows swing aside before hands move.

    Args:
        angles: (n,) [rad].
        joints: that may turn.
        robot: whose posture it is.
        distances: its self-distance.
        spacing: what is kept.

    Returns:
        (n,) [rad]; None when no such posture was found.
    """
    posture, moving = np.array(angles), np.array(joints, dtype=int)
    least, room, met = spacing.least, spacing.room or spacing.least, list(spacing.touching)
    begun = distances.gaps(posture[None])[0]
    asked = np.where(begun < least, room, np.minimum(begun, room)) + EXACT
    for _ in range(ROUNDS):
        probes = np.repeat(posture[None, :], len(moving) + 1, axis=0)
        probes[np.arange(1, len(moving) + 1), moving] += PROBE
        gaps = distances.gaps(probes)
        slopes, lack = (gaps[1:] - gaps[0]).T / PROBE, asked - gaps[0]
        lack[np.abs(slopes).max(axis=1, initial=0.0) < UNMOVED] = -np.inf
        if lack.max(initial=0.0) <= EXACT and gaps[0, met].max(initial=0.0) <= least + SLACK:
            return posture
        near = lack > -SIGHT
        bounds = robot.skeleton.lower[moving] - posture[moving], posture[moving] - robot.skeleton.upper[moving]
        one = np.eye(len(moving))
        rows = np.concatenate([slopes[near], -slopes[met], one, -one])
        step = _smallest(
            rows, np.concatenate([lack[near], gaps[0, met] - least - SLACK / 2, *bounds]), _metric(probes, robot)
        )
        if step is None:
            return None
        posture[moving] += step * min(1.0, STRIDE / max(NONE, float(np.abs(step).max())))
        posture = robot.skeleton.clamp(posture)
    return None


def _metric(probes: Floats, robot: Robot) -> Floats:
    """(k, k) cost of a step of k hinges: turns, and the displacement of wrists and palms, for (k + 1, n) [rad]."""
    frames = robot.skeleton.frames(probes)
    points = []
    for side in SIDES:
        palm = robot.arm(side).palm
        k = robot.skeleton.segment(palm.segment)
        points += [frames.origins[:, k], frames.origins[:, k] + frames.rotations[:, k] @ palm.position]
    where = np.concatenate(points, axis=1)
    moved = (where[1:] - where[0]) / PROBE / DISPLACEMENT
    cost: Floats = np.eye(len(moved)) + moved @ moved.T
    return cost


def _smallest(rows: Floats, needed: Floats, metric: Floats) -> Floats | None:
    """Smallest step with rows @ step >= needed (Lawson and Hanson's least distance programming).

    Rows that contradict one another are met by halves, thrice at most.
    """
    root = np.linalg.cholesky(metric)
    within = np.linalg.solve(root, rows.T)
    for share in (1.0, 0.5, 0.25, 0.125):
        asked = np.where(needed > 0, share * needed, needed)
        system = np.vstack([within, asked])
        multipliers, _ = scipy.optimize.nnls(system, np.append(np.zeros(len(within)), 1.0))
        residual = system @ multipliers
        if 1.0 - residual[-1] > NONE:
            step: Floats = np.linalg.solve(root.T, residual[:-1] / (1.0 - residual[-1]))
            return step
    return None


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
    joints = [joint for side in moving for joint in robot.arm(side).joints]
    if not moving:
        return angles
    gaps = distances.gaps(angles[None])[0]
    asked = {touched_pair(side, hand.touch, robot, gaps) for side, hand in moving.items() if hand.touch is not None}
    touching = tuple(sorted(pair for pair in asked if pair is not None and gaps[pair] <= NEAR_ENOUGH))
    if gaps.min(initial=HOVER) >= HOVER and not touching:
        return angles
    found = separate(angles, joints, robot, distances, Spacing(HOVER, touching=touching))
    if found is None and touching:
        found = separate(angles, joints, robot, distances, Spacing(HOVER))
    return angles if found is None else found


def touched_pair(side: Side, touch: Touch, robot: Robot, gaps: Floats) -> int | None:
    """Finds the counted pair with which a hand touches something: its fingers or its palm, whichever is nearer.

    Args:
        side: of the hand.
        touch: what it is laid on.
        robot: whose hand it is.
        gaps: (p,) [m] of all counted pairs.

    Returns:
        Index of the pair; None when none of them counts.
    """
    part, other = _segment(side, touch, robot), f"{OTHER_SIDE[side]}_fingers"
    hand, parts = {robot.arm(side).segments[-1], f"{side}_fingers"}, {part, other} if touch == "hand" else {part}
    found = [
        k for k, (a, b) in enumerate(robot.counted_pairs) if (a in hand and b in parts) or (b in hand and a in parts)
    ]
    return min(found, key=lambda k: float(gaps[k]), default=None)


def _segment(side: Side, touch: Touch, robot: Robot) -> str | None:
    """Segment that a word names, for a hand; None when the robot lacks it."""
    arm, torso, neck = robot.arm(OTHER_SIDE[side]).segments, robot.chains.get("torso"), robot.chains.get("neck")
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
