"""The compiled kernel: whether it is there, and an arm as it holds it, packed once per chain."""

from functools import lru_cache
from typing import TYPE_CHECKING

from kinesic.body.chain import Chain
from kinesic.ik.arm.linkage import linkage_of
from kinesic.ik.arm.mirror import is_right, mirror_chain
from kinesic.ik.arm.seeds import seeds
from kinesic.ik.scalar3 import vector
from kinesic.kernels import Kernel, find_kernel

if TYPE_CHECKING:
    from kinesic.ik import _kernel

KERNEL: Kernel = find_kernel("kinesic.ik._kernel")  # which implementation runs


@lru_cache(maxsize=32)
def arm_of(chain: Chain) -> "_kernel.Arm":
    """Packs a chain; a right arm as the left one in its mirror.

    Raises:
        ValueError: the chain is no arm, or has more than 6 joints or 12 hinges.
        ImportError: the kernel was not compiled.
    """
    from kinesic.ik import _kernel  # noqa: PLC0415 - exists only where there was a compiler

    right = is_right(chain)
    left = mirror_chain(chain) if right else chain
    linkage = linkage_of(left)
    return _kernel.Arm(
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
