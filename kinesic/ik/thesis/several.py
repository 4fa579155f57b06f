"""Several simultaneous targets for connected limbs (thesis Algorithm 2).

All hands are put on their targets, and the masses of the whole tree are relaxed to equilibrium. A joint that several
limbs have in common is one mass that all its limbs pull, so no centroid has to be computed. Such a joint has only one
rotation: the weighted mean of the limbs' rotations, or that of the limb with priority. Each limb then reaches for its
target again from the actual position of this joint.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.rotation import mean_rotation
from kinesic.ik.scalar3 import clamp_to_reach, vector
from kinesic.ik.solve import as_triple
from kinesic.ik.thesis.limbs import Limb, Limbs
from kinesic.ik.thesis.limits import within_limits
from kinesic.ik.thesis.rotations import Carrier, ChainPosture, aim_bones, stance_of
from kinesic.ik.thesis.solve import ChainStart, Method, bend_straight_chain, solve_ball_chain
from kinesic.ik.thesis.springs import Springs
from kinesic.ik.thesis.task import Effort, Rest
from kinesic.ik.thesis.verlet import swing_to_rest

PULL_DECAY = 0.1  # factor per iteration on weights of limbs ranked below the first limb that misses its target
MIN_PULL = 1e-3  # smallest weight of a limb after decay, as weaker springs would hardly settle


def standing_limbs(limbs: Limbs) -> dict[str, ChainPosture]:
    """Return the rest posture of each limb."""
    stances: dict[str, ChainPosture] = {}
    for limb in limbs.members:
        carrier = Carrier.at_rest(limb.chain) if limb.on is None else stances[limb.on].end
        stances[limb.name] = stance_of(limb.chain, np.broadcast_to(np.eye(3), limb.chain.frames.shape), carrier)
    return stances


@dataclass(frozen=True, eq=False)
class RelaxedTree:
    """Relaxed mass positions, targets, weights and priority of a tree's limbs."""

    points: Mapping[str, Floats]  # (n + 1, 3) [m] masses at rest, per limb
    targets: Mapping[str, Floats]  # (3,) [m] of the limbs that have one, within reach
    pulls: Mapping[str, float]  # weights of the limbs
    priority: Sequence[str]  # limb names; of the limbs on one joint, the first in this list alone decides the rotation


def turn_joints(
    limbs: Limbs, before: Mapping[str, ChainPosture], tree: RelaxedTree, *, method: Method, effort: Effort
) -> dict[str, ChainPosture]:
    """Rotate all joints towards their point masses, from the root outward.

    Args:
        limbs: the tree.
        before: initial stances.
        tree: relaxed masses and targets of the limbs.
        method: with which a limb solves for its target again, from the actual position of its carrier.
        effort: of that solution; lengths in units of `Limbs.size`.
    """
    stances: dict[str, ChainPosture] = {}
    turns: dict[str, Floats] = {}
    for limb in limbs.members:
        chain, begun, points = limb.chain, before[limb.name].rotations, tree.points[limb.name]
        if limb.on is None:
            ground = Carrier.at_rest(chain)
            stance = within_limits(chain, aim_bones(chain, begun, points, ground), points[-1], ground)
        else:
            rest, carrier = chain.frames[0], stances[limb.on].end
            turned = Carrier(carrier.point, carrier.rotation @ turns[limb.on])
            footing = Carrier(turned.point + turned.rotation @ (chain.points[1] - chain.points[0]), turned.rotation)
            outer = _outer(
                limb,
                begun[1:],
                tree,
                footing,
                method=method,
                effort=replace(effort, tolerance=effort.tolerance * limbs.size / chain.size),
            )
            first = rest.T @ turns[limb.on] @ rest
            stance = stance_of(chain, np.concatenate([first[None], outer]), carrier)
        stances[limb.name] = stance
        if siblings := limbs.hanging_on(limb.name):
            turns[limb.name] = _common_rotation(siblings, before, stance.end, tree)
    return stances


def _outer(limb: Limb, begun: Floats, tree: RelaxedTree, footing: Carrier, *, method: Method, effort: Effort) -> Floats:
    """Solve a limb's joint rotations (k, 3, 3) beyond its first bone.

    Empty for a limb of one bone.
    """
    if not len(begun):
        return begun
    chain, points, target = limb.chain.beyond(1), tree.points[limb.name][1:], tree.targets.get(limb.name)
    stance = within_limits(chain, aim_bones(chain, begun, points, footing), points[-1], footing)
    if target is None:
        return stance.rotations
    start = ChainStart(stance.rotations, footing)
    return solve_ball_chain(chain, target, method=method, start=start, effort=effort).rotations


def _common_rotation(
    siblings: Sequence[Limb], before: Mapping[str, ChainPosture], carrier: Carrier, tree: RelaxedTree
) -> Floats:
    """Return the rotation matrix of limbs' common joint, by priority or mean.

    The first limb in `priority` decides alone; without one, it is the rotation mean weighted by pulls.
    """
    turns: dict[str, Floats] = {}
    for limb in siblings:
        rest = limb.chain.frames[0]
        aimed = aim_bones(limb.chain, before[limb.name].rotations, tree.points[limb.name], carrier)
        turns[limb.name] = rest @ aimed.rotations[0] @ rest.T
    for name in tree.priority:
        if name in turns:
            return turns[name]
    return mean_rotation(np.array(list(turns.values())), np.array([tree.pulls[name] for name in turns]))


