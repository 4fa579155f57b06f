"""Random variation of gestures, as in human motion.

People never make the same beat twice. In captured takes of one person, the durations of beats have a standard deviation
of 13 to 21 % and their path lengths of 31 to 36 %; the same beat, repeated, is assumed to vary half as much. A
deviation follows from the seed and amount, the block's id, and the gesture's id and number among the block's gestures,
so that a performance can be repeated. Where the hand position is part of a gesture's meaning, position and size do not
vary. The joints of a person do not move simultaneously either: shoulders set out before wrists, and one of two hands is
a little later.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from math import sqrt
from zlib import crc32

import numpy as np

from kinesic.bml.block import EXPRESSIVITY_RANGES, Behaviour, Block, Gesture, Pointing
from kinesic.body.arrays import Floats, sealed
from kinesic.body.robot import Robot, Side
from kinesic.expressivity.lexicon.form import GestureForm, HandPose, StrokeKey
from kinesic.expressivity.lexicon.legibility_table import legibility_table
from kinesic.expressivity.lexicon.space import shift_position, spread_hands
from kinesic.expressivity.style.style import Expressivity, Style

GOLDEN_STEP = (sqrt(5.0) - 1.0) / 2.0  # step of a low-discrepancy sequence in [0, 1)
# Largest deviations at amount 1.
SPATIAL_DEVIATION = 0.5  # largest random change of the spatial extent
TEMPORAL_DEVIATION = 0.3  # largest change of temporal extent: half random, half slower for larger gestures
POSITION_DEVIATION = 0.05  # [arm lengths] largest random shift along each axis: 3 cm of a person
MIRROR_DEVIATION = 0.04  # [arm lengths] largest random shift of the left hand from mirror symmetry, per axis
NEAR_DISTANCE = 0.45  # [arm lengths] distance between hands below which they stay mirror images
OUTWARD_AXIS = 1  # index of the outward coordinate in a position
OTHER_HAND_PROBABILITY = 0.25  # probability of using the other hand, if the document names no hand
HAND_DELAY_RANGE = 0.03, 0.08  # [s] smallest and largest delay of the hand that begins second
LEFT_FIRST_PROBABILITY = 0.25  # probability that the left hand begins a two-handed gesture
WRIST_DELAY_RANGE = 0.035, 0.065  # [s] smallest and largest delay of the wrist after the shoulder
TWO_SIDED_CATEGORIES = frozenset(("beat", "iconic", "metaphoric"))  # gesture categories fit for either hand


@dataclass(frozen=True)
class Variation:
    """Amount and random seed of the variation between gestures."""

    amount: float = 0.0  # 0 none .. 1 as between gestures of a person .. 2 twice as much
    seed: int = 0  # the same seed gives the same performance


NO_VARIATION = Variation()  # no variation: equal gestures are performed identically
NO_SHIFT = sealed(np.zeros(3))  # [arm lengths] position shift of zero


@dataclass(frozen=True, eq=False)
class Deviation:
    """Random difference of one gesture from its lexicon form and style."""

    spatial: float  # change of the spatial extent
    temporal: float  # change of the temporal extent
    place: Floats  # (3,) forward, outward, up [arm lengths] shift of all stroke keys
    apart: Floats  # (3,) forward, outward, up [arm lengths] additional shift of the left hand of two
    other_hand: bool  # whether the other hand performs the gesture, if the document allows either hand
    leader: Side = "r"  # hand that begins first in a two-handed gesture
    behind: float = 0.0  # [s] delay of the hand that begins second
    loose: float = 0.0  # [s] delay of the wrist after the shoulder

    @property
    def in_place(self) -> "Deviation":
        """Random deviation without changes of the hand positions."""
        return replace(self, spatial=0.0, place=NO_SHIFT, apart=NO_SHIFT, behind=0.0)

    def style(self, style: Style) -> Style:
        """Apply the deviation to spatial and temporal extent of a style.

        Head and torso change with the hands.
        """
        return replace(
            style, gesture=self._manner(style.gesture), head=self._manner(style.head), torso=self._manner(style.torso)
        )

    def _manner(self, manner: Expressivity) -> Expressivity:
        return replace(
            manner,
            spatial=_clip_to_range("spatial", manner.spatial + self.spatial),
            temporal=_clip_to_range("temporal", manner.temporal + self.temporal),
        )

    def form(self, form: GestureForm, robot: Robot) -> GestureForm:
        """Apply the deviation to the stroke keys of a gesture.

        Fixed axes, touching hands and rest poses do not move.
        """
        if form.rest or not self.place.any():
            return form
        apart = NO_SHIFT if _hands_meet(form) else self.apart
        return replace(form, keys=tuple(self._key(key, apart, robot) for key in form.keys))

    def order_hands(self, options: list[GestureForm]) -> list[GestureForm]:
        """Put the other hand's form first if the deviation chooses this hand.

        Only gestures of `TWO_SIDED_CATEGORIES` change hands.
        """
        return options[::-1] if self.other_hand and options[0].category in TWO_SIDED_CATEGORIES else options

    def _key(self, key: StrokeKey, apart: Floats, robot: Robot) -> StrokeKey:
        shifts = {"l": self.place + apart, "r": self.place}
        shifted = StrokeKey({side: _shift_pose(pose, shifts[side], robot) for side, pose in key.hands.items()})
        return shifted if all(pose.fixed[1] or pose.touch for pose in key.hands.values()) else spread_hands(shifted)


def _hands_meet(form: GestureForm) -> bool:
    """Return whether a gesture is one-handed or brings the hands close."""
    gaps = [sum(pose.position[OUTWARD_AXIS] for pose in key.hands.values()) for key in form.keys if len(key.hands) > 1]
    return min(gaps, default=0.0) < NEAR_DISTANCE


def _shift_pose(pose: HandPose, shift: Floats, robot: Robot) -> HandPose:
    if pose.touch is not None:
        return pose
    free_shift = sealed(np.where(pose.fixed, 0.0, shift))
    path = pose.path and pose.path.mapped(pose.path.amplitude, lambda point: sealed(point + free_shift))
    return replace(pose, position=shift_position(pose.position, free_shift, robot), path=path)


def needs_place(form: GestureForm) -> bool:
    """Return whether the meaning of a gesture depends on the hand positions."""
    touching = any(pose.touch for key in form.keys for pose in key.hands.values())
    return touching or form.id in legibility_table().places


def deviations(block: Block, variation: Variation) -> Mapping[str, Deviation]:
    """Return the random deviations of a block's gestures and pointing behaviours.

    Spatial extents step through a sequence with a random start, so that successive gestures differ clearly.

    Args:
        block: with the gestures and pointing behaviours.
        variation: amount and seed.

    Returns:
        Behaviour id -> deviation; empty without variation.
    """
    if variation.amount == 0.0:
        return {}
    varied_behaviours = [
        behaviour for behaviour in block.behaviours if isinstance(behaviour.action, Gesture | Pointing)
    ]
    return {behaviour.id: _deviation(block, behaviour, k, variation) for k, behaviour in enumerate(varied_behaviours)}


def _deviation(block: Block, behaviour: Behaviour, index: int, variation: Variation) -> Deviation:
    phase = np.random.default_rng((variation.seed, crc32(block.id.encode()))).uniform()
    generator = np.random.default_rng((variation.seed, crc32(f"{block.id}:{behaviour.id}".encode()), index))
    extent = 2.0 * ((phase + index * GOLDEN_STEP) % 1.0) - 1.0
    temporal, *place = generator.uniform(-1.0, 1.0, 4)
    other_hand = float(generator.uniform()) < variation.amount * OTHER_HAND_PROBABILITY
    apart = generator.uniform(-1.0, 1.0, 3)
    return Deviation(
        spatial=variation.amount * SPATIAL_DEVIATION * extent,
        temporal=variation.amount
        * TEMPORAL_DEVIATION
        * (float(temporal) - extent)
        / 2.0,  # larger gestures take longer
        place=sealed(variation.amount * POSITION_DEVIATION * np.array(place)),
        apart=sealed(variation.amount * MIRROR_DEVIATION * apart),
        other_hand=other_hand,
        leader="l" if generator.uniform() < LEFT_FIRST_PROBABILITY else "r",
        behind=variation.amount * float(generator.uniform(*HAND_DELAY_RANGE)),
        loose=variation.amount * float(generator.uniform(*WRIST_DELAY_RANGE)),
    )


def _clip_to_range(name: str, value: float) -> float:
    least, most = EXPRESSIVITY_RANGES[name]
    return min(max(value, least), most)
