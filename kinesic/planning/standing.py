"""Standing posture of a robot in a style, checked for clearance."""

from collections.abc import Iterator, Mapping
from dataclasses import replace
from math import degrees

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.dynamics import Distances
from kinesic.body.robot import SIDES, Robot, Side
from kinesic.expressivity.hands.poses import poses
from kinesic.expressivity.lexicon.lexicon import Lexicon, mirror_form
from kinesic.expressivity.style.standing import OTHER_HAND_PROBABILITY, Standing
from kinesic.expressivity.style.style import NEUTRAL_EXPRESSIVITY, Style
from kinesic.expressivity.turns import rest_head_turn, rest_turn, turn_angles
from kinesic.expressivity.variation import Variation
from kinesic.planning.arm_directions import ARM_FEATURES, measure_arm, set_arm
from kinesic.planning.arm_postures import with_arms
from kinesic.planning.clearance import LAG_RESERVE
from kinesic.planning.collision import clear_hands
from kinesic.planning.setup import Setup
from kinesic.planning.stance import (
    BODY_FEATURES,
    Stance,
    draw_arm_pose,
    draw_components,
    draw_deviation,
    expand_features,
    read_stances,
)
from kinesic.planning.torso import compute_torso_turn, raise_shoulder, set_turn

POSTURE_AMOUNTS = (1.0, 0.75, 0.5, 0.25, 0.0)  # fractions of posture offsets, tried until no body parts are too close
RANGE_MARGIN = 0.01  # [rad] smallest distance of a standing posture from the joint limits
STANDING_STREAM = 7  # index of the random number stream for standing postures
HELD_ARM_FRACTION = 0.25  # factor on random arm offsets if hands rest in a gesture instead of hanging
MAX_ARM_LIFT_DEG = 12.0  # [deg] largest outward angle added to an arm that hangs too close to the body
ARM_LIFT_STEP_DEG = 1.0  # [deg] step by which the angle added to an arm grows
FIST_FLEXION = 0.85  # fraction of the fingers' flexion range in a closed hand


def standing_robot(robot: Robot, style: Style, lexicon: Lexicon, distances: Distances) -> Robot:
    """Return the robot with a style's standing posture as rest posture.

    A body that cannot take the style's rest gesture lets the arms hang, and arms that come too close to the body go
    only part of the way.

    Args:
        robot: with its own rest posture.
        style: with a standing posture and its weight.
        lexicon: with the rest gesture of the hands.
        distances: self-distances of the robot.
    """
    standing, weight = style.standing, style.posture
    if weight == 0.0 or not standing.moves_body:
        return robot
    rest = _close_hands(_turn_body(robot, standing, weight), robot, standing, weight)
    arms = _take_rest_gesture(rest, robot, standing, lexicon, distances) if standing.rest else None
    if arms is None:
        candidates = (_offset_arms(rest, robot, standing, weight * amount) for amount in POSTURE_AMOUNTS)
        arms = next((angles for angles in candidates if _is_clear(angles, robot, distances)), None)
    if arms is None:
        return robot
    return _with_rest(robot, arms)


def take_rest(name: str, setup: Setup, chance: np.random.Generator) -> Floats | None:
    """Return the rest posture with a named rest gesture, or None.

    Args:
        name: rest gesture, or empty for arms that hang.
        setup: with the posture of the trunk.
        chance: random generator that chooses the hand.

    Returns:
        (n,) [rad]; None if the body cannot take it.
    """
    robot, standing = setup.robot, Standing(rest=name, mirrored=bool(chance.uniform() < OTHER_HAND_PROBABILITY))
    rest = np.array(robot.skeleton.rest)
    if name:
        return _take_rest_gesture(rest, robot, standing, setup.lexicon, setup.distances)
    hanging = expand_features(read_stances().hanging.mean)
    for side in SIDES:
        rest = set_arm(robot, side, hanging[-len(ARM_FEATURES) :], rest)
    angles = _inside(rest, robot)
    return angles if _is_clear(angles, robot, setup.distances) else None


def draw_rest(
    robot: Robot,
    standing: Standing,
    distances: Distances,
    chance: np.random.Generator,
    *,
    roll: float = 0.0,
    torsion: float = 0.0,
) -> Floats:
    """Draw a random rest posture (n,) [rad] near the usual rest posture.

    Arms and shoulders deviate from the rest posture as those of captured people. The head stays level.

    Args:
        robot: with the usual rest posture.
        standing: of the style; hands in a rest gesture deviate less.
        distances: self-distances of the robot.
        chance: random generator.
        roll: [rad] of the trunk to the right, in addition to the usual one.
        torsion: [rad] of the trunk to the left, likewise.
    """
    features = draw_components(read_stances().hanging.rests, chance)
    shift = {
        "trunk_turn": degrees(torsion),
        "trunk_roll": degrees(roll),
        "shoulder_rise": features[BODY_FEATURES.index("shoulder_rise")],
    }
    features[: len(BODY_FEATURES)] = [shift.get(name, 0.0) for name in BODY_FEATURES]
    angles = _take_largest_stance(robot, standing, Stance(None, sealed(features)), distances)
    return np.array(robot.skeleton.rest) if angles is None else angles


