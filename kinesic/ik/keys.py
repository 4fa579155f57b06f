"""The postures of an arm from key to key: each begins where the one before it has left the arm.

The compiled kernel answers all keys in one call; what stands here is its specification.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from enum import IntEnum

import numpy as np
from msgspec import structs

from kinesic.body.arrays import Floats
from kinesic.body.chain import Chain
from kinesic.body.reach import Reach
from kinesic.ik.arm.compiled import KERNEL, arm_of
from kinesic.ik.arm.swivel import swivel
from kinesic.ik.pointing import best_swivel
from kinesic.ik.solve import solve
from kinesic.kernels import Kernel


class ArmMode(IntEnum):
    """What an arm does in a key."""

    REST = 0  # it takes the key's rest
    STILL = 1  # it stays as it is
    REACH = 2


@dataclass(frozen=True)
class Key:
    """What one hand is asked in a key, in the frame of its arm's base."""

    mode: ArmMode
    rest: Floats  # (k,) [rad] of whatever the reach leaves open
    reach: Reach | None = None  # of `Mode.REACH`
    openness: float = 0.0  # how far the elbow turns from where the hand lets it hang to `Manner.open`
    passing: bool = False  # on a path: the swivel is kept, and the nearest posture to where the path began is taken


@dataclass(frozen=True)
class ReachManner:
    """How far an arm goes for its hand."""

    widest: float  # [rad] that an elbow swings aside for the palm and the pointing of its hand
    leap: float  # [rad] of a hinge from key to key, at most, where the elbow need not swing for these
    open: float  # [rad] swivel at openness 1


@dataclass(frozen=True, eq=False)
class KeyArms:
    """An arm in each of its keys."""

    angles: Floats  # (m, k) [rad]
    beginnings: Floats  # (m, k) [rad] the arm as the path began that it is then on
    swivels: Floats  # (m,) [rad] that were asked; NaN where none was


def pose_keys(
    chain: Chain,
    keys: Sequence[Key],
    manner: ReachManner,
    *,
    now: Floats,
    began: Floats | None,
    kernel: Kernel = KERNEL,
) -> KeyArms:
    """Solves an arm for each of its keys.

    Args:
        chain: the arm.
        keys: in their order.
        manner: of all keys.
        now: (k,) [rad] the arm before the first key.
        began: (k,) [rad] the arm as the path began that it is on before the first key; `now` where it is on none.
        kernel: which implementation answers; "numpy" is the specification of the other.

    Raises:
        ValueError: a shape is wrong or a number is not finite.
    """
    if kernel == "compiled":
        return _compiled(chain, keys, manner, now, began)
    angles, beginnings, swivels = [], [], []
    here, before = now, began
    for key in keys:
        here, asked = _posture(chain, key, manner, here, here if before is None else before, kernel)
        before = before if key.passing and before is not None else here
        angles.append(here)
        beginnings.append(before)
        swivels.append(np.nan if asked is None else asked)
    shape = (len(keys), len(chain.rest))
    return KeyArms(np.reshape(angles, shape), np.reshape(beginnings, shape), np.array(swivels))


def _compiled(chain: Chain, keys: Sequence[Key], manner: ReachManner, now: Floats, began: Floats | None) -> KeyArms:
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
    asked = np.array([key.mode is ArmMode.REACH for key in keys], dtype=bool)
    if not (np.isfinite(places[0, asked]).all() and np.isfinite(rests).all() and np.isfinite(now).all()):
        raise ValueError("keys: every position, rest and start must be finite")
    found = KeyArms(np.empty((count, hinges)), np.empty((count, hinges)), np.empty(count))
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
        found.angles,
        found.beginnings,
        found.swivels,
    )
    return found


def _posture(
    chain: Chain, key: Key, manner: ReachManner, now: Floats, began: Floats, kernel: Kernel
) -> tuple[Floats, float | None]:
    """The arm (k,) [rad] in one key, and the swivel that was asked of it."""
    if key.reach is None or key.mode is not ArmMode.REACH:
        return key.rest if key.mode is ArmMode.REST else now, None
    if key.passing:
        asked = structs.replace(key.reach, swivel=swivel(chain, began))
        return solve(chain, asked, start=began, rest=key.rest, kernel=kernel).angles, asked.swivel
    free = _swing_elbow(chain, key.reach, key.rest, manner, now, kernel)
    opened = structs.replace(key.reach, swivel=_opened(chain, free, key.openness, manner.open))
    if opened.swivel is not None:
        free = solve(chain, opened, start=free, rest=key.rest, kernel=kernel).angles
    return free, opened.swivel


def _swing_elbow(
    chain: Chain, reach: Reach, rest: Floats, manner: ReachManner, start: Floats, kernel: Kernel
) -> Floats:
    """Swings the elbow for palm and pointing, (k,) [rad]; where an arm would turn over for that, it stays as it was."""
    swung = best_swivel(chain, reach, start=start, rest=rest, widest=manner.widest, kernel=kernel).angles
    kept = swivel(chain, start)
    if kept is None or np.abs(swung - start).max() <= manner.leap:
        return swung
    plain = solve(chain, structs.replace(reach, swivel=kept), start=start, rest=rest, kernel=kernel)
    return plain.angles if plain.reached and np.abs(plain.angles - start).max() <= manner.leap else swung


def _opened(chain: Chain, angles: Floats, openness: float, widest: float) -> float | None:
    """Swivel [rad] that openness asks of an arm; None where it asks nothing."""
    present = swivel(chain, angles)
    if openness <= 0.0 or present is None or present >= widest:
        return None
    return float(present + openness * (widest - present))
