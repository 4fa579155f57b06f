"""The screen on a robot's head that shows its face: a rounded picture, slightly curved, in a dark frame."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from kinesic.body.arrays import Floats, sealed
from kinesic.body.robot import Robot
from kinesic.body.skeleton import Capsule
from kinesic.sim.shells.shell import SegmentShell, shell_of

WIDTH, HEIGHT = 0.238, 0.179  # arm lengths: 100 x 75 mm of the default robot; those below are arm lengths, too
SCREEN_RADIUS = 0.26  # radius about the upright axis
RIM = 0.014  # of the frame, round the picture
SET_BACK = 0.004  # of the frame behind the picture, so that nothing is in one plane
DEEP = 0.085  # of the frame's back behind its front
BELOW = 0.014  # of the picture's middle below the site between the eyes
CLEAR = 0.006  # from the head's shapes to the picture
CORNER = 5.0  # exponent of the outline |u|^n + |v|^n = 1
RINGS, AROUND = 5, 40
STEP, MOST_STEPS = 0.002, 100  # [arm lengths] by which the screen comes forward until it is clear of the head


@dataclass(frozen=True, eq=False)
class Sheet:
    """Triangles, fixed to a segment."""

    places: Floats  # (v, 3) [m]
    normals: Floats  # (v, 3)
    shares: Floats  # (v, 2) of a picture's width from its left and of its height from its top
    triangles: NDArray[np.int32]  # (t, 3) counterclockwise from without


@dataclass(frozen=True, eq=False)
class FaceScreen:
    """A picture and its frame."""

    segment: str
    picture: Sheet
    frame: Sheet


def screen_of(robot: Robot) -> FaceScreen | None:
    """Builds the screen of a robot; None where it has no site `eyes`, or one that its neck does not turn, or skin."""
    eyes, neck = robot.sites.get("eyes"), robot.chains.get("neck", ())
    if eyes is None or robot.skin is not None or (neck and eyes.segment not in neck):
        return None
    left = np.cross([0.0, 0.0, 1.0], eyes.facing)
    if not left.any():
        return None
    left /= np.linalg.norm(left)
    axes = np.stack([left, np.cross(eyes.facing, left), eyes.facing])
    size, middle = robot.arm_length, eyes.position - BELOW * robot.arm_length * axes[1]
    picture = _sheet(middle, axes, size * np.array([WIDTH, HEIGHT]) / 2, size)
    shapes = robot.skeleton.segments[robot.skeleton.segment(eyes.segment)].capsules
    half = size * np.array([WIDTH, HEIGHT]) / 2
    shell = shell_of(robot)
    seen = None if shell is None else shell.segments.get(eyes.segment)
    own = 0.0 if seen is None else _before(_points(seen), middle, axes, half, size)
    ahead = STEP * size * _steps(picture.places, shapes, STEP * size * eyes.facing, CLEAR * size)
    ahead = max(ahead, own)
    picture = _sheet(middle + ahead * eyes.facing, axes, size * np.array([WIDTH, HEIGHT]) / 2, size)
    behind = middle + (ahead - SET_BACK * size) * eyes.facing
    front = _sheet(behind, axes, size * (np.array([WIDTH, HEIGHT]) / 2 + RIM), size)
    return FaceScreen(eyes.segment, picture, _with_sides(front, DEEP * size * eyes.facing, middle))


def _sheet(middle: Floats, axes: Floats, half: Floats, size: float) -> Sheet:
    """A rounded rectangle in rings round its middle, bent about the upright axis."""
    turns = 2 * np.pi * np.arange(AROUND) / AROUND
    outline = np.stack([np.sign(f(turns)) * np.abs(f(turns)) ** (2 / CORNER) for f in (np.cos, np.sin)], axis=1)
    flat = np.concatenate([np.zeros((1, 2)), *(outline * ring / RINGS for ring in range(1, RINGS + 1))])
    across, up = (flat * half).T
    angle, bend = across / (SCREEN_RADIUS * size), SCREEN_RADIUS * size
    local = np.stack([bend * np.sin(angle), up, bend * (np.cos(angle) - 1.0)], axis=1)
    normals = np.stack([np.sin(angle), np.zeros_like(angle), np.cos(angle)], axis=1)
    shares = np.stack([(1.0 + flat[:, 0]) / 2, (1.0 - flat[:, 1]) / 2], axis=1)
    ring = np.arange(AROUND)
    after = (ring + 1) % AROUND
    fan = np.stack([np.zeros(AROUND, dtype=int), 1 + ring, 1 + after], axis=1)
    belts = []
    for k in range(RINGS - 1):
        inner, outer = 1 + k * AROUND, 1 + (k + 1) * AROUND
        belts += [np.stack([inner + ring, outer + ring, outer + after], axis=1)]
        belts += [np.stack([inner + ring, outer + after, inner + after], axis=1)]
    triangles = np.concatenate([fan, *belts]).astype(np.int32)
    return Sheet(sealed(middle + local @ axes), sealed(normals @ axes), sealed(shares), triangles)


def _with_sides(front: Sheet, deep: Floats, middle: Floats) -> Sheet:
    """Adds a belt from the edge of a sheet back towards the head."""
    edge = front.places[-AROUND:]
    outward = edge - middle
    outward -= np.outer(outward @ deep, deep) / float(deep @ deep)
    outward /= np.linalg.norm(outward, axis=1, keepdims=True)
    first, ring = len(front.places), np.arange(AROUND)
    after = (ring + 1) % AROUND
    near, far = first + ring, first + AROUND + ring
    belt = [
        np.stack([near, far, first + AROUND + after], axis=1),
        np.stack([near, first + AROUND + after, first + after], axis=1),
    ]
    return Sheet(
        sealed(np.concatenate([front.places, edge, edge - deep])),
        sealed(np.concatenate([front.normals, outward, outward])),
        sealed(np.concatenate([front.shares, np.zeros((2 * AROUND, 2))])),
        np.concatenate([front.triangles, *belt]).astype(np.int32),
    )


def _steps(places: Floats, shapes: tuple[Capsule, ...], step: Floats, clear: float) -> int:
    """How often places must be moved until none is in a shape or nearer to one than `clear` [m]."""
    for count in range(MOST_STEPS):
        moved = places + count * step
        if all(float(np.min(_distances(shape, moved))) >= clear for shape in shapes):
            return count
    return 0


def _points(shell: SegmentShell) -> Floats:
    """(n, 3) [m] corners and middles of triangles."""
    corners = shell.vertices[shell.triangles]
    return sealed(np.concatenate([corners.reshape(-1, 3), corners.mean(axis=1)]))


def _before(points: Floats, middle: Floats, axes: Floats, half: Floats, size: float) -> float:
    """[m] by which a sheet comes forward until no point of a head's front comes through it."""
    across, up, ahead = ((points - middle) @ axes.T).T
    bend = SCREEN_RADIUS * size
    behind = (np.abs(across) < half[0] + RIM * size) & (np.abs(up) < half[1] + RIM * size) & (ahead > -DEEP * size)
    if not behind.any():
        return 0.0
    sheet = np.sqrt(bend**2 - across[behind] ** 2) - bend
    return max(float(np.max(ahead[behind] - sheet)) + CLEAR * size, 0.0)


def _distances(shape: Capsule, places: Floats) -> Floats:
    """(v,) [m] from places to the surface of a capsule, less than 0 within."""
    way = shape.end - shape.start
    share = np.clip((places - shape.start) @ way / max(float(way @ way), 1e-12), 0.0, 1.0)
    return sealed(np.linalg.norm(places - shape.start - np.outer(share, way), axis=1) - shape.radius)
