"""Nearest collision-free postures of hovering and touching hands.

The nearest posture is found by repeated least-squares steps with linear constraints.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.body.dynamics import Distances
from kinesic.body.robot import SIDES, Robot, Side
from kinesic.expressivity.keyframes import Hand, Touch
from kinesic.planning.contact import SurfaceTouch, touched_pairs
from kinesic.planning.nonnegative import solve_nonnegative

MAX_STEPS = 12  # largest number of least-squares iterations per posture
GAP_TOLERANCE = 2e-4  # [m] margin added to required distances, within which a shortfall is accepted
TOUCH_TOLERANCE = 3e-3  # [m] accepted excess over the required distance of a touching pair
CONSTRAINT_RANGE = 0.08  # [m] excess over the required distance above which pairs are ignored
DIFFERENCE_STEP = 1e-4  # [rad] joint step of the finite-difference gradient
MAX_HINGE_STEP = 0.15  # [rad] largest rotation of a hinge per iteration
EQUIVALENT_DISPLACEMENT = 0.05  # [m] hand displacement that costs as much as 1 rad, so that elbows move first
MIN_GAP_GRADIENT = 1e-6  # [m/rad] distance gradient below which a pair is ignored
DIVISOR_EPSILON = 1e-9  # smallest divisor; distance constraints with a smaller one contradict each other
HOVER_DISTANCE = 0.015  # [m] distance that a hand keeps from the body where it touches nothing
MAX_TOUCH_DISTANCE = 0.12  # [m] a hand farther from the touched part does not approach it


@dataclass(frozen=True)
class Spacing:
    """Required and desired distances between pairs of body segments."""

    min_distance: float  # [m] required distance of every counted pair that is not in contact
    desired_distance: float | None = None  # [m] target of pairs below `min_distance`; pairs between both come no nearer
    contact: float = HOVER_DISTANCE  # [m] required distance of pairs in contact, which approach to this distance
    contacting: tuple[int, ...] = ()  # counted pairs that are in contact
    touching: tuple[int, ...] = ()  # counted pairs that approach to `contact`
    surfaces: tuple[SurfaceTouch, ...] = ()  # surfaces of hands that approach to `contact`


def separate(
    angles: Floats, joints: Sequence[int], robot: Robot, distances: Distances, spacing: Spacing
) -> Floats | None:
    """Return the nearest posture with the required self-distances, or None.

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
    desired, touching = spacing.desired_distance or spacing.min_distance, list(spacing.touching)
    initial_gaps = distances.gaps(posture[None])[0]
    required = np.where(initial_gaps < spacing.min_distance, desired, np.minimum(initial_gaps, desired)) + GAP_TOLERANCE
    required[list(spacing.contacting)] = spacing.contact + GAP_TOLERANCE
    for _ in range(MAX_STEPS):
        probes = np.repeat(posture[None, :], len(moving) + 1, axis=0)
        probes[np.arange(1, len(moving) + 1), moving] += DIFFERENCE_STEP
        gaps = distances.gaps(probes)
        surfaces = np.concatenate([np.empty((0, len(probes))), *(touch.gaps(probes) for touch in spacing.surfaces)])
        slopes, missing = (gaps[1:] - gaps[0]).T / DIFFERENCE_STEP, required - gaps[0]
        missing[np.abs(slopes).max(axis=1, initial=0.0) < MIN_GAP_GRADIENT] = -np.inf
        farthest = max(gaps[0, touching].max(initial=-np.inf), surfaces[:, 0].max(initial=-np.inf))
        if missing.max(initial=0.0) <= GAP_TOLERANCE and farthest <= spacing.contact + TOUCH_TOLERANCE:
            return posture
        is_near = missing > -CONSTRAINT_RANGE
        bounds = robot.skeleton.lower[moving] - posture[moving], posture[moving] - robot.skeleton.upper[moving]
        identity = np.eye(len(moving))
        approach = (surfaces[:, 1:] - surfaces[:, :1]) / DIFFERENCE_STEP
        rows = np.concatenate([slopes[is_near], -slopes[touching], -approach, identity, -identity])
        nearer = np.concatenate([gaps[0, touching], surfaces[:, 0]]) - spacing.contact - TOUCH_TOLERANCE / 2
        step = _smallest(rows, np.concatenate([missing[is_near], nearer, *bounds]), _metric(probes, robot))
        if step is None:
            return None
        posture[moving] += step * min(1.0, MAX_HINGE_STEP / max(DIVISOR_EPSILON, float(np.abs(step).max())))
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

    The constraints are rows @ step >= needed. Uses least distance programming (Lawson and Hanson). If they
    contradict each other, positive `needed` are halved, three times at most; then the result is None.
    """
    root = np.linalg.cholesky(metric)
    within = np.linalg.solve(root, rows.T)
    for fraction in (1.0, 0.5, 0.25, 0.125):
        required = np.where(needed > 0, fraction * needed, needed)
        system = np.vstack([within, required])
        multipliers = solve_nonnegative(system, np.append(np.zeros(len(within)), 1.0))
        residual = system @ multipliers
        if 1.0 - residual[-1] > DIVISOR_EPSILON:
            step: Floats = np.linalg.solve(root.T, residual[:-1] / (1.0 - residual[-1]))
            return step
    return None


def clear_hands(
    angles: Floats, hands: Mapping[Side, Hand], robot: Robot, distances: Distances, gaps: Floats | None = None
) -> Floats:
    """Move the arms until hands keep the hover distance or touch.

    Arms move as little as possible. Touching hands come as near as the robot's contact distance, with the requested
    fingertip if possible, otherwise with the nearest part.

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
    touches = {side: hand.touch for side, hand in moving.items() if hand.touch is not None}
    nearest = {touched_pair(side, touch, robot, gaps) for side, touch in touches.items()}
    touching = tuple(sorted(pair for pair in nearest if pair is not None and gaps[pair] <= MAX_TOUCH_DISTANCE))
    if gaps.min(initial=HOVER_DISTANCE) >= HOVER_DISTANCE and not touching:
        return angles
    surfaces = {side: touch for side, hand in moving.items() if (touch := SurfaceTouch.of(side, hand, robot))}
    led = {touched_pair(side, touches[side], robot, gaps) for side in surfaces}
    contacting = tuple(sorted({k for side, touch in touches.items() for k in touched_pairs(side, touch, robot)}))
    contact = partial(Spacing, HOVER_DISTANCE, contact=robot.contact_distance, contacting=contacting)
    meant = contact(touching=tuple(pair for pair in touching if pair not in led), surfaces=tuple(surfaces.values()))
    attempts = [meant] * bool(surfaces and touching) + [contact(touching=touching)] * bool(touching)
    for spacing in [*attempts, Spacing(HOVER_DISTANCE)]:
        result = separate(angles, joints, robot, distances, spacing)
        if result is not None:
            return result
    return angles


def touched_pair(side: Side, touch: Touch, robot: Robot, gaps: Floats) -> int | None:
    """Return the index of the nearest pair of hand and touched part.

    Args:
        side: of the hand.
        touch: touched body part.
        robot: the robot.
        gaps: (p,) [m] of all counted pairs.

    Returns:
        Index of the nearest pair of fingers or palm; None if no such pair is counted.
    """
    return min(touched_pairs(side, touch, robot), key=lambda k: float(gaps[k]), default=None)
