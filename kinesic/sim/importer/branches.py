"""The branches of a humanoid: two arms, the trunk that carries them, and the head above."""

from dataclasses import dataclass

from kinesic.body.config import ConfigError
from kinesic.sim.importer.mirror import Sides
from kinesic.sim.importer.model_tree import BASE, Tree

FEWEST = 3  # hinges of an arm
FINGER = 0.15  # of the mass of what carries it: a hinge that moves less moves a finger


@dataclass(frozen=True)
class Branches:
    """Indices of hinges from the base outward."""

    trunk: tuple[int, ...]  # carries the arms
    neck: tuple[int, ...]  # moves the head; without the eyes
    left: tuple[int, ...]  # arm, up to where its fingers part
    right: tuple[int, ...]


def branches(tree: Tree, sides: Sides) -> Branches:
    """Arms are the pair of limbs that begins highest; the trunk is what carries them, the head what is above.

    Raises:
        ConfigError: there is no pair of limbs with enough hinges.
    """
    limbs = [_limb(tree, sides, k) for k in sides.pairs if tree.joints[k].parent not in _both(sides)]
    arms = [limb for limb in limbs if len(limb) >= FEWEST]
    if not arms:
        raise ConfigError(
            f"robot {tree.name}: no arms found: among {len(tree.joints)} hinges there are {len(sides.pairs)} mirror "
            f"pairs, but no pair of limbs with {FEWEST} hinges each"
        )
    left = max(arms, key=lambda limb: tree.joints[limb[0]].anchor[2])
    trunk = tree.way(tree.joints[left[0]].parent)
    return Branches(trunk, _neck(tree, sides, trunk, left), left, tuple(sides.pairs[k] for k in left))


def _both(sides: Sides) -> set[int]:
    return set(sides.pairs) | set(sides.pairs.values())


def _limb(tree: Tree, sides: Sides, first: int) -> tuple[int, ...]:
    """From its first hinge to where it parts or only a finger is left, as long as both sides go along."""
    row = [first]
    while True:
        onward = [k for k in tree.children[row[-1]] if k in sides.pairs]
        least = FINGER * tree.parts[row[-1]].mass
        if len(onward) != 1 or tree.lump(tree.below(onward[0])).mass < least:
            return tuple(row)
        row.append(onward[0])


def _neck(tree: Tree, sides: Sides, trunk: tuple[int, ...], arm: tuple[int, ...]) -> tuple[int, ...]:
    """The unpaired branch that ends highest above the shoulders."""
    paired, carriers = _both(sides), (trunk[-1] if trunk else BASE,)
    ways = []
    for first in (k for carrier in carriers for k in tree.children[carrier] if k not in paired):
        way = [first]
        while onward := [k for k in tree.children[way[-1]] if k not in paired]:
            way.append(max(onward, key=lambda k: tree.joints[k].anchor[2]))
        ways.append(tuple(k for k in way if "eye" not in tree.joints[k].name.lower()))
    above = [way for way in ways if way and tree.joints[way[-1]].anchor[2] > tree.joints[arm[0]].anchor[2]]
    return max(above, key=lambda way: tree.joints[way[-1]].anchor[2], default=())
