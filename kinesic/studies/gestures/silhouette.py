"""The robot as strokes of a broad pen, seen from the front: what is nearer is darker and drawn later."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from math import cos, radians, sin

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.robot import SIDES, Robot, Side
from kinesic.body.skeleton import Frames
from kinesic.expressivity.lexicon.hand_shapes import HandShape, find_shape, hand_shapes

Colour = tuple[float, float, float]

PALE: Colour = (0.87, 0.88, 0.90)
HALO: Colour = (1.0, 1.0, 1.0)
COLOURS: Mapping[str, Colour] = {"trunk": (0.45, 0.49, 0.55), "l": (0.13, 0.37, 0.66), "r": (0.80, 0.36, 0.08)}

_DOWN = radians(12)  # the eye looks down so much
_FAR, _NEAR = -0.15, 0.40  # [m] depths between which colours deepen
_PALEST = 0.50  # share of white in the colour of what is farthest
_EDGE, _EDGE_SHARE = 0.008, 0.3  # of white about each part, so that one shows before the other: [m], of its width
_EYES: Colour = (0.95, 0.96, 0.97)

# A hand for the eye, [m], of a robot that has no fingers.
_PALM_WIDTH, _PALM = 0.042, (0.012, 0.056)
_FINGER_WIDTH, _EYE = 0.0105, 0.014
_DOT = np.array([0.0, 0.003, 0.0])  # [m] a line of no length is not drawn
_BASES = (0.017, 0.006, -0.006, -0.017)  # across, of forefinger .. little finger
_LENGTHS, _THUMB = (0.048, 0.053, 0.048, 0.038), 0.046
_CLOSED = radians(190)  # that a finger bends over its two halves when it is closed
_FAN = radians(24)  # to either side, of the outer fingers when they are far apart


@dataclass(frozen=True, eq=False)
class PenStroke:
    """One stroke of the pen."""

    points: Floats  # (m, 2) [m] right and up, as seen
    width: float  # [m]
    colour: Colour
    depth: float = 0.0  # [m] towards the eye
    owner: str = ""  # trunk, l or r


def project(points: Floats) -> Floats:
    """Projects (..., 3) points to (..., 2) [m] right and up, from the front and a little above."""
    return np.stack([points[..., 1], points[..., 2] * cos(_DOWN) - points[..., 0] * sin(_DOWN)], axis=-1)


def depth(points: Floats) -> Floats:
    """Measures (...) [m] towards the eye."""
    return np.asarray(points[..., 0] * cos(_DOWN) + points[..., 2] * sin(_DOWN))


def silhouette(robot: Robot, angles: Floats, shapes: Mapping[Side, str | None]) -> list[PenStroke]:
    """Draws a posture, what is farther first.

    Args:
        robot: whose capsules are drawn; hands without fingers get some, for the eye.
        angles: (n,) [rad].
        shapes: of hands without fingers; one that is not known is drawn relaxed.
    """
    frames = robot.skeleton.frames(angles)
    plain = [side for side in SIDES if not robot.fingers(side)]
    hands = {robot.arm(side).segments[-1] for side in plain}
    owners = {name: side for side in SIDES for name in (*robot.arm(side).segments, *robot.fingers(side))}
    lines: list[PenStroke] = []
    for k, segment in enumerate(robot.skeleton.segments):
        if segment.name in hands or segment.parent is None:
            continue
        for capsule in segment.capsules:
            owner = owners.get(segment.name, "trunk")
            ends = frames.origins[k] + np.stack([capsule.start, capsule.end]) @ frames.rotations[k].T
            lines.append(_line(ends, 2 * capsule.radius, owner))
    for side in plain:
        k, shape = robot.arm(side).wrist, find_shape(shapes.get(side) or "") or hand_shapes()["relaxed"]
        lines += [
            _line(frames.origins[k] + points @ frames.rotations[k].T, width, side)
            for points, width in hand_outline(robot, side, shape)
        ]
    return sorted(lines, key=lambda line: line.depth) + _eyes(robot, frames)


def _eyes(robot: Robot, frames: Frames) -> list[PenStroke]:
    """Two dots that show where the face looks; none on a robot without a neck."""
    name = robot.chains.get("neck", ("",))[-1]
    k = robot.skeleton.segment(name) if name else 0
    capsules = robot.skeleton.segments[k].capsules if name else ()
    if not capsules:
        return []
    head = capsules[0]
    places = (head.start + head.end) / 2 + head.radius * np.array([[0.9, side, 0.35] for side in (-0.4, 0.4)])
    world = frames.origins[k] + places @ frames.rotations[k].T
    return [PenStroke(sealed(project(np.stack([eye, eye + _DOT]))), _EYE, _EYES) for eye in world]


def hand_outline(robot: Robot, side: Side, shape: HandShape) -> list[tuple[Floats, float]]:
    """Outlines palm and fingers: (m, 3) points [m] in the hand's segment, and widths [m]."""
    site = robot.arm(side).palm
    along = site.position / np.linalg.norm(site.position)
    facing = site.facing
    inward = np.cross(along, facing) * (1 if side == "r" else -1)  # towards the thumb
    parts = [(np.stack([along * reach for reach in _PALM]), _PALM_WIDTH)]
    for base, length, straight, place in zip(
        _BASES, _LENGTHS, shape.straight[1:], (1.0, 0.33, -0.33, -1.0), strict=True
    ):
        root = along * (_PALM[1] + 0.012) + inward * base
        fan = place * shape.apart * _FAN
        parts.append((_finger(root, along * cos(fan) + inward * sin(fan), facing, length, straight), _FINGER_WIDTH))
    root = along * 0.024 + inward * 0.018
    out = shape.straight[0]
    thumb = 0.6 * along + out * inward + (1.0 - out) * facing
    parts.append((np.stack([root, root + _THUMB * thumb / np.linalg.norm(thumb)]), _FINGER_WIDTH))
    return parts


def _finger(root: Floats, along: Floats, facing: Floats, length: float, straight: float) -> Floats:
    """(3, 3) [m] a finger of two halves that bends towards where the palm faces."""
    bend = (1.0 - straight) * _CLOSED
    first, second = (along * cos(angle) + facing * sin(angle) for angle in (0.45 * bend, bend))
    knuckle = root + 0.5 * length * first
    return np.stack([root, knuckle, knuckle + 0.5 * length * second])


def pale(lines: list[PenStroke]) -> list[PenStroke]:
    """Turns lines into a shadow."""
    return [replace(line, colour=PALE) for line in lines]


def outline_lines(lines: list[PenStroke]) -> list[PenStroke]:
    """Puts each line over a wider white one."""
    return [
        part
        for line in lines
        for part in (replace(line, width=line.width + min(_EDGE, _EDGE_SHARE * line.width), colour=HALO), line)
    ]


def _line(points: Floats, width: float, owner: str) -> PenStroke:
    nearest = float(depth(points).mean())
    white = _PALEST * float(np.clip((_NEAR - nearest) / (_NEAR - _FAR), 0.0, 1.0))
    red, green, blue = (white + (1.0 - white) * part for part in COLOURS[owner])
    return PenStroke(sealed(project(points)), width, (red, green, blue), nearest, owner)