def vary_standing(
    robot: Robot, style: Style, variation: Variation, distances: Distances, *, hands_hang: bool = False
) -> Robot:
    """Return the robot with a random rest posture, as captured people stand.

    People lean a little, stand with their weight on one leg, and no hand hangs as the other does. Some have one or both
    hands before the body. A style with a posture of its own is the mean of its persons, otherwise
    captured people are.

    Args:
        robot: with the rest posture of a style.
        style: of this posture.
        variation: amount and seed; amount 0 leaves the robot unchanged.
        distances: self-distances of the robot.
        hands_hang: whether no hand is before the body.
    """
    if variation.amount == 0.0:
        return robot
    chance = np.random.default_rng((variation.seed, STANDING_STREAM))
    stances = list(_draw_stances(style, variation.amount, chance))
    for stance in stances[-1:] if hands_hang else stances:
        angles = _take_largest_stance(robot, style.standing, stance, distances)
        if angles is not None:
            return _with_rest(robot, angles)
    return robot


def _draw_stances(style: Style, amount: float, chance: np.random.Generator) -> Iterator[Stance]:
    """Yield a random stance, then one with hanging arms.

    The second is for bodies that cannot take the first. Amounts below 1 lower hands towards hanging arms.
    """
    table = read_stances()
    hanging = expand_features(table.hanging.mean) if _stands_upright(style) else None
    deviation = draw_deviation(table.hanging, chance)
    pose = None if hanging is None else draw_arm_pose(table, chance)
    if hanging is not None and pose is not None and pose.mean is not None:
        mean = hanging + min(amount, 1.0) * (pose.mean - hanging)
        yield Stance(sealed(mean), pose.deviation).scaled(amount)
    yield Stance(hanging, sealed(deviation)).scaled(amount)


def _stands_upright(style: Style) -> bool:
    """Return whether a style keeps the robot's own posture."""
    return style.posture == 0.0 or not style.standing.moves_body


def _take_largest_stance(robot: Robot, standing: Standing, stance: Stance, distances: Distances) -> Floats | None:
    """Return a stance's posture [rad] at its largest collision-free fraction, or None."""
    scaled = (stance.scaled(fraction) for fraction in POSTURE_AMOUNTS)
    candidates = (_take_clear_stance(robot, standing, smaller, distances) for smaller in scaled)
    return next((angles for angles in candidates if angles is not None), None)


def _take_clear_stance(robot: Robot, standing: Standing, stance: Stance, distances: Distances) -> Floats | None:
    """Return a stance's posture (n,) [rad] with collision-free arms, or None.

    An arm too close to the body is moved outward, as the deviation of trunk and head should remain.
    """
    lifts = dict.fromkeys(SIDES, 0.0)
    while max(lifts.values()) <= MAX_ARM_LIFT_DEG:
        angles = _take_stance(robot, standing, stance, lifts)
        close = _find_close_segments(angles, robot, distances)
        if not close:
            return angles
        sides = [side for side in SIDES if close & robot.arm(side).bodies]
        if not sides:
            return None
        lifts |= {side: lifts[side] + ARM_LIFT_STEP_DEG for side in sides}
    return None


def _take_stance(robot: Robot, standing: Standing, stance: Stance, lifts: Mapping[Side, float]) -> Floats:
    """Return the rest posture (n,) [rad] of a stance.

    Args:
        robot: with the rest posture of the style.
        standing: of this posture.
        stance: mean and deviation.
        lifts: angle [deg] by which each arm is moved outward.
    """
    mean = _measure_rest(robot) if stance.mean is None else stance.mean
    deviation, count = np.array(stance.deviation), len(BODY_FEATURES)
    if stance.mean is None and standing.rest:
        deviation[count:] *= HELD_ARM_FRACTION
    turn, tilt, roll, *head, rise = np.radians((mean + deviation)[:count]).tolist()
    angles = np.array(robot.skeleton.rest)
    set_turn(robot, "torso", np.array([turn, tilt, roll]), angles)
    reached = compute_torso_turn(robot, "torso", angles)
    set_turn(robot, "neck", np.array([turn + head[0], *head[1:]]) - reached, angles)
    raise_shoulder(robot, rise, angles)
    for side, arm in zip(SIDES, np.split((mean + deviation)[count:], len(SIDES)), strict=True):
        outward = [lifts[side] if name.endswith("outward") else 0.0 for name in ARM_FEATURES]
        angles = set_arm(robot, side, arm + outward, angles)
    return _inside(angles, robot)


