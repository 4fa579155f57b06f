"""The lights of a portrait: key, fill and rim, and the room."""

from dataclasses import dataclass

import numpy as np

from kinesic.body.arrays import Floats

Colour = tuple[float, float, float]
Direction = tuple[float, float, float]


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


LIGHTS = Lights(
    key=Lamp((-0.55, 0.60, 0.75), (1.00, 0.93, 0.85)),
    fill=Lamp((0.80, 0.10, 0.60), (0.26, 0.29, 0.34)),
    rim=Lamp((0.55, 0.45, -0.75), (0.75, 0.80, 0.90)),
    sky=(0.30, 0.32, 0.36),
    ground=(0.14, 0.115, 0.10),
)
