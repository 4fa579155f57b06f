"""Geometry of the curved face screen on a robot's head."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from kinesic.body.arrays import Floats, sealed
from kinesic.body.robot import Robot
from kinesic.body.skeleton import Capsule
from kinesic.sim.shells.shell import SegmentShell
from kinesic.sim.shells.variant import find_shell

SCREEN_WIDTHS = (0.238, 0.300)  # [arm lengths] smallest and largest width of the face screen (upper22: 126 mm wide)
SCREEN_TO_HEAD_WIDTH = 0.72  # width of the face screen / width of the head
SCREEN_ASPECT = 4 / 3  # width / height of the face screen
SCREEN_RADIUS = 0.26  # [arm lengths] radius of the face screen's cylinder around a vertical axis
FRAME_RIM_WIDTH = 0.014  # [arm lengths] visible width of the face screen's frame
FRAME_SET_BACK = 0.004  # [arm lengths] distance of the frame behind the picture, which avoids coplanar triangles
FRAME_DEPTH = 0.085  # [arm lengths] depth of the face screen's frame from front to back
EYES_TO_SCREEN_DROP = 0.014  # [arm lengths] height of the site between the eyes above the screen's centre
HEAD_CLEARANCE = 0.006  # [arm lengths] smallest distance between the head's capsules and the picture
CORNER_EXPONENT = 5.0  # exponent n of the screen's rounded outline |u|^n + |v|^n = 1
SHEET_RINGS = 5  # concentric rings of vertices in the face screen's mesh
RING_VERTICES = 40  # vertices per ring of the face screen's mesh
FORWARD_STEP = 0.002  # [arm lengths] step by which the face screen is moved forward, clear of the head
MAX_FORWARD_STEPS = 100  # largest number of forward steps of the face screen


@dataclass(frozen=True, eq=False)
class Sheet:
    """Triangle mesh fixed to a segment."""

    places: Floats  # (v, 3) [m] vertices in the segment
    normals: Floats  # (v, 3) unit vectors
    texture_coordinates: Floats  # (v, 2) fraction of the picture's width from the left and of its height from the top
    triangles: NDArray[np.int32]  # (t, 3) vertex indices, counterclockwise from outside


@dataclass(frozen=True, eq=False)
class ScreenSurface:
    """Curved surface on which a face is shown, in the segment's frame."""

    middle: Floats  # (3,) [m]
    axes: Floats  # (3, 3) rows: to the left of the robot, up and forward
    half: Floats  # (2,) [m] half the width and half the height
    bend: float  # [m] radius around the vertical axis

    def place(self, shares: Floats, ahead: float = 0.0) -> tuple[Floats, Floats]:
        """Return screen points (n, 3) [m] and normals at picture positions.

        Args:
            shares: (n, 2) fraction of the picture's width from the left and of its height from the top.
            ahead: [m] distance of the points in front of the surface.
        """
        angle = (2.0 * shares[:, 0] - 1.0) * self.half[0] / self.bend
        normals = np.stack([np.sin(angle), np.zeros_like(angle), np.cos(angle)], axis=1)
        local = (self.bend + ahead) * normals - [0.0, 0.0, self.bend]
        local[:, 1] = (1.0 - 2.0 * shares[:, 1]) * self.half[1]
        return self.middle + local @ self.axes, normals @ self.axes


@dataclass(frozen=True, eq=False)
class FaceScreen:
    """Meshes of a face screen: displayed picture and surrounding frame."""

    segment: str
    picture: Sheet
    frame: Sheet
    surface: ScreenSurface


def build_face_screen(robot: Robot) -> FaceScreen | None:
    """Build the face screen of a robot, or return None.

    Returns:
        None if the robot has a skin, or no site `eyes`, or one that faces vertically or is not on the neck chain.
    """
    eyes, neck = robot.sites.get("eyes"), robot.chains.get("neck", ())
    if eyes is None or robot.skin is not None or (neck and eyes.segment not in neck):
        return None
    left = np.cross([0.0, 0.0, 1.0], eyes.facing)
    if not left.any():
        return None
    left /= np.linalg.norm(left)
    axes = np.stack([left, np.cross(eyes.facing, left), eyes.facing])
    size, middle = robot.arm_length, eyes.position - EYES_TO_SCREEN_DROP * robot.arm_length * axes[1]
    shapes = robot.skeleton.segments[robot.skeleton.segment(eyes.segment)].capsules
    shell = find_shell(robot)
    head_shell = None if shell is None else shell.segments.get(eyes.segment)
    width = SCREEN_TO_HEAD_WIDTH * _measure_head_width(head_shell, shapes, left)
    width = min(max(width, SCREEN_WIDTHS[0] * size), SCREEN_WIDTHS[1] * size)
    half = np.array([width, width / SCREEN_ASPECT]) / 2
    picture = _make_sheet(middle, axes, half, size)
    shell_offset = (
        0.0 if head_shell is None else _find_forward_offset(_list_points(head_shell), middle, axes, half, size)
    )
    forward = (
        FORWARD_STEP
        * size
        * _count_steps(picture.places, shapes, FORWARD_STEP * size * eyes.facing, HEAD_CLEARANCE * size)
    )
    forward = max(forward, shell_offset)
    picture = _make_sheet(middle + forward * eyes.facing, axes, half, size)
    behind = middle + (forward - FRAME_SET_BACK * size) * eyes.facing
    front = _make_sheet(behind, axes, half + FRAME_RIM_WIDTH * size, size)
    surface = ScreenSurface(sealed(middle + forward * eyes.facing), sealed(axes), sealed(half), SCREEN_RADIUS * size)
    frame = _add_side_walls(front, FRAME_DEPTH * size * eyes.facing, middle)
    return FaceScreen(eyes.segment, picture, frame, surface)


