"""Where the face is looked at from, how the head is turned before it, and the lights that stand with the camera."""

import math
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.rotation import about
from kinesic.face.display import DisplayError

PIVOT = (-0.055, 0.0, -0.028)  # [m] middle of the head, round which the camera goes
NEAR, FAR = 0.1, 10.0  # [m]
FAREST = 7.0  # [m]
NEAREST = 0.3  # [m]
Colour = tuple[float, float, float]
Direction = tuple[float, float, float]


@dataclass(frozen=True)
class Camera:
    """A camera that looks at the middle of the head, or at another point, from its own height."""

    yaw_deg: float = 0.0  # 0 is frontal, 90 shows the left side of the head, 180 the back
    distance: float = 0.85  # [m] from what it looks at
    field_deg: float = 19.0  # of view, upright
    turn: tuple[float, float, float] = (0.0, 0.0, 0.0)  # [rad] of the head: to its left, up, and over to its right
    pivot: Direction = PIVOT  # [m] what it looks at

    def __post_init__(self) -> None:
        if not math.isfinite(self.yaw_deg):
            raise DisplayError(f"yaw {self.yaw_deg:g} is no angle")
        if not NEAREST <= self.distance <= FAREST:
            raise DisplayError(f"camera {self.distance:g} m away; it may be {NEAREST:g} to {FAREST:g} m away")

    def view(self) -> Floats:
        """(4, 4) from the head's frame to the camera's: x to the right of the picture, y up, z towards the viewer."""
        return _view(self)

    def lens(self, aspect: float) -> tuple[float, float]:
        """Half of what is seen at a distance of 1, across and up."""
        half = math.tan(math.radians(self.field_deg) / 2)
        return half * aspect, half

    def projection(self, aspect: float) -> Floats:
        """(4, 4) of perspective, for a picture of an aspect (width / height)."""
        across, up = self.lens(aspect)
        found = np.zeros((4, 4))
        found[0, 0], found[1, 1] = 1.0 / across, 1.0 / up
        found[2, 2] = (FAR + NEAR) / (NEAR - FAR)
        found[2, 3] = 2 * FAR * NEAR / (NEAR - FAR)
        found[3, 2] = -1.0
        return found


@lru_cache(maxsize=8)
def _view(camera: Camera) -> Floats:
    """What `Camera.view` gives: several passes of a picture ask for it."""
    yaw = math.radians(camera.yaw_deg)
    towards = np.array([math.cos(yaw), math.sin(yaw), 0.0])
    up = np.array([0.0, 0.0, 1.0])
    rotation = np.array([np.cross(up, towards), up, towards]) @ head_rotation(*camera.turn)
    found = np.eye(4)
    found[:3, :3] = rotation
    found[:3, 3] = rotation @ -np.array(camera.pivot) - np.array([0.0, 0.0, camera.distance])
    return sealed(found)


def head_rotation(left: float, up: float, over: float) -> Floats:
    """(3, 3) how a head stands that turned to its left, then up, then over to its right [rad]."""
    x, y, z = np.eye(3)
    return np.asarray(about(z, left) @ about(y, -up) @ about(x, over))


FRONT = Camera()
CLOSE = Camera(field_deg=15.0)  # the face fills the picture


@dataclass(frozen=True)
class Lamp:
    """A far light."""

    towards: Direction  # in the camera's frame: x right, y up, z towards the viewer
    power: Colour  # linear


@dataclass(frozen=True)
class Lights:
    """Three lamps that stand with the camera, and the light of a room from above and below."""

    key: Lamp
    fill: Lamp
    rim: Lamp
    sky: Colour
    ground: Colour

    def directions(self) -> Floats:
        """(3, 3) unit vectors towards the lamps."""
        found = np.array([lamp.towards for lamp in (self.key, self.fill, self.rim)])
        return np.asarray(found / np.linalg.norm(found, axis=1, keepdims=True))

    def powers(self) -> Floats:
        """(3, 3) colour of each lamp."""
        return np.array([lamp.power for lamp in (self.key, self.fill, self.rim)])

    def scaled(self, share: float) -> "Lights":
        """Gives lights of which all are brighter by a factor."""

        def scale(colour: Colour) -> Colour:
            red, green, blue = colour
            return share * red, share * green, share * blue

        key, fill, rim = (replace(lamp, power=scale(lamp.power)) for lamp in (self.key, self.fill, self.rim))
        return Lights(key, fill, rim, scale(self.sky), scale(self.ground))


LIGHTS = Lights(
    key=Lamp((-0.55, 0.60, 0.75), (1.00, 0.93, 0.85)),
    fill=Lamp((0.80, 0.10, 0.60), (0.26, 0.29, 0.34)),
    rim=Lamp((0.55, 0.45, -0.75), (0.75, 0.80, 0.90)),
    sky=(0.30, 0.32, 0.36),
    ground=(0.14, 0.115, 0.10),
)
