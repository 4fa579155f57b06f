"""Line drawing of the robot from the front.

Nearer parts are darker and on top.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from math import cos, radians, sin

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.robot import SIDES, Robot, Side
from kinesic.body.skeleton import Frames
from kinesic.expressivity.lexicon.hand_shapes import HandShape, find_shape, hand_shapes

Colour = tuple[float, float, float]

VIEW_MARGIN = 0.03  # margin on each side of a line drawing / height of the drawing

PALE_COLOUR: Colour = (0.87, 0.88, 0.90)  # RGB colour of faded lines
HALO_COLOUR: Colour = (1.0, 1.0, 1.0)  # RGB colour of the halo around each part
OWNER_COLOURS: Mapping[str, Colour] = {
    "trunk": (0.45, 0.49, 0.55),
    "l": (0.13, 0.37, 0.66),
    "r": (0.80, 0.36, 0.08),
}

_VIEW_ANGLE = radians(12)  # [rad] downward angle of the view
_FAR_DEPTH = -0.15  # [m] coordinate towards the viewer of the palest parts of the drawing
_NEAR_DEPTH = 0.40  # [m] coordinate towards the viewer from which parts have their full colour
_MAX_WHITE = 0.50  # fraction of white mixed into the colour of the farthest parts
_HALO_WIDTH = 0.008  # [m] largest width of the white halo around each part
_HALO_FRACTION = 0.3  # halo width / width of the part
_EYE_COLOUR: Colour = (0.95, 0.96, 0.97)  # RGB colour of the eyes

# Drawn hand of a robot without fingers, dimensions in [m].
_PALM_WIDTH = 0.042  # [m] width of the palm
_PALM_SPAN = (0.012, 0.056)  # [m] distances of the palm's ends from the wrist
_FINGER_WIDTH = 0.0105  # [m] width of a finger
_EYE_SIZE = 0.014  # [m] diameter of an eye
_DOT_OFFSET = np.array([0.0, 0.003, 0.0])  # [m] vector along the short line that is drawn as a dot
_FINGER_BASES = (0.017, 0.006, -0.006, -0.017)  # [m] positions across the palm, from forefinger to little finger
_FINGER_LENGTHS = (0.048, 0.053, 0.048, 0.038)  # [m] lengths of the fingers, from forefinger to little finger
_THUMB_LENGTH = 0.046  # [m] length of the thumb
_CLOSED_BEND = radians(190)  # [rad] total bend of a closed finger
_MAX_SPREAD = radians(24)  # [rad] spread of the outer fingers to either side


@dataclass(frozen=True, eq=False)
class PenStroke:
    """One line of the robot's drawing."""

    points: Floats  # (m, 2) [m] right and up
    width: float  # [m]
    colour: Colour
    depth: float = 0.0  # [m] towards the viewer
    owner: str = ""  # trunk, l or r


@dataclass(frozen=True)
class OutlineWindow:
    """Window in a line drawing's plane, centred horizontally on the robot."""

    wide: float  # [m]
    low: float  # [m]
    tall: float  # [m]

    @classmethod
    def around(cls, lines: Iterable[PenStroke]) -> "OutlineWindow":
        """Return the smallest drawing window around all lines, with a margin."""
        points = [(line.points, line.width / 2) for line in lines]
        half = max(float(np.abs(positions[:, 0]).max()) + edge for positions, edge in points)
        low = min(float(positions[:, 1].min()) - edge for positions, edge in points)
        high = max(float(positions[:, 1].max()) + edge for positions, edge in points)
        margin = VIEW_MARGIN * (high - low)
        return cls(2 * (half + margin), low - margin, high - low + 2 * margin)


def project(points: Floats) -> Floats:
    """Project points (..., 3) [m] to the drawing plane, (..., 2) [m]."""
    return np.stack([points[..., 1], points[..., 2] * cos(_VIEW_ANGLE) - points[..., 0] * sin(_VIEW_ANGLE)], axis=-1)


def depth(points: Floats) -> Floats:
    """Return the coordinate [m] of points towards the viewer."""
    return np.asarray(points[..., 0] * cos(_VIEW_ANGLE) + points[..., 2] * sin(_VIEW_ANGLE))


