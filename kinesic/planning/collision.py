"""Nearest collision-free postures, and hover distance of touching hands.

The nearest posture is found by repeated least-squares steps with linear constraints.
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

MAX_STEPS = 12  # least-squares iterations per posture
GAP_TOLERANCE = 2e-4  # [m] accepted shortfall of the required distance after the last iteration
TOUCH_TOLERANCE = 3e-3  # [m] accepted excess over the required distance of a touching pair
CONSTRAINT_RANGE = 0.08  # [m] excess over the required distance above which pairs are ignored
DIFFERENCE_STEP = 1e-4  # [rad] joint step of the finite-difference gradient
MAX_HINGE_STEP = 0.15  # [rad] largest rotation of a hinge per iteration
EQUIVALENT_DISPLACEMENT = 0.05  # [m] hand displacement that costs as much as 1 rad, so that elbows move first
MIN_GAP_GRADIENT = 1e-6  # [m/rad] distance gradient below which a pair is ignored
LENGTH_EPSILON = 1e-9  # smallest divisor, which avoids division by zero
HOVER_DISTANCE = 0.015  # [m] distance that a touching hand keeps from the body
MAX_TOUCH_DISTANCE = 0.12  # [m] a hand farther from the touched part does not approach it


@dataclass(frozen=True)
class Spacing:
    """Required and desired distances between pairs of body segments."""

    least: float  # [m] required for every counted pair
    room: float | None = None  # [m] target of pairs below `least`; pairs within it come no nearer
    touching: tuple[int, ...] = ()  # counted pairs that approach to `least`
    tips: tuple["TipTouch", ...] = ()  # fingertips that approach to `least`


@dataclass(frozen=True, eq=False)
class TipTouch:
    """Fingertip with the segment or opposite fingertip that it touches."""

    robot: Robot
    tip: FingerTip
    other: FingerTip | int  # index of a segment, or another fingertip

    @classmethod
    def of(cls, side: Side, hand: Hand, robot: Robot) -> "TipTouch | None":
        """Return the fingertip contact of a hand, if it has one."""
        tip = robot.finger_tips(side).get(hand.tip or "")
        if tip is None or hand.touch is None:
            return None
        part = _segment(side, hand.touch, robot)
        other = robot.finger_tips(OTHER_SIDE[side]).get(hand.tip or "") if hand.touch == "hand" else None
        if other is None and part is None:
            return None
        return cls(robot, tip, other or robot.skeleton.segment(part or ""))

    def gaps(self, angles: Floats) -> Floats:
        """Compute fingertip distances (m,) [m] to the touched part."""
        frames = self.robot.skeleton.frames(angles)
        here = _tip_place(frames, self.tip)
        if isinstance(self.other, FingerTip):
            apart = np.linalg.norm(here - _tip_place(frames, self.other), axis=1)
            return np.asarray(apart - self.tip.radius - self.other.radius)
        rotations, origins = frames.rotations[:, self.other], frames.origins[:, self.other]
        rows = []
        for capsule in self.robot.skeleton.segments[self.other].capsules:
            start, direction = origins + rotations @ capsule.start, rotations @ (capsule.end - capsule.start)
            fraction = np.einsum("mk,mk->m", here - start, direction) / max(
                float(np.sum(direction[0] ** 2)), LENGTH_EPSILON
            )
            nearest = start + np.clip(fraction, 0.0, 1.0)[:, None] * direction
            rows.append(np.linalg.norm(here - nearest, axis=1) - capsule.radius)
        return np.asarray(np.min(rows, axis=0, initial=np.inf) - self.tip.radius)


def _tip_place(frames: Frames, tip: FingerTip) -> Floats:
    """Return the position of a fingertip in the world, (m, 3) [m]."""
    place: Floats = frames.origins[:, tip.segment] + frames.rotations[:, tip.segment] @ tip.place
    return place


def separate(
    angles: Floats, joints: Sequence[int], robot: Robot, distances: Distances, spacing: Spacing
) -> Floats | None:
    """Find the nearest posture without collisions.

    Every pair of segments that the joints move keeps its distance. Each round takes the smallest step that satisfies
    all gaps to first order. The step size weights hinge rotation, and above all displacement of wrists and palms, so
    that elbows move before hands.

    Args:
        angles: (n,) [rad].
        joints: that may turn; pairs that they do not move are ignored.
        robot: the robot.
        distances: self-distances of the robot.
        spacing: required distances.

    Returns:
        (n,) [rad]; None if no such posture was found.
    """
    posture, moving = np.array(angles), np.array(joints, dtype=int)
    least, room, touching = spacing.least, spacing.room or spacing.least, list(spacing.touching)
    initial_gaps = distances.gaps(posture[None])[0]
    required = np.where(initial_gaps < least, room, np.minimum(initial_gaps, room)) + GAP_TOLERANCE
    for _ in range(MAX_STEPS):
        probes = np.repeat(posture[None, :], len(moving) + 1, axis=0)
        probes[np.arange(1, len(moving) + 1), moving] += DIFFERENCE_STEP
        gaps = distances.gaps(probes)
        tips = np.array([touch.gaps(probes) for touch in spacing.tips]).reshape(-1, len(probes))
        slopes, missing = (gaps[1:] - gaps[0]).T / DIFFERENCE_STEP, required - gaps[0]
        missing[np.abs(slopes).max(axis=1, initial=0.0) < MIN_GAP_GRADIENT] = -np.inf
        closest = max(gaps[0, touching].max(initial=0.0), tips[:, 0].max(initial=0.0))
        if missing.max(initial=0.0) <= GAP_TOLERANCE and closest <= least + TOUCH_TOLERANCE:
            return posture
        is_near = missing > -CONSTRAINT_RANGE
        bounds = robot.skeleton.lower[moving] - posture[moving], posture[moving] - robot.skeleton.upper[moving]
        identity = np.eye(len(moving))
        approach = (tips[:, 1:] - tips[:, :1]) / DIFFERENCE_STEP
        rows = np.concatenate([slopes[is_near], -slopes[touching], -approach, identity, -identity])
        nearer = np.concatenate([gaps[0, touching], tips[:, 0]]) - least - TOUCH_TOLERANCE / 2
        step = _smallest(rows, np.concatenate([missing[is_near], nearer, *bounds]), _metric(probes, robot))
        if step is None:
            return None
        posture[moving] += step * min(1.0, MAX_HINGE_STEP / max(LENGTH_EPSILON, float(np.abs(step).max())))
        posture = robot.skeleton.clamp(posture)
    return None


def _metric(probes: Floats, robot: Robot) -> Floats:
    """Compute the cost matrix (k, k) of small rotations of k hinges.

    It weights rotations and the displacement of wrists and palms.

    Args:
        probes: (k + 1, n) [rad] the posture, then each hinge displaced.
        robot: the robot.
    """
    palms = [robot.arm(side).palm for side in SIDES]
    segments = [robot.skeleton.segment(palm.segment) for palm in palms]
    frames = robot.skeleton.frames(probes, without=robot.skeleton.segments_off_path(frozenset(segments)))
    points = []
    for k, palm in zip(segments, palms, strict=True):
        points += [frames.origins[:, k], frames.origins[:, k] + frames.rotations[:, k] @ palm.position]
    positions = np.concatenate(points, axis=1)
    displacements = (positions[1:] - positions[0]) / DIFFERENCE_STEP / EQUIVALENT_DISPLACEMENT
    cost: Floats = np.eye(len(displacements)) + displacements @ displacements.T
    return cost


def _smallest(rows: Floats, needed: Floats, metric: Floats) -> Floats | None:
    """Find the cheapest joint step that satisfies linear distance constraints.

    The constraints are rows @ step >= needed. Uses least distance programming (Lawson and Hanson). Contradictory rows
    are halved, three times at most.
    """
    root = np.linalg.cholesky(metric)
    within = np.linalg.solve(root, rows.T)
    for fraction in (1.0, 0.5, 0.25, 0.125):
        required = np.where(needed > 0, fraction * needed, needed)
        system = np.vstack([within, required])
        multipliers, _ = scipy.optimize.nnls(system, np.append(np.zeros(len(within)), 1.0))
        residual = system @ multipliers
        if 1.0 - residual[-1] > LENGTH_EPSILON:
            step: Floats = np.linalg.solve(root.T, residual[:-1] / (1.0 - residual[-1]))
            return step
    return None


def clear_hands(
    angles: Floats, hands: Mapping[Side, Hand], robot: Robot, distances: Distances, gaps: Floats | None = None
) -> Floats:
    """Move the arms until the hands keep the hover distance.

    Arms move as little as possible. Touching hands come as near as the hover distance, with the requested fingertip if
    possible, otherwise with the nearest part.

    Args:
        angles: (n,) [rad] solved posture.
        hands: that may move.
        robot: the robot.
        distances: self-distances of the robot.
        gaps: (p,) [m] of all counted pairs in this posture, if available.

    Returns:
        (n,) [rad]; the given posture if none near it keeps the distance.
    """
    moving = {side: hand for side, hand in hands.items() if hand.reach is not None}
    joints = [joint for side in moving for joint in robot.arm(side).joints]
    if not moving:
        return angles
    gaps = distances.gaps(angles[None])[0] if gaps is None else gaps
    required = {touched_pair(side, hand.touch, robot, gaps) for side, hand in moving.items() if hand.touch is not None}
    touching = tuple(sorted(pair for pair in required if pair is not None and gaps[pair] <= MAX_TOUCH_DISTANCE))
    if gaps.min(initial=HOVER_DISTANCE) >= HOVER_DISTANCE and not touching:
        return angles
    tips = {side: tip for side, hand in moving.items() if (tip := TipTouch.of(side, hand, robot)) is not None}
    led = {touched_pair(side, moving[side].touch or "hand", robot, gaps) for side in tips}
    meant = Spacing(
        HOVER_DISTANCE, touching=tuple(pair for pair in touching if pair not in led), tips=tuple(tips.values())
    )
    attempts = [meant] * bool(tips and touching) + [Spacing(HOVER_DISTANCE, touching=touching)] * bool(touching)
    for spacing in [*attempts, Spacing(HOVER_DISTANCE)]:
        result = separate(angles, joints, robot, distances, spacing)
        if result is not None:
            return result
    return angles


def touched_pair(side: Side, touch: Touch, robot: Robot, gaps: Floats) -> int | None:
    """Find the segments of a hand and the body part it touches.

    Args:
        side: of the hand.
        touch: touched body part.
        robot: the robot.
        gaps: (p,) [m] of all counted pairs.

    Returns:
        Index of the nearest pair of fingers or palm; None if no such pair is counted.
    """
    part, other = _segment(side, touch, robot), f"{OTHER_SIDE[side]}_fingers"
    hand, parts = {robot.arm(side).segments[-1], f"{side}_fingers"}, {part, other} if touch == "hand" else {part}
    result = [
        k for k, (a, b) in enumerate(robot.counted_pairs) if (a in hand and b in parts) or (b in hand and a in parts)
    ]
    return min(result, key=lambda k: float(gaps[k]), default=None)


def _segment(side: Side, touch: Touch, robot: Robot) -> str | None:
    """Return the segment of a touched body part, if any."""
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
