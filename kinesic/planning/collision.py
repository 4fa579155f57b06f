"""Keeps postures clear of the body: the nearest one whose segments keep apart, and hands that hover where they touch.

The nearest posture is found by least squares with linear rows, a few times over.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import scipy

from kinesic.body.arrays import Floats
from kinesic.body.dynamics import Distances
from kinesic.body.robot import OTHER_SIDE, SIDES, FingerTip, Robot, Side
from kinesic.body.skeleton import Frames
from kinesic.expressivity.keyframes import Hand, Touch

ROUNDS = 12
EXACT = 2e-4  # [m] over what is asked, by which the last round may fall short
SLACK = 3e-3  # [m] by which a touching pair may be farther apart than asked
SIGHT = 0.08  # [m] over what was asked: pairs farther apart play no part in a step
PROBE = 1e-4  # [rad] for the gradient
STRIDE = 0.15  # [rad] that a hinge turns in one round
DISPLACEMENT = 0.05  # [m] of a hand that counts like a turn of 1 rad of a hinge: elbows swing before hands move
UNMOVED = 1e-6  # [m/rad] a pair whose gap changes less is not moved by the joints
NO_LENGTH = 1e-9
HOVER = 0.015  # [m]
NEAR_ENOUGH = 0.12  # [m] a hand that is farther from what it touches stays where it is


@dataclass(frozen=True)
class Spacing:
    """How far apart segments are kept."""

    least: float  # [m] between those of every counted pair
    room: float | None = None  # [m] to which pairs go apart that are nearer, and within which no others come nearer
    touching: tuple[int, ...] = ()  # counted pairs that come as near as `least`
    tips: tuple["TipTouch", ...] = ()  # likewise, tips of fingers


@dataclass(frozen=True, eq=False)
class TipTouch:
    """The tip of a finger and what it comes near to: a segment, or a tip of the other hand."""

    robot: Robot
    tip: FingerTip
    other: FingerTip | int  # a segment by its index

    @classmethod
    def of(cls, side: Side, hand: Hand, robot: Robot) -> "TipTouch | None":
        """What a hand does; None where it touches nothing with a tip, or the robot lacks it."""
        tip = robot.finger_tips(side).get(hand.tip or "")
        if tip is None or hand.touch is None:
            return None
        part = _segment(side, hand.touch, robot)
        other = robot.finger_tips(OTHER_SIDE[side]).get(hand.tip or "") if hand.touch == "hand" else None
        if other is None and part is None:
            return None
        return cls(robot, tip, other or robot.skeleton.segment(part or ""))

    def gaps(self, angles: Floats) -> Floats:
        """(m,) [m] between them, in postures (m, n) [rad]."""
        frames = self.robot.skeleton.frames(angles)
        here = _tip_place(frames, self.tip)
        if isinstance(self.other, FingerTip):
            apart = np.linalg.norm(here - _tip_place(frames, self.other), axis=1)
            return np.asarray(apart - self.tip.radius - self.other.radius)
        rotations, origins = frames.rotations[:, self.other], frames.origins[:, self.other]
        rows = []
        for capsule in self.robot.skeleton.segments[self.other].capsules:
            start, way = origins + rotations @ capsule.start, rotations @ (capsule.end - capsule.start)
            share = np.einsum("mk,mk->m", here - start, way) / max(float(np.sum(way[0] ** 2)), NO_LENGTH)
            nearest = start + np.clip(share, 0.0, 1.0)[:, None] * way
            rows.append(np.linalg.norm(here - nearest, axis=1) - capsule.radius)
        return np.asarray(np.min(rows, axis=0, initial=np.inf) - self.tip.radius)


def _tip_place(frames: Frames, tip: FingerTip) -> Floats:
    """(m, 3) [m] in the world."""
    place: Floats = frames.origins[:, tip.segment] + frames.rotations[:, tip.segment] @ tip.place
    return place


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
        tips = np.array([touch.gaps(probes) for touch in spacing.tips]).reshape(-1, len(probes))
        slopes, lack = (gaps[1:] - gaps[0]).T / PROBE, asked - gaps[0]
        lack[np.abs(slopes).max(axis=1, initial=0.0) < UNMOVED] = -np.inf
        closest = max(gaps[0, met].max(initial=0.0), tips[:, 0].max(initial=0.0))
        if lack.max(initial=0.0) <= EXACT and closest <= least + SLACK:
            return posture
        near = lack > -SIGHT
        bounds = robot.skeleton.lower[moving] - posture[moving], posture[moving] - robot.skeleton.upper[moving]
        one = np.eye(len(moving))
        approach = (tips[:, 1:] - tips[:, :1]) / PROBE
        rows = np.concatenate([slopes[near], -slopes[met], -approach, one, -one])
        nearer = np.concatenate([gaps[0, met], tips[:, 0]]) - least - SLACK / 2
        step = _smallest(rows, np.concatenate([lack[near], nearer, *bounds]), _metric(probes, robot))
        if step is None:
            return None
        posture[moving] += step * min(1.0, STRIDE / max(NO_LENGTH, float(np.abs(step).max())))
        posture = robot.skeleton.clamp(posture)
    return None


def _metric(probes: Floats, robot: Robot) -> Floats:
    """(k, k) cost of a step of k hinges: turns, and the displacement of wrists and palms, for (k + 1, n) [rad]."""
    palms = [robot.arm(side).palm for side in SIDES]
    segments = [robot.skeleton.segment(palm.segment) for palm in palms]
    frames = robot.skeleton.frames(probes, without=robot.skeleton.beside(frozenset(segments)))
    points = []
    for k, palm in zip(segments, palms, strict=True):
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
        if 1.0 - residual[-1] > NO_LENGTH:
            step: Floats = np.linalg.solve(root.T, residual[:-1] / (1.0 - residual[-1]))
            return step
    return None


def clear_hands(
    angles: Floats, hands: Mapping[Side, Hand], robot: Robot, distances: Distances, gaps: Floats | None = None
) -> Floats:
    """Moves arms as little as needed until the posture keeps the hover distance; touching hands come as near as it.

    A hand touches with the tip that is meant, where it has that and can; else with what is nearer.

    Args:
        angles: (n,) [rad] the posture as solved.
        hands: that may move.
        robot: the robot.
        distances: its self-distance.
        gaps: (p,) [m] of all counted pairs in this posture, where they are known.

    Returns:
        (n,) [rad]; the posture as it was when none near it keeps the distance.
    """
    moving = {side: hand for side, hand in hands.items() if hand.reach is not None}
    joints = [joint for side in moving for joint in robot.arm(side).joints]
    if not moving:
        return angles
    gaps = distances.gaps(angles[None])[0] if gaps is None else gaps
    asked = {touched_pair(side, hand.touch, robot, gaps) for side, hand in moving.items() if hand.touch is not None}
    touching = tuple(sorted(pair for pair in asked if pair is not None and gaps[pair] <= NEAR_ENOUGH))
    if gaps.min(initial=HOVER) >= HOVER and not touching:
        return angles
    tips = {side: tip for side, hand in moving.items() if (tip := TipTouch.of(side, hand, robot)) is not None}
    led = {touched_pair(side, moving[side].touch or "hand", robot, gaps) for side in tips}
    meant = Spacing(HOVER, touching=tuple(pair for pair in touching if pair not in led), tips=tuple(tips.values()))
    tries = [meant] * bool(tips and touching) + [Spacing(HOVER, touching=touching)] * bool(touching) + [Spacing(HOVER)]
    for spacing in tries:
        found = separate(angles, joints, robot, distances, spacing)
        if found is not None:
            return found
    return angles


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