def _measure_rest(robot: Robot) -> Floats:
    """Return the stance features (s,) [deg] of a robot's rest posture."""
    torso, head = (turn_angles(turn) for turn in (rest_turn(robot, "torso"), rest_head_turn(robot)))
    body = np.degrees([*torso, head[0] - torso[0], head[1], head[2], 0.0])
    rest = np.array(robot.skeleton.rest)
    return np.concatenate([body, *(measure_arm(robot, side, rest) for side in SIDES)])


def _with_rest(robot: Robot, angles: Floats) -> Robot:
    hinges = zip(robot.skeleton.hinges, angles.tolist(), strict=True)
    skeleton = replace(robot.skeleton, hinges=tuple(replace(hinge, rest=angle) for hinge, angle in hinges))
    return replace(robot, skeleton=skeleton)


def _turn_body(robot: Robot, standing: Standing, weight: float) -> Floats:
    """Return the rest posture (n,) [rad] with turned trunk and head."""
    angles = np.array(robot.skeleton.rest)
    set_turn(robot, "torso", weight * np.array(turn_angles(standing.trunk)), angles)
    head = weight * np.array(turn_angles(standing.head))
    set_turn(robot, "neck", head - compute_torso_turn(robot, "torso", angles), angles)
    return _inside(angles, robot)


def _close_hands(angles: Floats, robot: Robot, standing: Standing, weight: float) -> Floats:
    """Return a posture (n,) [rad] with fingers flexed towards a fist."""
    skeleton, closed = robot.skeleton, np.array(angles)
    fraction = min(weight * standing.fist, 1.0)
    for side in SIDES:
        for joint in robot.arm(side).fingers:
            if "_flexion" in skeleton.names[joint]:
                full = FIST_FLEXION * skeleton.upper[joint]
                closed[joint] += fraction * max(full - closed[joint], 0.0)
    return closed


def _offset_arms(rest: Floats, robot: Robot, standing: Standing, amount: float) -> Floats:
    """Add the arm offsets of a style to a posture (n,) [rad]."""
    angles, names = np.array(rest), robot.skeleton.names
    for name, offset in standing.arms:
        for side in SIDES:
            if f"{side}_{name}" in names:
                angles[robot.skeleton.joint(f"{side}_{name}")] += amount * offset
    return _inside(angles, robot)


def _take_rest_gesture(
    rest: Floats, robot: Robot, standing: Standing, lexicon: Lexicon, distances: Distances
) -> Floats | None:
    """Move the hands of a posture (n,) into the style's rest gesture.

    Returns:
        None when the lexicon lacks the gesture, or the body cannot take it.
    """
    form = lexicon.forms_by_id.get(standing.rest)
    if form is None or not form.keys:
        return None
    lifts = tuple((name, offset) for name, offset in standing.arms if name.startswith("sternoclavicular"))
    start = _offset_arms(rest, robot, replace(standing, arms=lifts), 1.0)
    form = mirror_form(form) if standing.mirrored else form
    hands = {side: row[-1] for side, row in poses(form, robot, NEUTRAL_EXPRESSIVITY).hands.items()}
    reached = with_arms(start, hands, {side: hand.reach for side, hand in hands.items()}, robot)
    cleared = clear_hands(reached, hands, robot, distances, distances.gaps(reached[None])[0])
    angles = _inside(cleared, robot)
    return angles if _is_clear(angles, robot, distances) else None


def _inside(angles: Floats, robot: Robot) -> Floats:
    """Clip a posture [rad] to joint ranges, with a margin where possible."""
    lower = np.minimum(robot.skeleton.lower + RANGE_MARGIN, robot.skeleton.rest)
    upper = np.maximum(robot.skeleton.upper - RANGE_MARGIN, robot.skeleton.rest)
    return np.asarray(np.clip(angles, lower, upper))


def _is_clear(angles: Floats, robot: Robot, distances: Distances) -> bool:
    """Return whether a posture keeps the required clearance, or the rest posture's."""
    return not _find_close_segments(angles, robot, distances)


def _find_close_segments(angles: Floats, robot: Robot, distances: Distances) -> frozenset[str]:
    """Return the segments that are closer to other segments than required.

    Pairs that are too close at rest must not come nearer.
    """
    gaps, own_gaps = distances.gaps(np.stack([angles, robot.skeleton.rest]))
    close = gaps < np.minimum(robot.min_clearance + LAG_RESERVE, own_gaps)
    return frozenset(name for pair, near in zip(robot.counted_pairs, close, strict=True) if near for name in pair)
