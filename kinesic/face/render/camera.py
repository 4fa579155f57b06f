"""Camera, head rotation and the lights attached to the camera."""

import math
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.rotation import rotation_about
from kinesic.face.display import DisplayError

HEAD_CENTRE = (-0.055, 0.0, -0.028)  # [m] centre of the head, around which the camera turns
NEAR_PLANE = 0.1  # [m] nearest visible distance from the camera
FAR_PLANE = 10.0  # [m] farthest visible distance from the camera
MAX_CAMERA_DISTANCE = 7.0  # [m] largest distance of the camera from its pivot
MIN_CAMERA_DISTANCE = 0.3  # [m] smallest distance of the camera from its pivot
Colour = tuple[float, float, float]
Direction = tuple[float, float, float]


@dataclass(frozen=True)
class Camera:
    """Camera that looks horizontally at the head's centre or another point."""

    yaw_deg: float = 0.0  # [deg] 0 is frontal, 90 shows the left side of the head, 180 the back
    distance: float = 0.85  # [m] distance from the pivot
    field_deg: float = 19.0  # [deg] vertical field of view
    turn: tuple[float, float, float] = (0.0, 0.0, 0.0)  # [rad] head turned left, up, tilted to its right
    pivot: Direction = HEAD_CENTRE  # [m] point in the centre of the picture

    def __post_init__(self) -> None:
        if not math.isfinite(self.yaw_deg):
            raise DisplayError(f"yaw {self.yaw_deg:g} is not finite")
        if not MIN_CAMERA_DISTANCE <= self.distance <= MAX_CAMERA_DISTANCE:
            raise DisplayError(
                f"camera {self.distance:g} m away; use {MIN_CAMERA_DISTANCE:g} to {MAX_CAMERA_DISTANCE:g} m"
            )

    def view(self) -> Floats:
        """Return the (4, 4) transform from the head's frame to the camera's.

        In the camera's frame, x points right in the picture, y up, z towards the viewer.
        """
        return _compute_view(self)

    def lens(self, aspect: float) -> tuple[float, float]:
        """Return half of the visible width and height at distance 1."""
        half = math.tan(math.radians(self.field_deg) / 2)
        return half * aspect, half

    def projection(self, aspect: float) -> Floats:
        """Return the (4, 4) perspective projection for an aspect ratio.

        The aspect ratio is width / height.
        """
        across, up = self.lens(aspect)
        matrix = np.zeros((4, 4))
        matrix[0, 0], matrix[1, 1] = 1.0 / across, 1.0 / up
        matrix[2, 2] = (FAR_PLANE + NEAR_PLANE) / (NEAR_PLANE - FAR_PLANE)
        matrix[2, 3] = 2 * FAR_PLANE * NEAR_PLANE / (NEAR_PLANE - FAR_PLANE)
        matrix[3, 2] = -1.0
        return matrix


@lru_cache(maxsize=8)
def _compute_view(camera: Camera) -> Floats:
    """Return a camera's (4, 4) view transform, cached for all passes."""
    yaw = math.radians(camera.yaw_deg)
    towards = np.array([math.cos(yaw), math.sin(yaw), 0.0])
    up = np.array([0.0, 0.0, 1.0])
    rotation = np.array([np.cross(up, towards), up, towards]) @ compute_head_rotation(*camera.turn)
    view = np.eye(4)
    view[:3, :3] = rotation
    view[:3, 3] = rotation @ -np.array(camera.pivot) - np.array([0.0, 0.0, camera.distance])
    return sealed(view)


def compute_head_rotation(left: float, up: float, over: float) -> Floats:
    """Return the (3, 3) rotation of a head.

    Args:
        left: turn to its left [rad], applied first.
        up: turn up [rad].
        over: tilt over to its right [rad].
    """
    x, y, z = np.eye(3)
    return np.asarray(rotation_about(z, left) @ rotation_about(y, -up) @ rotation_about(x, over))


FRONT_CAMERA = Camera()  # camera in front of the face at the default distance
CLOSE_CAMERA = Camera(field_deg=15.0)  # camera for which the face fills the picture


@dataclass(frozen=True)
class Lamp:
    """Directional light with direction and colour."""

    towards: Direction  # unit direction in the camera's frame: x right, y up, z towards the viewer
    power: Colour  # linear RGB strength


@dataclass(frozen=True)
class Lights:
    """Three lamps that move with the camera, and ambient light.

    The ambient light comes from above and below.
    """

    key: Lamp
    fill: Lamp
    rim: Lamp
    sky: Colour
    ground: Colour

    def directions(self) -> Floats:
        """Return (3, 3) unit vectors towards key, fill and rim lamp."""
        vectors = np.array([lamp.towards for lamp in (self.key, self.fill, self.rim)])
        return np.asarray(vectors / np.linalg.norm(vectors, axis=1, keepdims=True))

    def powers(self) -> Floats:
        """Return the RGB powers (3, 3) of key, fill and rim lamp."""
        return np.array([lamp.power for lamp in (self.key, self.fill, self.rim)])

    def scaled(self, factor: float) -> "Lights":
        """Return all lamps and ambient light scaled by a factor."""

        def scale(colour: Colour) -> Colour:
            red, green, blue = colour
            return factor * red, factor * green, factor * blue

        key, fill, rim = (replace(lamp, power=scale(lamp.power)) for lamp in (self.key, self.fill, self.rim))
        return Lights(key, fill, rim, scale(self.sky), scale(self.ground))


STUDIO_LIGHTS = Lights(
    key=Lamp((-0.55, 0.60, 0.75), (1.00, 0.93, 0.85)),
    fill=Lamp((0.80, 0.10, 0.60), (0.26, 0.29, 0.34)),
    rim=Lamp((0.55, 0.45, -0.75), (0.75, 0.80, 0.90)),
    sky=(0.30, 0.32, 0.36),
    ground=(0.20, 0.165, 0.145),
)
