"""Hand poses and strokes for tests."""

from kinesic.body.arrays import sealed
from kinesic.body.reach import Reach
from kinesic.expressivity.hands.poses import Poses
from kinesic.expressivity.keyframes import Hand

FREE_STROKES = {"g1": frozenset({"stroke"}), "g2": frozenset({"stroke"})}


def reach(x, y, z):
    return Hand(Reach(sealed([x, y, z])))


A, B, C = reach(0.25, -0.1, 0.8), reach(0.25, -0.2, 0.75), reach(0.25, -0.3, 0.85)
L, M = reach(0.25, 0.2, 0.8), reach(0.25, 0.3, 0.75)


def right(*hands):
    return Poses({"r": hands}, stroke=len(hands) // 2)


def both():
    return Poses({"l": (L, M), "r": (A, B)}, stroke=1)
