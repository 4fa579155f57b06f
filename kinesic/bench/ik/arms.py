"""Robot arms and hand targets for benchmarks of inverse kinematics.

They are upper22's arm and random arms of every shape.
"""

import numpy as np
from numpy.random import Generator

from kinesic.body.arrays import Floats, sealed
from kinesic.body.chain import Chain, ChainJoint
from kinesic.body.skeleton import Hinge

AXIS_VECTORS = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}  # unit vectors of the axis letters
SHOULDER_ORDERS = ("yxz", "xyz", "zxz", "yx")  # hinge axes of random shoulders, from the base outwards
ELBOW_ORDERS = ("xz", "yz", "xyz", "yxz")  # hinge axes of elbows if the forearm hangs at zero; the last axis twists it
BENT_ELBOW_ORDERS = ("x", "y", "xy", "yx", "xz", "yz")  # hinge axes of elbows if the forearm is tilted; all swing it
FOREARM_TILTS = (0.0, 0.0, 0.4, 0.9, 1.5)  # [rad] forearm angles from vertical at zero joint angles
WRIST_ORDERS = ("yx", "xy", "y")  # hinge axes of random wrists, from the forearm outwards


def random_arm(rng: Generator) -> Chain:
    """Return an arm with random joint order, ranges and lengths.

    It may lack twist and has one to three elbow joints.
    """
    tilt, azimuth = float(rng.choice(FOREARM_TILTS)), rng.uniform(0.0, 2.0 * np.pi)
    elbows = BENT_ELBOW_ORDERS if tilt > 0.0 else ELBOW_ORDERS
    shoulder, elbow, wrist = (str(rng.choice(names)) for names in (SHOULDER_ORDERS, elbows, WRIST_ORDERS))
    hanging = np.array([0.0, 0.0, -1.0])
    standing = np.array([np.sin(tilt) * np.cos(azimuth), np.sin(tilt) * np.sin(azimuth), -np.cos(tilt)])
    bends = [_draw_bend_range(rng), *(_random_range(rng, 0.6, 2.8) for _ in elbow[1:])]
    parts = (
        ("shoulder", shoulder, [_random_range(rng, 0.6, 2.8) for _ in shoulder], rng.uniform(0.15, 0.4) * hanging),
        ("elbow", elbow, bends, rng.uniform(0.15, 0.4) * standing),
        ("wrist", wrist, [_random_range(rng, 0.4, 1.2) for _ in wrist], 0.08 * hanging),
    )
    joints = tuple(ChainJoint(name, _hinges(name, axes, ranges), sealed(bone)) for name, axes, ranges, bone in parts)
    count = sum(len(joint.hinges) for joint in joints)
    origin = sealed([0.0, 0.2 if rng.random() < 0.5 else -0.2, 0.0])
    name = f"{shoulder} {elbow} {wrist} {tilt}"
    return Chain(name, "trunk", origin, joints, tuple(range(count)), sealed([0.0, 1.0, 0.0]))


def draw_targets(rng: Generator, chain: Chain, count: int) -> Floats:
    """Sample reachable hand targets (count, 3) [m] from random postures within ranges."""
    return np.array([chain.hand(rng.uniform(chain.lower, chain.upper)) for _ in range(count)])


def _draw_bend_range(rng: Generator) -> tuple[float, float]:
    """Return a random elbow range: to both sides or to one side."""
    bend = rng.uniform(1.8, 2.6)
    return ((-bend, bend), (-bend, 0.0), (0.0, bend))[rng.integers(3)]


def _random_range(rng: Generator, smallest: float, largest: float) -> tuple[float, float]:
    return -rng.uniform(smallest, largest), rng.uniform(smallest, largest)


def _hinges(name: str, axes: str, ranges: list[tuple[float, float]]) -> tuple[Hinge, ...]:
    return tuple(
        Hinge(f"{name}{k}", name, sealed(AXIS_VECTORS[axis]), lower, upper, 0.0)
        for k, (axis, (lower, upper)) in enumerate(zip(axes, ranges, strict=True))
    )
