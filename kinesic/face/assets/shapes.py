"""Which expression shapes of the head make each action unit.

The shapes are those of the Face Units pack: 52, and the inner brow's cut in two. What a shape shows was judged on
pictures of both heads against the appearance changes that the Facial Action Coding System lists.
"""

from collections.abc import Mapping

import numpy as np

from kinesic.body.action_units import CHANNELS, UNITS, channels
from kinesic.body.arrays import Floats, sealed

SIDES = {"L": "Left", "R": "Right"}

# SIDE stands for Left or Right in units that have sides.
SHAPES: Mapping[int, Mapping[str, float]] = {
    1: {"browInnerUpSIDE": 1.0},
    2: {"browOuterUpSIDE": 1.0},
    4: {"browDownSIDE": 1.0},
    5: {"eyeWideSIDE": 1.0},
    6: {"cheekSquintSIDE": 1.0, "eyeSquintSIDE": 0.3},  # orbicularis oculi pushes the lower lid up as well
    7: {"eyeSquintSIDE": 1.0},
    9: {"noseSneerSIDE": 1.0, "mouthUpperUpSIDE": 0.15, "browDownSIDE": 0.2},  # the levator draws brow and lip along
    10: {"mouthUpperUpSIDE": 1.0, "noseSneerSIDE": 0.25},  # the furrow beside the nose deepens with the lip
    11: {"noseSneerSIDE": 0.4, "mouthUpperUpSIDE": 0.2},
    12: {"mouthSmileSIDE": 0.85},  # at full weight the cheek folds on itself
    13: {"mouthSmileSIDE": 0.5, "cheekSquintSIDE": 0.3, "mouthPressSIDE": 0.2},  # corners sharply up, cheeks puffy
    14: {"mouthDimpleSIDE": 1.0},
    15: {"mouthFrownSIDE": 1.0},
    16: {"mouthLowerDownSIDE": 1.0},
    17: {"mouthShrugLower": 1.0, "mouthShrugUpper": 0.4},  # the chin boss pushes both lips up
    18: {"mouthPucker": 1.0},
    19: {"tongueOut": 1.0, "jawOpen": 0.25},  # the tongue needs the teeth apart
    20: {"mouthStretchSIDE": 1.0},
    22: {"mouthFunnel": 1.0},
    23: {"mouthRollLower": 0.45, "mouthRollUpper": 0.35, "mouthPucker": 0.2},  # narrow lips, no corner moves
    24: {"mouthRollLower": 0.5, "mouthRollUpper": 0.4},  # the pack's mouthPress lifts the corners as a smile would
    25: {"mouthLowerDownLeft": 0.7, "mouthLowerDownRight": 0.7, "mouthUpperUpLeft": 0.3, "mouthUpperUpRight": 0.3},
    26: {"jawOpen": 0.55},  # as far as it falls when its muscle relaxes
    27: {"jawOpen": 1.0, "mouthStretchLeft": 0.1, "mouthStretchRight": 0.1},
    28: {"mouthRollLower": 1.0, "mouthRollUpper": 1.0},
    29: {"jawForward": 1.0},
    30: {"jawSIDE": 1.0},
    32: {"mouthRollLower": 0.8, "mouthUpperUpLeft": 0.35, "mouthUpperUpRight": 0.35},  # the lower lip at the teeth
    34: {"cheekPuff": 1.0},
    43: {"eyeBlinkSIDE": 1.0},
    45: {"eyeBlinkSIDE": 1.0},
    46: {"eyeBlinkSIDE": 1.0, "cheekSquintSIDE": 0.4},  # a wink is helped by the cheek
    61: {"eyeLookOutLeft": 1.0, "eyeLookInRight": 1.0},  # of these four the lids; the eyeballs turn
    62: {"eyeLookInLeft": 1.0, "eyeLookOutRight": 1.0},
    63: {"eyeLookUpLeft": 1.0, "eyeLookUpRight": 1.0},
    64: {"eyeLookDownLeft": 1.0, "eyeLookDownRight": 1.0},
}


def shape_mixing(shapes: tuple[str, ...]) -> Floats:
    """(s, c) weight of each of a mesh's shapes in each of `CHANNELS`.

    Args:
        shapes: names, in the mesh's order.
    """
    found = np.zeros((len(shapes), len(CHANNELS)))
    for number in UNITS:
        for channel in channels(number):
            for shape, weight in SHAPES[number].items():
                name = shape.replace("SIDE", SIDES.get(channel[0], ""))
                found[shapes.index(name), CHANNELS.index(channel)] = weight
    return sealed(found)
