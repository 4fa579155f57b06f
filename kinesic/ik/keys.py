"""Arm postures at successive keys, each solved from the previous one."""

from collections.abc import Sequence
from dataclasses import dataclass
from enum import IntEnum

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.body.chain import Chain
from kinesic.body.reach import Reach
from kinesic.ik.arm.compiled import arm_of


class ArmMode(IntEnum):
    """Kind of arm target at a key."""

    REST = 0  # the key's rest posture
    STILL = 1  # the posture of the previous key
    REACH = 2


@dataclass(frozen=True)
class Key:
    """Target of one hand at a key, in the arm's base frame."""

    mode: ArmMode
    rest: Floats  # (k,) [rad] rest posture, preferred for angles that the reach leaves free
    reach: Reach | None = None  # hand target of `ArmMode.REACH`
    openness: float = 0.0  # fraction of the way from the hanging elbow to the swivel `ReachManner.open`
    passing: bool = False  # on a path: the swivel is kept, and the nearest posture to where the path began is taken


@dataclass(frozen=True)
class ReachManner:
    """Limits of an arm's elbow swing and hinge steps between keys."""

    widest: float  # [rad] that an elbow swings aside for the palm and the pointing of its hand
    leap: float  # [rad] of a hinge from key to key, at most, where the elbow need not swing for these
    open: float  # [rad] swivel of the elbow at openness 1


@dataclass(frozen=True, eq=False)
class KeyArms:
    """Solved postures of an arm at all its keys."""

    angles: Floats  # (m, k) [rad]
    beginnings: Floats  # (m, k) [rad] posture at the start of the path to which each key belongs
    swivels: Floats  # (m,) [rad] requested swivels; NaN without


def pose_keys(
    chain: Chain,
    keys: Sequence[Key],
    manner: ReachManner,
    *,
    now: Floats,
    began: Floats | None,
) -> KeyArms:
    """Solve the arm posture at each key, starting from the previous one.

    Args:
        chain: the arm.
        keys: in their order.
        manner: of all keys.
        now: (k,) [rad] the arm before the first key.
        began: (k,) [rad] the arm as the path began that it is on before the first key; `now` where it is on none.

    Raises:
        ValueError: a shape is wrong or a number is not finite.
    """
    count, hinges = len(keys), len(chain.rest)
    places = np.full((3, count, 3), np.nan)  # positions, pointings, palms
    swivels = np.full(count, np.nan)
    for k, key in enumerate(keys):
        if key.reach is None:
            continue
        for table, given in zip(places, (key.reach.position, key.reach.pointing, key.reach.palm), strict=True):
            if given is not None:
                table[k] = given
        if key.reach.swivel is not None:
            swivels[k] = key.reach.swivel
    rests = np.reshape([key.rest for key in keys], (count, hinges))
    has_reach = np.array([key.mode is ArmMode.REACH for key in keys], dtype=bool)
    if not (np.isfinite(places[0, has_reach]).all() and np.isfinite(rests).all() and np.isfinite(now).all()):
        raise ValueError("keys: every position, rest and start must be finite")
    key_arms = KeyArms(np.empty((count, hinges)), np.empty((count, hinges)), np.empty(count))
    arm_of(chain).pose_keys(
        np.array([key.mode for key in keys], dtype=np.int64),
        np.array([key.passing for key in keys], dtype=bool),
        places[0],
        places[1],
        places[2],
        swivels,
        np.ascontiguousarray(rests, dtype=np.float64),
        np.array([key.openness for key in keys], dtype=np.float64),
        np.ascontiguousarray(now, dtype=np.float64),
        np.full(hinges, np.nan) if began is None else np.ascontiguousarray(began, dtype=np.float64),
        manner.widest,
        manner.leap,
        manner.open,
        key_arms.angles,
        key_arms.beginnings,
        key_arms.swivels,
    )
    return key_arms
