"""Branching chains: limbs that start at the end of others (thesis 7.3.2)."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.body.robot import SIDES, Robot
from kinesic.ik.thesis.chain import BallChain


@dataclass(frozen=True, eq=False)
class Limb:
    """Chain of ball joints, based in the world or on another limb."""

    name: str
    chain: BallChain
    on: str | None = None  # name of the limb that carries it; None: it stands in the world


@dataclass(frozen=True, eq=False)
class Limbs:
    """Tree of limbs, each listed after the limb that carries it.

    First bones of limbs on the same sub-base joint are parts of one rigid body: they turn together. The limits of
    that joint would refer to as many frames as bones leave it, so a limb that hangs on another has none there.
    """

    members: tuple[Limb, ...]

    def __post_init__(self) -> None:
        if not self.members:
            raise ValueError("there is no limb; give at least one limb that is based in the world")
        ends: dict[str, Floats] = {}
        for limb in self.members:
            if limb.name in ends:
                raise ValueError(f"two limbs are named {limb.name}; give each its own name")
            if limb.on is not None:
                self._check(limb, ends)
            ends[limb.name] = limb.chain.points[-1]

    @classmethod
    def of_robot(cls, robot: Robot) -> "Limbs":
        """Make the limbs torso, left arm and right arm of a robot.

        The torso runs from its first segment to the one that carries the arms, which is the sub-base joint.
        """
        skeleton = robot.skeleton
        origins = skeleton.frames(skeleton.rest).origins
        spine = [robot.arms["l"].base]
        while spine[0] != robot.chains["torso"][0]:
            spine.insert(0, skeleton.segments[skeleton.segment(spine[0])].parent or robot.chains["torso"][0])
        rows = {"torso": spine} | {f"{s}_arm": [spine[-1], *robot.arm(s).segments] for s in SIDES}
        chains = {name: BallChain.of([origins[skeleton.segment(s)] for s in row]) for name, row in rows.items()}
        arms = tuple(Limb(name, chain, "torso") for name, chain in chains.items() if name != "torso")
        return cls((Limb("torso", chains["torso"]), *arms))

    @cached_property
    def reach(self) -> dict[str, float]:
        """Largest distance from the tree's base to each limb's end [m]."""
        reach_by_limb: dict[str, float] = {}
        for limb in self.members:
            reach_by_limb[limb.name] = limb.chain.size + (0.0 if limb.on is None else reach_by_limb[limb.on])
        return reach_by_limb

    @property
    def size(self) -> float:
        """Longest reach of any limb, used as length unit [m]."""
        return max(self.reach.values())

    def root(self, name: str) -> Floats:
        """Return the base position [m] of the tree that carries a limb."""
        limb = next(limb for limb in self.members if limb.name == name)
        return limb.chain.points[0] if limb.on is None else self.root(limb.on)

    @cached_property
    def indices(self) -> dict[str, list[int]]:
        """Mass indices of each limb within the tree."""
        indices_by_limb: dict[str, list[int]] = {}
        masses = 0
        for limb in self.members:
            first = [masses] if limb.on is None else [indices_by_limb[limb.on][-1]]
            after = masses + 1 if limb.on is None else masses
            masses = after + len(limb.chain.lengths)
            indices_by_limb[limb.name] = first + list(range(after, masses))
        return indices_by_limb

    def hanging_on(self, name: str) -> list[Limb]:
        """Return the limbs attached to a limb's end."""
        return [limb for limb in self.members if limb.on == name]

    def _check(self, limb: Limb, ends: dict[str, Floats]) -> None:
        if limb.on not in ends:
            raise ValueError(
                f"limb {limb.name} hangs on {limb.on}, which is not among the limbs before it: {list(ends)}"
            )
        gap = float(np.linalg.norm(limb.chain.points[0] - ends[limb.on]))
        if gap > 1e-9 * limb.chain.size:
            raise ValueError(f"limb {limb.name} begins {gap:g} m from the end of {limb.on}; start it at that end")
        limits = limb.chain.limits
        if limits is not None and (np.abs([limits.lower[0], limits.upper[0]]) < limits.widest).any():
            wide = limits.widest.tolist()
            raise ValueError(f"limb {limb.name} limits the joint that it shares; set its first limits to +-{wide}")
