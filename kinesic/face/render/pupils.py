"""Pupil diameter in the light on the face, and its dynamics.

Both pupils have the same diameter.
"""

import math
from collections.abc import Mapping

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.face.assets.action_units import compute_lid_closure, read_intensities
from kinesic.face.render.camera import Camera, Lights

MIN_PUPIL_DIAMETER = 2e-3  # [m] pupil diameter in bright light
MAX_PUPIL_DIAMETER = 7e-3  # [m] pupil diameter in darkness
SCENE_LUMINANCE = 10.0  # [cd/m^2] luminance seen in light of strength 1: a room in the evening
LID_TRANSMITTANCE = 0.03  # fraction of light through closed lids
CONSTRICTION_TIME = 0.4  # [s] time constant of pupils that narrow
DILATION_TIME = 1.4  # [s] time constant of pupils that widen
LUMINANCE_WEIGHTS = np.array([0.2126, 0.7152, 0.0722])  # luminance weights of linear RGB (ITU-R BT.709)


def compute_settled_diameter(light: float) -> float:
    """Return the steady pupil diameter [m] (P. Moon, D. E. Spencer, 1944).

    Args:
        light: light on the eyes, linear as in pictures; 0 is darkness.
    """
    exponent = math.log10(max(SCENE_LUMINANCE * light, 1e-9))
    return min(max(1e-3 * (4.9 - 3.0 * math.tanh(0.4 * exponent)), MIN_PUPIL_DIAMETER), MAX_PUPIL_DIAMETER)


def compute_light_on_eyes(lights: Lights, units: Mapping[str, float], camera: Camera) -> float:
    """Return the linear luminance of the light on a face's eyes.

    Args:
        lights: lights attached to the camera.
        units: action unit -> 0..1, as in `Command.face`; closed lids block light.
        camera: camera of the picture.

    Raises:
        DisplayError: an unknown action unit, or an intensity outside 0..1.
    """
    ahead = camera.view()[:3, 0]
    lamps = np.maximum(lights.directions() @ ahead, 0.0) @ lights.powers()
    around: Floats = np.array(lights.ground) + (0.5 + 0.5 * ahead[1]) * (np.array(lights.sky) - lights.ground)
    shut = compute_lid_closure(read_intensities(units))
    return float((lamps + around) @ LUMINANCE_WEIGHTS) * (1.0 - (1.0 - LID_TRANSMITTANCE) * shut)


class Pupils:
    """Pupils of a face, whose diameter adapts to light over time."""

    def __init__(self) -> None:
        self.diameter: float | None = None  # [m]; None before the first call of `follow`

    def follow(self, light: float, seconds: float) -> float:
        """Advance by `seconds` [s] and return the pupils' new diameter [m].

        The first call returns the diameter settled under the light, which is as from `compute_light_on_eyes`.
        """
        goal = compute_settled_diameter(light)
        if self.diameter is None:
            self.diameter = goal
        lag = CONSTRICTION_TIME if goal < self.diameter else DILATION_TIME
        self.diameter += (goal - self.diameter) * -math.expm1(-max(seconds, 0.0) / lag)
        return self.diameter