def silhouette(
    robot: Robot, angles: Floats, shapes: Mapping[Side, str | None], *, with_base: bool = False
) -> list[PenStroke]:
    """Draw a robot's posture as lines, farthest first.

    Args:
        robot: robot whose capsules are drawn; hands without fingers get drawn ones.
        angles: joint angles (n,) [rad].
        shapes: shapes of hands without fingers; unknown shapes are drawn relaxed.
        with_base: whether the fixed base is drawn, such as the trunk of an imported robot without a waist.
    """
    frames = robot.skeleton.frames(angles)
    fingerless = [side for side in SIDES if not robot.fingers(side)]
    hands = {robot.arm(side).segments[-1] for side in fingerless}
    owners = {name: side for side in SIDES for name in (*robot.arm(side).segments, *robot.fingers(side))}
    lines: list[PenStroke] = []
    for k, segment in enumerate(robot.skeleton.segments):
        if segment.name in hands or (segment.parent is None and not with_base):
            continue
        for capsule in segment.capsules:
            owner = owners.get(segment.name, "trunk")
            ends = frames.origins[k] + np.stack([capsule.start, capsule.end]) @ frames.rotations[k].T
            lines.append(_line(ends, 2 * capsule.radius, owner))
    for side in fingerless:
        k, shape = robot.arm(side).wrist, find_shape(shapes.get(side) or "") or hand_shapes()["relaxed"]
        lines += [
            _line(frames.origins[k] + points @ frames.rotations[k].T, width, side)
            for points, width in hand_outline(robot, side, shape)
        ]
    return sorted(lines, key=lambda line: line.depth) + _draw_eyes(robot, frames)


def _draw_eyes(robot: Robot, frames: Frames) -> list[PenStroke]:
    """Return two dots for the eyes of the drawn robot.

    The result is empty for a robot without a neck.
    """
    name = robot.chains.get("neck", ("",))[-1]
    k = robot.skeleton.segment(name) if name else 0
    capsules = robot.skeleton.segments[k].capsules if name else ()
    if not capsules:
        return []
    head = capsules[0]
    eye_points = (head.start + head.end) / 2 + head.radius * np.array([[0.9, side, 0.35] for side in (-0.4, 0.4)])
    world = frames.origins[k] + eye_points @ frames.rotations[k].T
    return [PenStroke(sealed(project(np.stack([eye, eye + _DOT_OFFSET]))), _EYE_SIZE, _EYE_COLOUR) for eye in world]


def hand_outline(robot: Robot, side: Side, shape: HandShape) -> list[tuple[Floats, float]]:
    """Return a drawn hand's centre lines (m, 3) and widths [m]."""
    site = robot.arm(side).palm
    along = site.position / np.linalg.norm(site.position)
    facing = site.facing
    inward = np.cross(along, facing) * (1 if side == "r" else -1)  # towards the thumb
    parts = [(np.stack([along * reach for reach in _PALM_SPAN]), _PALM_WIDTH)]
    for base, length, straight, spread in zip(
        _FINGER_BASES, _FINGER_LENGTHS, shape.straight[1:], (1.0, 0.33, -0.33, -1.0), strict=True
    ):
        root = along * (_PALM_SPAN[1] + 0.012) + inward * base
        fan = spread * shape.apart * _MAX_SPREAD
        parts.append(
            (_draw_finger(root, along * cos(fan) + inward * sin(fan), facing, length, straight), _FINGER_WIDTH)
        )
    root = along * 0.024 + inward * 0.018
    outward = shape.straight[0]
    thumb = 0.6 * along + outward * inward + (1.0 - outward) * facing
    parts.append((np.stack([root, root + _THUMB_LENGTH * thumb / np.linalg.norm(thumb)]), _FINGER_WIDTH))
    return parts


def _draw_finger(root: Floats, along: Floats, facing: Floats, length: float, straight: float) -> Floats:
    """Return three points (3, 3) [m] of a bent finger, root first."""
    bend = (1.0 - straight) * _CLOSED_BEND
    first, second = (along * cos(angle) + facing * sin(angle) for angle in (0.45 * bend, bend))
    knuckle = root + 0.5 * length * first
    return np.stack([root, knuckle, knuckle + 0.5 * length * second])


def fade_lines(lines: list[PenStroke]) -> list[PenStroke]:
    """Return pen strokes recoloured in a uniform pale grey."""
    return [replace(line, colour=PALE_COLOUR) for line in lines]


def outline_lines(lines: list[PenStroke]) -> list[PenStroke]:
    """Return pen strokes, each preceded by a wider white stroke."""
    return [
        part
        for line in lines
        for part in (
            replace(line, width=line.width + min(_HALO_WIDTH, _HALO_FRACTION * line.width), colour=HALO_COLOUR),
            line,
        )
    ]


def _line(points: Floats, width: float, owner: str) -> PenStroke:
    nearest = float(depth(points).mean())
    white = _MAX_WHITE * float(np.clip((_NEAR_DEPTH - nearest) / (_NEAR_DEPTH - _FAR_DEPTH), 0.0, 1.0))
    red, green, blue = (white + (1.0 - white) * part for part in OWNER_COLOURS[owner])
    if np.allclose(points, points[0]):  # matplotlib draws no line without length, so a sphere becomes a short line
        points = np.stack([points[0] - _DOT_OFFSET / 2, points[0] + _DOT_OFFSET / 2])
    return PenStroke(sealed(project(points)), width, (red, green, blue), nearest, owner)
