"""Mirror images of chains and targets, for right arms."""

from dataclasses import replace
from functools import lru_cache

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.chain import Chain, ChainJoint
from kinesic.body.reach import Reach

MIRROR_SIGNS = sealed([1.0, -1.0, 1.0])  # signs that mirror a position or direction in the xz plane
MIRRORED_AXIS_SIGNS = sealed([-1.0, 1.0, -1.0])  # signs that mirror a hinge axis; equal angles mirror the posture


def is_right(chain: Chain) -> bool:
    """Return whether a chain's first joint lies right of the midline."""
    return bool(chain.origin_in_base[1] < 0)


@lru_cache(maxsize=32)
def mirror_chain(chain: Chain) -> Chain:
    """Mirror a chain so that equal angles give mirror-image postures."""
    joints = tuple(
        ChainJoint(
            joint.name,
            tuple(replace(hinge, axis=_seen(hinge.axis, MIRRORED_AXIS_SIGNS)) for hinge in joint.hinges),
            _seen(joint.bone, MIRROR_SIGNS),
        )
        for joint in chain.joints
    )
    return replace(
        chain,
        origin_in_base=_seen(chain.origin_in_base, MIRROR_SIGNS),
        joints=joints,
        palm=_seen(chain.palm, MIRROR_SIGNS),
    )


def mirror_reach(reach: Reach) -> Reach:
    """Mirror a hand target, keeping its swivel angle.

    The swivel counts outward on both sides.
    """
    return Reach(
        _seen(reach.position, MIRROR_SIGNS),
        None if reach.pointing is None else _seen(reach.pointing, MIRROR_SIGNS),
        None if reach.palm is None else _seen(reach.palm, MIRROR_SIGNS),
        reach.swivel,
    )


def mirror_place(place: Floats) -> Floats:
    """Mirror a position (3,) across the midline plane."""
    return _seen(place, MIRROR_SIGNS)


def _seen(values: Floats, signs: Floats) -> Floats:
    return sealed(np.asarray(values) * signs + 0.0)  # adding 0 turns -0.0 into 0.0
