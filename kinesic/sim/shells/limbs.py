"""Shell design of arms: tapered limbs, servo drums, mittens, palms and fingers."""

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.sim.shells.distance import DistanceField, ball, blended_union, box, cone, half_space
from kinesic.sim.shells.part import (
    BLEND_RADIUS,
    CUFF_WIDTH,
    FINGER_BLEND_RADIUS,
    FINGER_SKIN_THICKNESS,
    SERVO_CLEARANCE,
    SKIN_THICKNESS,
    TRIANGLE_BUDGET,
    Housing,
    ShellPart,
    enclose_capsule,
    enclose_in_box,
    enclose_in_drum,
)


def limb(part: ShellPart) -> Housing:
    """Design the housing of a clavicle, upper arm or forearm.

    It is a tapered bar with drums around servos and a hub for the next hinge.
    """
    end = part.find_next_joint()
    if end is None or np.linalg.norm(end) < 1e-6:
        solids = [*(enclose_capsule(c) for c in part.capsules), *(enclose_in_box(servo) for servo in part.servos)]
        return Housing(blended_union(solids, BLEND_RADIUS), None, (), part.extreme_points, TRIANGLE_BUDGET["limb"])
    length = float(np.linalg.norm(end))
    axis, zero = end / length, np.zeros(3)
    first, last = _find_girths(part, axis, length)
    begin = max(0.08 * length, min((float(c.start @ axis) for c in part.capsules), default=0.0))
    reach = [float(max(c.start @ axis, c.end @ axis)) + 0.4 * last for c in part.capsules]
    stop = min(length - min(0.45 * last, 0.2 * length), max(reach, default=length))
    solids = [cone(begin * axis, stop * axis, first, last)]
    for servo in part.servos:
        if len(part.servos) > 1 and np.linalg.norm(servo.centre) < 0.01:
            girth = float(np.linalg.norm(servo.corners, axis=1).max()) + SERVO_CLEARANCE
            solids.append(cone(servo.centre, servo.centre + 1e-4 * axis, girth, girth))
        else:
            solids.append(enclose_in_drum(servo, zero, axis)[0])
    solids += [enclose_capsule(c) for c in part.capsules if np.linalg.norm(c.end - c.start) < 2 * c.radius]
    dark = ball(end, 1.22 * last)
    lines = (half_space(axis, 0.62 * length),) if length > 0.14 else ()
    extreme_points = np.vstack([part.extreme_points, end + last * np.vstack([np.eye(3), -np.eye(3)])])
    return Housing(blended_union(solids, 1.7 * BLEND_RADIUS), dark, lines, extreme_points, TRIANGLE_BUDGET["limb"])


def _find_girths(part: ShellPart, axis: Floats, length: float) -> tuple[float, float]:
    """Return the radii [m] of a limb at its start and end."""
    long_capsules = [c for c in part.capsules if np.linalg.norm(c.end - c.start) >= 2 * c.radius] or part.capsules
    bar = min((c.radius for c in long_capsules), default=0.1 * length) + SKIN_THICKNESS
    ends = [enclose_in_drum(servo, np.zeros(3), axis)[1] for servo in part.servos if servo.centre @ axis > 0.7 * length]
    return bar + 0.002, min([bar, *ends]) + CUFF_WIDTH


def hand(part: ShellPart, facing: Floats) -> Housing:
    """Design the housing of a palm, or of a mitten without fingers."""
    thumb_axis = np.array([1.0, 0.0, 0.0]) if abs(facing[0]) < 0.9 else np.array([0.0, 1.0, 0.0])
    largest = max(part.capsules, key=lambda c: c.radius)
    solids: list[DistanceField] = []
    for servo in part.servos:
        down = np.array([0.0, 0.0, 1.0])
        solids.append(enclose_in_drum(servo, servo.centre, down)[0])
    if len(part.capsules) > 1:
        solids += [enclose_capsule(c) for c in part.capsules]
    else:
        lower, upper = np.minimum(largest.start, largest.end), np.maximum(largest.start, largest.end)
        half = (upper - lower) / 2 + largest.radius * np.where(
            np.abs(facing) > 0.5, 0.72, np.where(thumb_axis > 0.5, 1.22, 1.0)
        )
        solids.append(box((lower + upper) / 2, half, 0.7 * largest.radius))
        root, axis_vector = largest.start + 0.8 * largest.radius * thumb_axis, largest.end - largest.start
        tip = root + 0.55 * axis_vector + 0.6 * largest.radius * thumb_axis + 0.15 * largest.radius * facing
        solids.append(cone(root, tip, 0.46 * largest.radius, 0.36 * largest.radius))
    dark = None
    if part.servos:
        reach = max(float(np.linalg.norm(s.corners[:, :2], axis=1).max()) for s in part.servos)
        dark = ball(np.zeros(3), 1.25 * reach)
    return Housing(blended_union(solids, 0.8 * BLEND_RADIUS), dark, (), part.extreme_points, TRIANGLE_BUDGET["hand"])


def finger(part: ShellPart) -> Housing:
    """Design the housing of a tapered phalanx with a panel line."""
    solids = [
        cone(c.start, c.end, c.radius + FINGER_SKIN_THICKNESS, 0.95 * c.radius + FINGER_SKIN_THICKNESS)
        for c in part.capsules
    ]
    long_capsules = max(part.capsules, key=lambda c: float(np.linalg.norm(c.end - c.start)))
    axis_vector = long_capsules.end - long_capsules.start
    length = float(np.linalg.norm(axis_vector))
    ring = part.segment.origin_in_parent + 1.25 * long_capsules.radius * axis_vector / length
    carrier = part.robot.skeleton.segments[part.robot.skeleton.segment(part.segment.parent or part.segment.name)]
    is_free = all(enclose_capsule(shape)(ring[None])[0] > 0.0 for shape in carrier.capsules)
    lines = (
        (half_space(axis_vector / length, 1.25 * long_capsules.radius),)
        if is_free and length > 1.5 * long_capsules.radius
        else ()
    )
    return Housing(
        blended_union(solids, FINGER_BLEND_RADIUS), None, lines, part.extreme_points, TRIANGLE_BUDGET["finger"]
    )
