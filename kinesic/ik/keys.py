"""Arm postures at successive key frames, each solved from the previous one."""

from collections.abc import Sequence
from dataclasses import dataclass
from enum import IntEnum

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.body.chain import Chain
from kinesic.body.reach import Reach
from kinesic.ik.arm.compiled import arm_of


class ArmMode(IntEnum):
    """Kind of arm target at a key frame."""

    REST = 0  # the key's rest posture
    STILL = 1  # the posture of the previous key
    REACH = 2


@dataclass(frozen=True)
class Key:
    """Target of an arm at a key frame, in its base frame."""

    mode: ArmMode
    rest: Floats  # (k,) [rad] rest posture, preferred for angles that the reach leaves free
    reach: Reach | None = None  # hand target of `ArmMode.REACH`
    openness: float = 0.0  # fraction of the swivel change from the solved posture to `ReachLimits.open_swivel`
    passing: bool = False  # whether the key lies on a path: solved from the path's start posture, with its swivel


@dataclass(frozen=True)
class ReachLimits:
    """Limits of elbow swivel and hinge rotation between key frames."""

    max_swivel_change: float  # [rad] largest swivel change that serves palm and pointing directions
    max_hinge_step: (
        float  # [rad] largest hinge rotation between keys; beyond it, the elbow keeps its swivel if possible
    )
    open_swivel: float  # [rad] swivel of the elbow at openness 1


@dataclass(frozen=True, eq=False)
class KeyArms:
    """Solved postures of an arm at all its key frames."""

    angles: Floats  # (m, k) [rad]
    beginnings: Floats  # (m, k) [rad] posture at the start of the path to which each key belongs
    swivels: Floats  # (m,) [rad] swivels kept on a path or set by `openness`; NaN elsewhere


def pose_keys(
    chain: Chain,
    keys: Sequence[Key],
    limits: ReachLimits,
    *,
    start: Floats,
    path_start: Floats | None,
) -> KeyArms:
    """Solve the arm posture at each key frame, from the previous one.

    Args:
        chain: the arm.
        keys: in their order.
        limits: of swivel changes and hinge rotations, the same for all keys.
        start: (k,) [rad] posture before the first key.
        path_start: (k,) [rad] posture at the start of the current path; None if the first key starts one.

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
    if not (np.isfinite(places[0, has_reach]).all() and np.isfinite(rests).all() and np.isfinite(start).all()):
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
        np.ascontiguousarray(start, dtype=np.float64),
        np.full(hinges, np.nan) if path_start is None else np.ascontiguousarray(path_start, dtype=np.float64),
        limits.max_swivel_change,
        limits.max_hinge_step,
        limits.open_swivel,
        key_arms.angles,
        key_arms.beginnings,
        key_arms.swivels,
    )
    return key_arms
