"""Variation: how much one gesture differs from the next, as one person's gestures do.

Nobody makes the same beat twice. In captured takes of one person, the durations of beats have a standard deviation of
13 to 21 % and the lengths of their ways of 31 to 36 %; the same beat, repeated, is taken to vary half as much. A
deviation follows from the seed and amount, the block's id, and the gesture's id and number among the block's gestures,
so that a performance can be repeated. Where a hand is, is part of what some gestures mean: they keep place and size.
Nor do all hinges of a person move at one time: shoulders lead and wrists follow, and one hand of two is a little later.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from math import sqrt
from zlib import crc32

import numpy as np

from kinesic.bml.block import RANGES, Behaviour, Block, Gesture, Pointing
from kinesic.body.arrays import Floats, sealed
from kinesic.body.robot import OTHER_SIDE, Robot, Side
from kinesic.expressivity.lexicon.form import GestureForm, HandPose, StrokeKey
from kinesic.expressivity.lexicon.legibility_table import legibility_table
from kinesic.expressivity.lexicon.space import shift_position, spread_hands
from kinesic.expressivity.style.style import Expressivity, Style

GOLDEN = (sqrt(5.0) - 1.0) / 2.0  # step of a sequence on the circle whose neighbours are well apart

SPATIAL = 0.5  # most that spatial extent differs, like all of these at amount 1
TEMPORAL = 0.3  # and temporal extent: an eighth of the time of each phase; half of it follows from the size
PLACE = 0.05  # [arm lengths] along each axis: 3 cm of a person
MIRROR_OFFSET = (
    0.04  # [arm lengths] along each axis, that the left hand of two is beside the mirror image of the right one
)
NEAR_HANDS = 0.45  # [arm lengths] from hand to hand, below which they stay mirror images
OUTWARD = 1  # among the coordinates of a place
OTHER_HAND = 0.25  # share of gestures that the other hand makes, where the document leaves it open
BEHIND = 0.03, 0.08  # [s] that one hand of two follows the other
LEFT_LEADS = 0.25  # share of gestures that the left hand leads
LOOSE = 0.035, 0.065  # [s] that the wrist comes later than the shoulder on the ways there and back
EITHER_HAND = frozenset(("beat", "iconic", "metaphoric"))  # categories without a hand of their own


@dataclass(frozen=True)
class Variation:
    """How far gestures differ from what the lexicon and the style say."""

    amount: float = 0.0  # 0 not at all .. 1 as those of a person .. 2 twice as far
    seed: int = 0  # the same seed gives the same performance


EXACT = Variation()
HERE = sealed(np.zeros(3))


@dataclass(frozen=True, eq=False)
class Deviation:
    """How one gesture differs from what was asked."""

    spatial: float  # of the spatial extent
    temporal: float  # of the temporal extent
    place: Floats  # (3,) forward, outward, up [arm lengths] of all stroke keys
    apart: Floats  # (3,) likewise of the left hand of two, beside that
    other_hand: bool  # whether the hand that would not have been taken makes it, where either may
    leader: Side = "r"  # of two hands
    behind: float = 0.0  # [s] that the other one follows
    loose: float = 0.0  # [s] that the wrist comes later than the shoulder

    @property
    def in_place(self) -> "Deviation":
        """The same without what would take a hand from its place."""
        return replace(self, spatial=0.0, place=HERE, apart=HERE, behind=0.0)

    @property
    def follower(self) -> Side:
        """The hand that comes later, of two."""
        return OTHER_SIDE[self.leader]

    def style(self, style: Style) -> Style:
        """Changes the style of a behaviour, inside the ranges of its numbers; the body is as large as the hands."""
        return replace(
            style, gesture=self._manner(style.gesture), head=self._manner(style.head), torso=self._manner(style.torso)
        )

    def _manner(self, manner: Expressivity) -> Expressivity:
        return replace(
            manner,
            spatial=_within("spatial", manner.spatial + self.spatial),
            temporal=_within("temporal", manner.temporal + self.temporal),
        )

    def form(self, form: GestureForm, robot: Robot) -> GestureForm:
        """Shifts the stroke keys of a gesture; fixed axes, hands that touch and rest poses stay where they are."""
        if form.rest or not self.place.any():
            return form
        apart = HERE if _hands_meet(form) else self.apart
        return replace(form, keys=tuple(self._key(key, apart, robot) for key in form.keys))

    def order_hands(self, options: list[GestureForm]) -> list[GestureForm]:
        """Puts the other hand first where it makes the gesture."""
        return options[::-1] if self.other_hand and options[0].category in EITHER_HAND else options

    def _key(self, key: StrokeKey, apart: Floats, robot: Robot) -> StrokeKey:
        shifts = {"l": self.place + apart, "r": self.place}
        moved = StrokeKey({side: _shift_pose(pose, shifts[side], robot) for side, pose in key.hands.items()})
        return moved if all(pose.fixed[1] or pose.touch for pose in key.hands.values()) else spread_hands(moved)


def _hands_meet(form: GestureForm) -> bool:
    """Whether both hands come so near that what they do, they do to one another; or there is one hand alone."""
    gaps = [sum(pose.position[OUTWARD] for pose in key.hands.values()) for key in form.keys if len(key.hands) > 1]
    return min(gaps, default=0.0) < NEAR_HANDS


def _shift_pose(pose: HandPose, shift: Floats, robot: Robot) -> HandPose:
    if pose.touch is not None:
        return pose
    free = sealed(np.where(pose.fixed, 0.0, shift))
    path = pose.path and pose.path.mapped(pose.path.amplitude, lambda point: sealed(point + free))
    return replace(pose, position=shift_position(pose.position, free, robot), path=path)


def needs_place(form: GestureForm) -> bool:
    """Whether a gesture would mean something else, or nothing, where its hands were elsewhere."""
    touching = any(pose.touch for key in form.keys for pose in key.hands.values())
    return touching or form.id in legibility_table().places


def deviations(block: Block, variation: Variation) -> Mapping[str, Deviation]:
    """Finds how each gesture of a block differs.

    Spatial extents step through a sequence that begins by chance, so that a gesture differs plainly from
    the one before it.

    Args:
        block: whose gestures and pointing vary.
        variation: how far, and with which seed.

    Returns:
        Behaviour id -> deviation; empty where nothing varies.
    """
    if variation.amount == 0.0:
        return {}
    varied = [behaviour for behaviour in block.behaviours if isinstance(behaviour.action, Gesture | Pointing)]
    return {behaviour.id: _deviation(block, behaviour, k, variation) for k, behaviour in enumerate(varied)}


def _deviation(block: Block, behaviour: Behaviour, number: int, variation: Variation) -> Deviation:
    first = np.random.default_rng((variation.seed, crc32(block.id.encode()))).uniform()
    chance = np.random.default_rng((variation.seed, crc32(f"{block.id}:{behaviour.id}".encode()), number))
    extent = 2.0 * ((first + number * GOLDEN) % 1.0) - 1.0
    temporal, *place = chance.uniform(-1.0, 1.0, 4)
    other_hand = float(chance.uniform()) < variation.amount * OTHER_HAND
    apart = chance.uniform(-1.0, 1.0, 3)
    return Deviation(
        spatial=variation.amount * SPATIAL * extent,
        temporal=variation.amount * TEMPORAL * (float(temporal) - extent) / 2.0,  # what is larger takes longer
        place=sealed(variation.amount * PLACE * np.array(place)),
        apart=sealed(variation.amount * MIRROR_OFFSET * apart),
        other_hand=other_hand,
        leader="l" if chance.uniform() < LEFT_LEADS else "r",
        behind=variation.amount * float(chance.uniform(*BEHIND)),
        loose=variation.amount * float(chance.uniform(*LOOSE)),
    )


def _within(name: str, value: float) -> float:
    least, most = RANGES[name]
    return min(max(value, least), most)
