"""Shell design of arms: tapered limbs, mittens, palms and fingers."""

from collections.abc import Sequence

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.smoothing import smooth_curve
from kinesic.sim.shells.distance import DistanceField, ball, blended_union, box, cone, half_space, sleeve
from kinesic.sim.shells.part import (
    BLEND_RADIUS,
    FINGER_BLEND_RADIUS,
    FINGER_SKIN_THICKNESS,
    SERVO_CLEARANCE,
    SKIN_THICKNESS,
    TRIANGLE_BUDGET,
    Housing,
    ServoBox,
    ShellPart,
    enclose_capsule,
    enclose_in_box,
    enclose_in_drum,
)

HUB_DISTANCE = 0.01  # [m] distance of one of several servos from the joint below which the servo gets a round housing
END_MARGIN = 0.008  # [m] length of a sleeve beyond the servos inside, as its edges are round
JOINT_OVERLAP = 0.010  # [m] length by which a sleeve begins before its joint
SLEEVE_CUFF = 0.022  # [m] length of the dark cuff before the next joint
LINE_POSITION = 0.62  # position of the panel line along a limb, 0..1
MIN_LINED_LENGTH = 0.14  # [m] shortest limb with a panel line
TAPER_SLOPE = 0.30  # [m/m] largest change of a limb's half width per length of the limb
CORNER_ALLOWANCE = 1.17  # half width of a cross-section / half width of the largest rectangle inside its round corners
TAPER_STEPS = 8  # number of steps in which the half width along a bar-shaped part decreases
TIP_RATIO = 0.68  # half width of a sleeve at the end of a shape / at its start
ENVELOPE_POINTS = 33  # positions at which the envelope of a limb is computed
ENVELOPE_SMOOTHING = 0.010  # [m] standard deviation of the envelope's smoothing along the limb
SIDE_SIGNS = (-1.0, 1.0)  # coordinate signs of the two sides of an axis


def limb(part: ShellPart) -> Housing:
    """Design the housing of a clavicle, upper arm or forearm.

    It is one tapered sleeve around servos and shapes, with a ball around servos at the joint.
    """
    end = part.find_next_joint()
    if end is None or np.linalg.norm(end) < 1e-6:
        solids = [*(enclose_capsule(c) for c in part.capsules), *(enclose_in_box(servo) for servo in part.servos)]
        return Housing(blended_union(solids, BLEND_RADIUS), None, (), part.extreme_points, TRIANGLE_BUDGET["limb"])
    length = float(np.linalg.norm(end))
    axis = end / length
    axes = _choose_axes(axis)
    hub = [s for s in part.servos if len(part.servos) > 1 and np.linalg.norm(s.centre) < HUB_DISTANCE]
    along, widths = _envelop(part, axes, [servo for servo in part.servos if servo not in hub], length)
    solids = [sleeve(axes, along, widths)]
    for servo in hub:
        girth = float(np.linalg.norm(servo.corners, axis=1).max()) + SERVO_CLEARANCE
        solids.append(cone(servo.centre, servo.centre + 1e-4 * axis, girth, girth))
    if hub:
        solids += [enclose_capsule(c) for c in part.capsules if np.linalg.norm(c.end - c.start) < 2 * c.radius]
    reach = max(float(along[-1]) - length, 0.0) + SLEEVE_CUFF
    lines = (half_space(axis, LINE_POSITION * length),) if length > MIN_LINED_LENGTH else ()
    corners = np.vstack(
        [sign * widths.max(axis=0) @ axes[:2] + t * axis for t in along[[0, -1]] for sign in SIDE_SIGNS]
    )
    extreme_points = np.vstack([part.extreme_points, corners])
    dark = half_space(-axis, reach - length)
    return Housing(blended_union(solids, 1.7 * BLEND_RADIUS), dark, lines, extreme_points, TRIANGLE_BUDGET["limb"])


def _choose_axes(axis: Floats) -> Floats:
    """Return a limb's axes (3, 3): two across and one along."""
    first = np.eye(3)[np.argmin(np.abs(axis))]
    first = first - (first @ axis) * axis
    first /= np.linalg.norm(first)
    return sealed(np.stack([first, np.cross(axis, first), axis]))


def _envelop(part: ShellPart, axes: Floats, servos: Sequence[ServoBox], length: float) -> tuple[Floats, Floats]:
    """Return positions along a limb with the enclosing half widths.

    The envelope changes by no more than `TAPER_SLOPE`, so that a limb tapers where a servo ends.
    """
    long_shapes = [c for c in part.capsules if np.linalg.norm(c.end - c.start) >= 2 * c.radius] or part.capsules
    needs: list[tuple[float, float, Floats]] = []
    for shape in long_shapes:
        low, high = sorted(float(point @ axes[2]) for point in (shape.start, shape.end))
        needs += _list_tapered_needs(low, high, shape.radius + SKIN_THICKNESS)
    for servo in servos:
        local = servo.corners @ axes.T
        low, high = float(local[:, 2].min()), float(local[:, 2].max())
        half = (np.abs(local[:, :2]).max(axis=0) + SERVO_CLEARANCE) * CORNER_ALLOWANCE
        needs.append((low - SERVO_CLEARANCE, high + SERVO_CLEARANCE, half))
    begin = min(low for low, _, _ in needs)
    ends = [high for low, high, _ in needs]
    along = np.linspace(min(begin, 0.08 * length) - JOINT_OVERLAP, max(ends) + END_MARGIN, ENVELOPE_POINTS)
    widths = np.zeros((len(along), 2))
    for low, high, half in needs:
        away = np.maximum(np.maximum(low - along, along - high), 0.0)
        widths = np.maximum(widths, half - TAPER_SLOPE * away[:, None])
    smooth = smooth_curve(widths, ENVELOPE_SMOOTHING / (along[1] - along[0]), ends="edge")
    return sealed(along), sealed(smooth + np.maximum(widths - smooth, 0.0).max(axis=0))


def _list_tapered_needs(low: float, high: float, radius: float) -> list[tuple[float, float, Floats]]:
    """Return intervals along a limb shape with the shell's tapering half widths."""
    edges = np.linspace(low, high, TAPER_STEPS + 1)
    ratios = np.linspace(1.0, TIP_RATIO, TAPER_STEPS)
    return [
        (float(start), float(stop), np.full(2, ratio * radius))
        for start, stop, ratio in zip(edges[:-1], edges[1:], ratios, strict=True)
    ]


def hand(part: ShellPart, facing: Floats) -> Housing:
    """Design a hand's housing: a mitten if it has only one capsule."""
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
