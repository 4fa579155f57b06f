"""From the masses of a tree back to its skeleton, where limbs that leave one joint must agree on its rotation."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial.transform import Rotation

from kinesic.body.arrays import Floats
from kinesic.ik.thesis.chain import BallChain
from kinesic.ik.thesis.limbs import Limb, Limbs
from kinesic.ik.thesis.limits import within_limits
from kinesic.ik.thesis.rotations import Carrier, Stance, aim_bones, stance_of
from kinesic.ik.thesis.solve import Method, solve_ball_chain
from kinesic.ik.thesis.task import Effort


def standing_limbs(limbs: Limbs) -> dict[str, Stance]:
    """All limbs at rest."""
    stances: dict[str, Stance] = {}
    for limb in limbs.members:
        carrier = Carrier.at_rest(limb.chain) if limb.on is None else stances[limb.on].end
        stances[limb.name] = stance_of(limb.chain, np.broadcast_to(np.eye(3), limb.chain.frames.shape), carrier)
    return stances


@dataclass(frozen=True, eq=False)
class Wishes:
    """What the skeleton of a tree is turned after."""

    points: Mapping[str, Floats]  # (n + 1, 3) [m] masses at rest, per limb
    targets: Mapping[str, Floats]  # (3,) [m] of the limbs that have one, within reach
    pulls: Mapping[str, float]  # weights of the limbs
    priority: Sequence[str]  # the first of them among the limbs on one joint decides its rotation alone


def turn_joints(
    limbs: Limbs, before: Mapping[str, Stance], wishes: Wishes, *, method: Method, effort: Effort
) -> dict[str, Stance]:
    """Turns the joints of all limbs towards where the masses went, carriers first.

    Args:
        limbs: the tree.
        before: stances to begin with.
        wishes: of the limbs.
        method: by which a limb reaches anew from where its carrier really is.
        effort: of that reach; lengths in units of `Limbs.size`.
    """
    stances: dict[str, Stance] = {}
    turns: dict[str, Floats] = {}
    for limb in limbs.members:
        chain, begun, points = limb.chain, before[limb.name].rotations, wishes.points[limb.name]
        if limb.on is None:
            ground = Carrier.at_rest(chain)
            stance = within_limits(chain, aim_bones(chain, begun, points, ground), points[-1], ground)
        else:
            rest, carrier = chain.frames[0], stances[limb.on].end
            turned = Carrier(carrier.point, carrier.rotation @ turns[limb.on])
            footing = Carrier(turned.point + turned.rotation @ (chain.points[1] - chain.points[0]), turned.rotation)
            outer = _outer(
                chain.beyond(1),
                begun[1:],
                points[1:],
                footing,
                target=wishes.targets.get(limb.name),
                method=method,
                effort=replace(effort, tolerance=effort.tolerance * limbs.size / chain.size),
            )
            first = rest.T @ turns[limb.on] @ rest
            stance = stance_of(chain, np.concatenate([first[None], outer]), carrier)
        stances[limb.name] = stance
        if siblings := limbs.hanging_on(limb.name):
            turns[limb.name] = _agreed(siblings, before, stance.end, wishes)
    return stances


def _outer(
    chain: BallChain,
    begun: Floats,
    points: Floats,
    footing: Carrier,
    *,
    target: Floats | None,
    method: Method,
    effort: Effort,
) -> Floats:
    """(n, 3, 3) rotations of what a limb has beyond its shared bone; none for a limb of one bone."""
    if not len(begun):
        return begun
    stance = within_limits(chain, aim_bones(chain, begun, points, footing), points[-1], footing)
    if target is None:
        return stance.rotations
    return solve_ball_chain(
        chain, target, method=method, start=stance.rotations, carrier=footing, effort=effort
    ).rotations


def _agreed(siblings: Sequence[Limb], before: Mapping[str, Stance], carrier: Carrier, wishes: Wishes) -> Floats:
    """The one rotation (3, 3) away from rest of a joint that several limbs wish to turn, each its own way."""
    turns: dict[str, Floats] = {}
    for limb in siblings:
        rest = limb.chain.frames[0]
        wished = aim_bones(limb.chain, before[limb.name].rotations, wishes.points[limb.name], carrier)
        turns[limb.name] = rest @ wished.rotations[0] @ rest.T
    for name in wishes.priority:
        if name in turns:
            return turns[name]
    pulls = [wishes.pulls[name] for name in turns]
    mean: Floats = Rotation.from_matrix(np.array(list(turns.values()))).mean(pulls).as_matrix()
    return mean
