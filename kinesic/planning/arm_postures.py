"""Solves the arms of a posture: hands by reaches, elbows by openness, shoulders by effort (thesis 8.6 and 8.7)."""

from collections.abc import Mapping
from types import MappingProxyType

import numpy as np
from msgspec import structs

from kinesic.body.arrays import Floats, sealed
from kinesic.body.chain import Chain
from kinesic.body.reach import Reach
from kinesic.body.robot import Robot, Side
from kinesic.expressivity.keyframes import Hand
from kinesic.ik.arm.refine import refine_posture
from kinesic.ik.arm.shoulder_elbow import carry_shoulder
from kinesic.ik.arm.swivel import swivel
from kinesic.ik.pointing import best_swivel
from kinesic.ik.solve import solve

WIDEST_SWING = np.radians(25)  # that an elbow swings aside for the palm and the pointing of its hand
LEAP = np.radians(110)  # of a hinge from one key to the next: an arm that turns over has no time left for its word
NOT_BEFORE: Mapping[Side, Floats] = MappingProxyType({})
OPEN = np.radians(78)  # swivel at openness 1: beyond, elbows rise more than they go out, and palms turn over


def with_arms(
    angles: Floats,
    hands: Mapping[Side, Hand],
    reaches: Mapping[Side, Reach | None],
    robot: Robot,
    before: Mapping[Side, Floats] = NOT_BEFORE,
) -> Floats:
    """Solves some arms of a posture.

    Args:
        angles: (n,) [rad] the posture, its torso in place; arms start from here.
        hands: whose arms are solved, and in which manner.
        reaches: of these hands, in the world; None rests.
        robot: the robot.
        before: (k,) [rad] of arms whose hands are on a path, when it began: the swivel is kept, and every posture is
            the nearest to that one, so that a hand that comes by again finds its arm as it was.

    Returns:
        (n,) [rad]. Openness turns the elbow from where the hand lets it hang to `OPEN`, the hand's palm
        notwithstanding.
    """
    solved = angles.copy()
    frames = robot.body_frames(angles)
    for side, hand in hands.items():
        reach, chain = reaches[side], robot.arms[side]
        if reach is None:
            joints = list(robot.arm(side).joints)
            solved[joints] = robot.skeleton.rest[joints]
            continue
        base, indices = robot.skeleton.segment(chain.base), list(chain.indices)
        in_base = turn_reach(reach, frames.rotations[base].T, frames.origins[base], np.zeros(3))
        start = angles[indices]
        rest = lift_shoulder(robot, side, carry_shoulder(chain, in_base.position, hand.effort), hand.lift)
        if hand.passing:
            began = angles.copy()
            began[indices] = start = before.get(side, start)
            kept = swivel(chain, start)
            solved[indices] = solve(chain, structs.replace(in_base, swivel=kept), start=start, rest=rest).angles
            solved = refine_posture(robot, side, structs.replace(reach, swivel=kept), solved, near=began)
            continue
        free = _swing_elbow(chain, in_base, start, rest)
        opened = structs.replace(in_base, swivel=_opened(chain, free, hand.openness))
        if opened.swivel is not None:
            free = best_swivel(chain, opened, start=free, rest=rest).angles
        solved[indices] = free
        solved = refine_posture(robot, side, structs.replace(reach, swivel=opened.swivel), solved, near=angles)
    return solved


def _swing_elbow(chain: Chain, reach: Reach, start: Floats, rest: Floats) -> Floats:
    """Swings the elbow for palm and pointing, (k,) [rad]; where an arm would turn over for that, it stays as it was."""
    swung = best_swivel(chain, reach, start=start, rest=rest, widest=WIDEST_SWING).angles
    kept = swivel(chain, start)
    if kept is None or np.abs(swung - start).max() <= LEAP:
        return swung
    plain = solve(chain, structs.replace(reach, swivel=kept), start=start, rest=rest)
    return plain.angles if plain.reached and np.abs(plain.angles - start).max() <= LEAP else swung


def lift_shoulder(robot: Robot, side: Side, rest: Floats, lift: float) -> Floats:
    """Raises the rest of a collar bone.

    Args:
        robot: whose arm it is.
        side: of the arm.
        rest: (k,) [rad] posture whose collar bone stays where it can.
        lift: [rad].

    Returns:
        (k,) [rad] inside the ranges; the same where the arm has no hinge that lifts its shoulder.
    """
    if not lift:
        return rest
    raised, chain = np.array(rest), robot.arms[side]
    raised[[joint in robot.arm(side).lifting for joint in chain.indices]] += lift
    return sealed(np.clip(raised, chain.lower, chain.upper))


def turn_reach(reach: Reach, rotation: Floats, pivot: Floats, moved: Floats, scale: float = 1.0) -> Reach:
    """Turns and scales a reach about a pivot, which itself moves."""
    return Reach(
        sealed(moved + scale * (rotation @ (reach.position - pivot))),
        None if reach.pointing is None else sealed(rotation @ reach.pointing),
        None if reach.palm is None else sealed(rotation @ reach.palm),
        reach.swivel,
    )


def _opened(chain: Chain, angles: Floats, openness: float) -> float | None:
    """Swivel [rad] that openness asks of an arm; None where it asks nothing."""
    present = swivel(chain, angles)
    if openness <= 0.0 or present is None or present >= OPEN:
        return None
    return float(present + openness * (OPEN - present))
