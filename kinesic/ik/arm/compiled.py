"""Arm data for the compiled solver, cached per chain."""

from functools import lru_cache

from kinesic._kernel import ik as kernel
from kinesic.body.chain import Chain
from kinesic.ik.arm.linkage import linkage_of
from kinesic.ik.arm.mirror import is_right, mirror_chain
from kinesic.ik.arm.seeds import seeds
from kinesic.ik.scalar3 import vector


@lru_cache(maxsize=32)
def arm_of(chain: Chain) -> kernel.Arm:
    """Convert a chain to solver data, mirroring right arms to left.

    Raises:
        ValueError: the chain is no arm, or has more than 8 joints or 12 hinges.
    """
    right = is_right(chain)
    left = mirror_chain(chain) if right else chain
    linkage = linkage_of(left)
    return kernel.Arm(
        origin=linkage.origin,
        counts=[len(link.pivots) for link in linkage.links],
        bones=[link.bone for link in linkage.links],
        axes=[pivot.axis for pivot in linkage.pivots],
        lower=[pivot.lower for pivot in linkage.pivots],
        upper=[pivot.upper for pivot in linkage.pivots],
        rest=[pivot.rest for pivot in linkage.pivots],
        palm=vector(left.palm),
        side=linkage.side,
        farthest=linkage.farthest,
        closest=linkage.closest,
        mobility=linkage.mobility,
        seeds=[list(seed.angles) for seed in seeds(linkage)],
        mirrored=right,
    )
