"""Arm postures at successive keys, each computed from the previous one."""

from collections.abc import Sequence

import numpy as np
from msgspec import structs

from kinesic.body.arrays import Floats
from kinesic.body.chain import Chain
from kinesic.body.reach import Reach
from kinesic.ik.arm.swivel import swivel
from kinesic.ik.keys import ArmMode, Key, KeyArms, ReachLimits

from .pointing import best_swivel
from .solve import solve


def pose_keys(
    chain: Chain, keys: Sequence[Key], limits: ReachLimits, *, start: Floats, path_start: Floats | None
) -> KeyArms:
    """Compute the result of `ik.keys.pose_keys` for valid arguments."""
    angles, beginnings, swivels = [], [], []
    here, before = start, path_start
    for key in keys:
        here, asked = _posture(chain, key, limits, here, here if before is None else before)
        before = before if key.passing and before is not None else here
        angles.append(here)
        beginnings.append(before)
        swivels.append(np.nan if asked is None else asked)
    shape = (len(keys), len(chain.rest))
    return KeyArms(np.reshape(angles, shape), np.reshape(beginnings, shape), np.array(swivels))


def _posture(
    chain: Chain, key: Key, limits: ReachLimits, previous: Floats, path_start: Floats
) -> tuple[Floats, float | None]:
    """Return the arm angles (k,) [rad] at one key, and the requested swivel."""
    if key.reach is None or key.mode is not ArmMode.REACH:
        return key.rest if key.mode is ArmMode.REST else previous, None
    if key.passing:
        asked = structs.replace(key.reach, swivel=swivel(chain, path_start))
        return solve(chain, asked, start=path_start, rest=key.rest).angles, asked.swivel
    free = _swing_elbow(chain, key.reach, key.rest, limits, previous)
    opened = structs.replace(key.reach, swivel=_opened(chain, free, key.openness, limits.open_swivel))
    if opened.swivel is not None:
        free = solve(chain, opened, start=free, rest=key.rest).angles
    return free, opened.swivel


def _swing_elbow(chain: Chain, reach: Reach, rest: Floats, limits: ReachLimits, start: Floats) -> Floats:
    """Change the elbow swivel for palm and pointing, unless the arm would flip."""
    swung = best_swivel(chain, reach, start=start, rest=rest, max_swivel=limits.max_swivel_change).angles
    kept = swivel(chain, start)
    if kept is None or np.abs(swung - start).max() <= limits.max_hinge_step:
        return swung
    plain = solve(chain, structs.replace(reach, swivel=kept), start=start, rest=rest)
    return plain.angles if plain.reached and np.abs(plain.angles - start).max() <= limits.max_hinge_step else swung


def _opened(chain: Chain, angles: Floats, openness: float, open_swivel: float) -> float | None:
    """Return the swivel [rad] for an elbow openness, or None."""
    present = swivel(chain, angles)
    if openness <= 0.0 or present is None or present >= open_swivel:
        return None
    return float(present + openness * (open_swivel - present))
