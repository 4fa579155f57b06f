"""The design of arms: tapered bars with drums round servos, mittens, palms and fingers."""

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.sim.shells.distance import DistanceField, ball, blended_union, box, cone, half_space
from kinesic.sim.shells.part import (
    BLEND,
    BUDGET,
    CUFF,
    FINGER_BLEND,
    FINGER_SKIN,
    SERVO_ROOM,
    SKIN,
    Housing,
    ShellPart,
    boxed,
    drum_about,
    own_shape,
)


def limb(part: ShellPart) -> Housing:
    """Clavicle, upper arm or forearm: a tapered bar, drums round servos, a hub for the next hinge."""
    end = part.onward()
    if end is None or np.linalg.norm(end) < 1e-6:
        solids = [*(own_shape(c) for c in part.capsules), *(boxed(servo) for servo in part.servos)]
        return Housing(blended_union(solids, BLEND), None, (), part.held, BUDGET["limb"])
    length = float(np.linalg.norm(end))
    axis, zero = end / length, np.zeros(3)
    first, last = _girths(part, axis, length)
    begin = max(0.08 * length, min((float(c.start @ axis) for c in part.capsules), default=0.0))
    reach = [float(max(c.start @ axis, c.end @ axis)) + 0.4 * last for c in part.capsules]
    stop = min(length - min(0.45 * last, 0.2 * length), max(reach, default=length))
    solids = [cone(begin * axis, stop * axis, first, last)]
    for servo in part.servos:
        if len(part.servos) > 1 and np.linalg.norm(servo.centre) < 0.01:
            girth = float(np.linalg.norm(servo.corners, axis=1).max()) + SERVO_ROOM
            solids.append(cone(servo.centre, servo.centre + 1e-4 * axis, girth, girth))
        else:
            solids.append(drum_about(servo, zero, axis)[0])
    solids += [own_shape(c) for c in part.capsules if np.linalg.norm(c.end - c.start) < 2 * c.radius]
    dark = ball(end, 1.22 * last)
    lines = (half_space(axis, 0.62 * length),) if length > 0.14 else ()
    held = np.vstack([part.held, end + last * np.vstack([np.eye(3), -np.eye(3)])])
    return Housing(blended_union(solids, 1.7 * BLEND), dark, lines, held, BUDGET["limb"])


def _girths(part: ShellPart, axis: Floats, length: float) -> tuple[float, float]:
    """[m] radii of a limb at its start and at its end."""
    long = [c for c in part.capsules if np.linalg.norm(c.end - c.start) >= 2 * c.radius] or part.capsules
    bar = min((c.radius for c in long), default=0.1 * length) + SKIN
    ends = [drum_about(servo, np.zeros(3), axis)[1] for servo in part.servos if servo.centre @ axis > 0.7 * length]
    return bar + 0.002, min([bar, *ends]) + CUFF


def hand(part: ShellPart, facing: Floats) -> Housing:
    """A palm, or a mitten with a thumb where there are no fingers."""
    across = np.array([1.0, 0.0, 0.0]) if abs(facing[0]) < 0.9 else np.array([0.0, 1.0, 0.0])
    big = max(part.capsules, key=lambda c: c.radius)
    solids: list[DistanceField] = []
    for servo in part.servos:
        down = np.array([0.0, 0.0, 1.0])
        solids.append(drum_about(servo, servo.centre, down)[0])
    if len(part.capsules) > 1:
        solids += [own_shape(c) for c in part.capsules]
    else:
        low, high = np.minimum(big.start, big.end), np.maximum(big.start, big.end)
        half = (high - low) / 2 + big.radius * np.where(np.abs(facing) > 0.5, 0.72, np.where(across > 0.5, 1.22, 1.0))
        solids.append(box((low + high) / 2, half, 0.7 * big.radius))
        root, way = big.start + 0.8 * big.radius * across, big.end - big.start
        tip = root + 0.55 * way + 0.6 * big.radius * across + 0.15 * big.radius * facing
        solids.append(cone(root, tip, 0.46 * big.radius, 0.36 * big.radius))
    dark = None
    if part.servos:
        reach = max(float(np.linalg.norm(s.corners[:, :2], axis=1).max()) for s in part.servos)
        dark = ball(np.zeros(3), 1.25 * reach)
    return Housing(blended_union(solids, 0.8 * BLEND), dark, (), part.held, BUDGET["hand"])


def finger(part: ShellPart) -> Housing:
    """A tapered phalanx with a line behind its joint."""
    solids = [cone(c.start, c.end, c.radius + FINGER_SKIN, 0.95 * c.radius + FINGER_SKIN) for c in part.capsules]
    long = max(part.capsules, key=lambda c: float(np.linalg.norm(c.end - c.start)))
    way = long.end - long.start
    length = float(np.linalg.norm(way))
    ring = part.segment.origin_in_parent + 1.25 * long.radius * way / length
    carrier = part.robot.skeleton.segments[part.robot.skeleton.segment(part.segment.parent or part.segment.name)]
    free = all(own_shape(shape)(ring[None])[0] > 0.0 for shape in carrier.capsules)
    lines = (half_space(way / length, 1.25 * long.radius),) if free and length > 1.5 * long.radius else ()
    return Housing(blended_union(solids, FINGER_BLEND), None, lines, part.held, BUDGET["finger"])