@dataclass(frozen=True, eq=False)
class Reached:
    """Postures of a limb tree, with the remaining distances to the targets."""

    stances: Mapping[str, ChainPosture]  # of each limb, bones at their true lengths
    residuals: Mapping[str, float]  # [m] from each end that has a target to that target
    rounds: int
    iterations: int  # number of relaxation iterations of the whole tree


def solve_several(
    limbs: Limbs,
    targets: Mapping[str, Floats],
    *,
    weights: Mapping[str, float] | None = None,
    priority: Sequence[str] = (),
    method: Method = "position",
    effort: Effort | None = None,
) -> Reached:
    """Move the ends of several limbs to their targets.

    Args:
        limbs: the tree.
        targets: (3,) [m] per limb; an end without a target is free.
        weights: how strongly limbs pull, and how much they count in the rotation that they share; 1 by default.
        priority: limbs whose target comes before those of limbs named later or not at all.
        method: of the limbs' own reach.
        effort: tolerances and caps; lengths in units of `Limbs.size`.

    Raises:
        ValueError: an unknown limb, no target, a target that is not three finite numbers, a weight not above zero.
    """
    effort = effort or Effort()
    checked_targets = _checked(limbs, targets, weights or {}, priority)
    pulls = {limb.name: float((weights or {}).get(limb.name, 1.0)) for limb in limbs.members}
    near = {
        name: sealed(clamp_to_reach(vector(t), vector(limbs.root(name)), limbs.reach[name]))
        for name, t in checked_targets.items()
    }
    ranks = [name for name in priority if name in checked_targets] + [
        name for name in checked_targets if name not in priority
    ]
    stances = standing_limbs(limbs)
    best, least, iterations, done = stances, [np.inf], 0, 0
    while done < effort.rounds:
        relaxed = _relax_masses(limbs, stances, near, pulls, effort)
        points = {name: limbs.size * relaxed.points[rows] for name, rows in limbs.indices.items()}
        tree = RelaxedTree(points, near, dict(pulls), priority)
        stances = turn_joints(limbs, stances, tree, method=method, effort=effort)
        iterations, done = iterations + relaxed.iterations, done + 1
        misses = [float(np.linalg.norm(stances[name].points[-1] - near[name])) / limbs.size for name in ranks]
        late = [miss if miss > effort.tolerance else 0.0 for miss in misses]
        merit = late if priority else [sum(pulls[name] * miss for name, miss in zip(ranks, late, strict=True))]
        if merit < least:
            best, least = stances, merit
        if not any(late):
            break
        if priority:
            first = next(k for k, miss in enumerate(late) if miss)
            pulls |= {name: max(PULL_DECAY * pulls[name], MIN_PULL) for name in ranks[first + 1 :]}
    residuals = {
        name: float(np.linalg.norm(best[name].points[-1] - target)) for name, target in checked_targets.items()
    }
    return Reached(best, residuals, done, iterations)


def _relax_masses(
    limbs: Limbs,
    stances: Mapping[str, ChainPosture],
    near: Mapping[str, Floats],
    pulls: Mapping[str, float],
    effort: Effort,
) -> Rest:
    """Relax all point masses of a limb tree, scaled to unit size."""
    count = 1 + max(max(rows) for rows in limbs.indices.values())
    points, masses = np.zeros((count, 3)), np.ones(count)
    pairs: list[tuple[int, int]] = []
    pinned: set[int] = set()
    for limb in reversed(limbs.members):
        rows, chain, stance = limbs.indices[limb.name], limb.chain, stances[limb.name]
        points[rows], masses[rows] = stance.points / limbs.size, chain.masses
        if limb.name in near:
            points[rows[-1]] = near[limb.name] / limbs.size
            pinned.add(rows[-1])
        points[rows] = bend_straight_chain(points[rows], stance.frames[:, :, 2])
        pinned |= {rows[0]} if limb.on is None else set()
        pairs = list(pairwise(rows)) + pairs
    springs = Springs.between(
        pairs,
        rests=np.concatenate([limb.chain.lengths for limb in limbs.members]) / limbs.size,
        stiffness=np.concatenate([pulls[limb.name] * limb.chain.stiffness for limb in limbs.members]),
        masses=masses,
        pinned=pinned,
    )

    def arrived(now: Floats) -> bool:
        lengths = np.linalg.norm(springs.incidence @ now, axis=1)
        return bool(np.abs(lengths - springs.rests).sum() <= effort.tolerance)

    return swing_to_rest(springs, points, damping=limbs.members[0].chain.damping, effort=effort, arrived=arrived)


def _checked(
    limbs: Limbs, targets: Mapping[str, Floats], weights: Mapping[str, float], priority: Sequence[str]
) -> dict[str, Floats]:
    names = [limb.name for limb in limbs.members]
    for name in (*targets, *weights, *priority):
        if name not in names:
            raise ValueError(f"there is no limb {name}; the limbs are {', '.join(names)}")
    if not targets:
        raise ValueError(f"no target is given; at least one of {', '.join(names)} needs one")
    for name, weight in weights.items():
        if not 0.0 < weight < np.inf:
            raise ValueError(f"weight of {name} is {weight}; weights are above zero and finite")
    return {name: as_triple(f"target of {name}", target) for name, target in targets.items()}
