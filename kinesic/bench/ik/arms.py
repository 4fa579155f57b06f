"""Arms and targets for the benches: upper22's, and random ones of every shape."""

import numpy as np
from numpy.random import Generator

from kinesic.body.arrays import Floats, sealed
from kinesic.body.chain import Chain, ChainJoint
from kinesic.body.skeleton import Hinge

AXES = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}
SHOULDERS = ("yxz", "xyz", "zxz", "yx")
ELBOWS = ("xz", "yz", "xyz", "yxz")  # of a forearm that hangs: the last hinge twists it
BENT_ELBOWS = ("x", "y", "xy", "yx", "xz", "yz")  # of one that stands off at zero: all hinges swing it
TILTS = (0.0, 0.0, 0.4, 0.9, 1.5)  # [rad] of the forearm off the hanging direction at zero
WRISTS = ("yx", "xy", "y")


def random_arm(chance: Generator) -> Chain:
    """Makes an arm with some hinge order, ranges and lengths: with and without twist, with one or two elbow hinges."""
    tilt, aside = float(chance.choice(TILTS)), chance.uniform(0.0, 2.0 * np.pi)
    elbows = BENT_ELBOWS if tilt > 0.0 else ELBOWS
    shoulder, elbow, wrist = (str(chance.choice(names)) for names in (SHOULDERS, elbows, WRISTS))
    hanging = np.array([0.0, 0.0, -1.0])
    standing = np.array([np.sin(tilt) * np.cos(aside), np.sin(tilt) * np.sin(aside), -np.cos(tilt)])
    bends = [_bends(chance), *(_around(chance, 0.6, 2.8) for _ in elbow[1:])]
    parts = (
        ("shoulder", shoulder, [_around(chance, 0.6, 2.8) for _ in shoulder], chance.uniform(0.15, 0.4) * hanging),
        ("elbow", elbow, bends, chance.uniform(0.15, 0.4) * standing),
        ("wrist", wrist, [_around(chance, 0.4, 1.2) for _ in wrist], 0.08 * hanging),
    )
    joints = tuple(ChainJoint(name, _hinges(name, axes, ranges), sealed(bone)) for name, axes, ranges, bone in parts)
    count = sum(len(joint.hinges) for joint in joints)
    origin = sealed([0.0, 0.2 if chance.random() < 0.5 else -0.2, 0.0])
    name = f"{shoulder} {elbow} {wrist} {tilt}"
    return Chain(name, "trunk", origin, joints, tuple(range(count)), sealed([0.0, 1.0, 0.0]))


def targets(chance: Generator, chain: Chain, count: int) -> Floats:
    """Chooses targets where the hand is in random postures inside the ranges, (count, 3) [m]."""
    return np.array([chain.hand(chance.uniform(chain.lower, chain.upper)) for _ in range(count)])


def _bends(chance: Generator) -> tuple[float, float]:
    """An elbow's range: to both sides or to one."""
    bend = chance.uniform(1.8, 2.6)
    return ((-bend, bend), (-bend, 0.0), (0.0, bend))[chance.integers(3)]


def _around(chance: Generator, least: float, most: float) -> tuple[float, float]:
    return -chance.uniform(least, most), chance.uniform(least, most)


def _hinges(name: str, axes: str, ranges: list[tuple[float, float]]) -> tuple[Hinge, ...]:
    return tuple(
        Hinge(f"{name}{k}", name, sealed(AXES[axis]), lower, upper, 0.0)
        for k, (axis, (lower, upper)) in enumerate(zip(axes, ranges, strict=True))
    )
