"""Pupils: how wide they are in the light that falls on the face, and how slowly they follow it, both alike."""

import math
from collections.abc import Mapping

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.face.assets.action_units import intensities, lid_closure
from kinesic.face.render.camera import Camera, Lights

SMALLEST, LARGEST = 2e-3, 7e-3  # [m] across
SURROUNDINGS = 10.0  # [cd/m^2] that a face looks at in light of 1: a room in the evening
THROUGH_LIDS = 0.03  # share of the light that closed lids let through
CONSTRICTION, DILATION = 0.4, 1.4  # [s] in which 63 % of a change are done: pupils close fast and open slowly
BRIGHTNESS = np.array([0.2126, 0.7152, 0.0722])  # of linear colours (ITU-R BT.709)


def settled_diameter(light: float) -> float:
    """Gives how wide pupils are [m] after a while in some light (P. Moon, D. E. Spencer, 1944).

    Args:
        light: on the eyes, linear as pictures have it; 0 is darkness.
    """
    exponent = math.log10(max(SURROUNDINGS * light, 1e-9))
    return min(max(1e-3 * (4.9 - 3.0 * math.tanh(0.4 * exponent)), SMALLEST), LARGEST)


def light_on_eyes(lights: Lights, units: Mapping[str, float], camera: Camera) -> float:
    """Adds up the light that falls on the front of a face and through its lids, linear as pictures have it.

    Args:
        lights: that stand with the camera.
        units: action unit -> 0..1, as in `Command.face`; what closes the lids keeps light out.
        camera: that the face is turned to, or from.

    Raises:
        DisplayError: an unknown unit, or an intensity outside 0..1.
    """
    ahead = camera.view()[:3, 0]
    lamps = np.maximum(lights.directions() @ ahead, 0.0) @ lights.powers()
    around: Floats = np.array(lights.ground) + (0.5 + 0.5 * ahead[1]) * (np.array(lights.sky) - lights.ground)
    shut = lid_closure(intensities(units))
    return float((lamps + around) @ BRIGHTNESS) * (1.0 - (1.0 - THROUGH_LIDS) * shut)


class Pupils:
    """The pupils of a face that is seen over time; what either eye sees moves both."""

    def __init__(self) -> None:
        self.diameter: float | None = None  # [m]; None before any light has been seen

    def follow(self, light: float, seconds: float) -> float:
        """Lets time go by in a light, and gives how wide they are then [m]; at first they are settled."""
        goal = settled_diameter(light)
        if self.diameter is None:
            self.diameter = goal
        lag = CONSTRICTION if goal < self.diameter else DILATION
        self.diameter += (goal - self.diameter) * -math.expm1(-max(seconds, 0.0) / lag)
        return self.diameter
