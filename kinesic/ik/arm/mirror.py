"""Right arms are solved as left ones in a mirror, so that mirrored reaches give the very same angles."""

from dataclasses import replace
from functools import lru_cache

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.chain import Chain, ChainJoint
from kinesic.body.reach import Reach

ACROSS = sealed([1.0, -1.0, 1.0])  # a place or direction in the mirror (the xz plane)
ABOUT = sealed([-1.0, 1.0, -1.0])  # an axis in the mirror, for the same angle


def is_right(chain: Chain) -> bool:
    """Whether a chain begins on the right of the midline."""
    return bool(chain.origin_in_base[1] < 0)


@lru_cache(maxsize=32)
def mirror_chain(chain: Chain) -> Chain:
    """Mirrors a chain; equal angles are mirror postures."""
    joints = tuple(
        ChainJoint(
            joint.name,
            tuple(replace(hinge, axis=_seen(hinge.axis, ABOUT)) for hinge in joint.hinges),
            _seen(joint.bone, ACROSS),
        )
        for joint in chain.joints
    )
    return replace(
        chain, origin_in_base=_seen(chain.origin_in_base, ACROSS), joints=joints, palm=_seen(chain.palm, ACROSS)
    )


def mirror_reach(reach: Reach) -> Reach:
    """Mirrors a reach; the swivel stays, since it counts outward on both sides."""
    return Reach(
        _seen(reach.position, ACROSS),
        None if reach.pointing is None else _seen(reach.pointing, ACROSS),
        None if reach.palm is None else _seen(reach.palm, ACROSS),
        reach.swivel,
    )


def mirror_place(place: Floats) -> Floats:
    """Mirrors a place (3,)."""
    return _seen(place, ACROSS)


def _seen(values: Floats, signs: Floats) -> Floats:
    return sealed(np.asarray(values) * signs + 0.0)  # adding 0 turns -0.0 into 0.0