def _measure_head_width(shell: SegmentShell | None, shapes: tuple[Capsule, ...], left: Floats) -> float:
    """Return the width [m] of a head's shell or capsules."""
    if shell is not None:
        return float(np.ptp(shell.vertices @ left))
    ends = [(float(end @ left), shape.radius) for shape in shapes for end in (shape.start, shape.end)]
    return max((y + r for y, r in ends), default=0.0) - min((y - r for y, r in ends), default=0.0)


def _make_sheet(middle: Floats, axes: Floats, half: Floats, size: float) -> Sheet:
    """Return a rounded rectangle bent around the vertical axis.

    Its vertices lie on concentric rings around the middle.
    """
    turns = 2 * np.pi * np.arange(RING_VERTICES) / RING_VERTICES
    outline = np.stack(
        [np.sign(f(turns)) * np.abs(f(turns)) ** (2 / CORNER_EXPONENT) for f in (np.cos, np.sin)], axis=1
    )
    flat = np.concatenate([np.zeros((1, 2)), *(outline * ring / SHEET_RINGS for ring in range(1, SHEET_RINGS + 1))])
    across, up = (flat * half).T
    angle, bend = across / (SCREEN_RADIUS * size), SCREEN_RADIUS * size
    local = np.stack([bend * np.sin(angle), up, bend * (np.cos(angle) - 1.0)], axis=1)
    normals = np.stack([np.sin(angle), np.zeros_like(angle), np.cos(angle)], axis=1)
    texture_coordinates = np.stack([(1.0 + flat[:, 0]) / 2, (1.0 - flat[:, 1]) / 2], axis=1)
    ring = np.arange(RING_VERTICES)
    after = (ring + 1) % RING_VERTICES
    fan = np.stack([np.zeros(RING_VERTICES, dtype=int), 1 + ring, 1 + after], axis=1)
    belts = []
    for k in range(SHEET_RINGS - 1):
        inner, outer = 1 + k * RING_VERTICES, 1 + (k + 1) * RING_VERTICES
        belts += [np.stack([inner + ring, outer + ring, outer + after], axis=1)]
        belts += [np.stack([inner + ring, outer + after, inner + after], axis=1)]
    triangles = np.concatenate([fan, *belts]).astype(np.int32)
    return Sheet(sealed(middle + local @ axes), sealed(normals @ axes), sealed(texture_coordinates), triangles)


def _add_side_walls(front: Sheet, deep: Floats, middle: Floats) -> Sheet:
    """Add side walls from a sheet's edge back towards the head."""
    edge = front.places[-RING_VERTICES:]
    outward = edge - middle
    outward -= np.outer(outward @ deep, deep) / float(deep @ deep)
    outward /= np.linalg.norm(outward, axis=1, keepdims=True)
    first, ring = len(front.places), np.arange(RING_VERTICES)
    after = (ring + 1) % RING_VERTICES
    near, far = first + ring, first + RING_VERTICES + ring
    belt = [
        np.stack([near, far, first + RING_VERTICES + after], axis=1),
        np.stack([near, first + RING_VERTICES + after, first + after], axis=1),
    ]
    return Sheet(
        sealed(np.concatenate([front.places, edge, edge - deep])),
        sealed(np.concatenate([front.normals, outward, outward])),
        sealed(np.concatenate([front.texture_coordinates, np.zeros((2 * RING_VERTICES, 2))])),
        np.concatenate([front.triangles, *belt]).astype(np.int32),
    )


def _count_steps(places: Floats, shapes: tuple[Capsule, ...], step: Floats, clearance: float) -> int:
    """Count the forward steps that move points clear of the head.

    0 if `MAX_FORWARD_STEPS` are not enough.

    Args:
        places: (v, 3) [m] points.
        shapes: Capsules of the head.
        step: (3,) [m] translation of one step.
        clearance: [m] smallest distance to every capsule.
    """
    for count in range(MAX_FORWARD_STEPS):
        moved = places + count * step
        if all(float(np.min(_measure_distances(shape, moved))) >= clearance for shape in shapes):
            return count
    return 0


def _list_points(shell: SegmentShell) -> Floats:
    """Return the corners and centroids (n, 3) [m] of all triangles."""
    corners = shell.vertices[shell.triangles]
    return sealed(np.concatenate([corners.reshape(-1, 3), corners.mean(axis=1)]))


def _find_forward_offset(points: Floats, middle: Floats, axes: Floats, half: Floats, size: float) -> float:
    """Return the forward offset [m] that keeps the head behind the screen."""
    across, up, forward = ((points - middle) @ axes.T).T
    bend = SCREEN_RADIUS * size
    behind = (
        (np.abs(across) < half[0] + FRAME_RIM_WIDTH * size)
        & (np.abs(up) < half[1] + FRAME_RIM_WIDTH * size)
        & (forward > -FRAME_DEPTH * size)
    )
    if not behind.any():
        return 0.0
    sheet = np.sqrt(bend**2 - across[behind] ** 2) - bend
    return max(float(np.max(forward[behind] - sheet)) + HEAD_CLEARANCE * size, 0.0)


def _measure_distances(shape: Capsule, places: Floats) -> Floats:
    """Return distances (v,) [m] from points to a capsule's surface.

    Negative inside.
    """
    axis = shape.end - shape.start
    fraction = np.clip((places - shape.start) @ axis / max(float(axis @ axis), 1e-12), 0.0, 1.0)
    return sealed(np.linalg.norm(places - shape.start - np.outer(fraction, axis), axis=1) - shape.radius)
