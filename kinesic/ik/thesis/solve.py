"""Iterative solution of ball-joint chains: relax masses, rotate joints, apply limits.

This is the loop of appendix 11.2. Without limits one relaxation suffices; with limits the joints that stand inside
them are the masses of the next relaxation, until the hand arrives or the rounds are over.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.ik.scalar3 import clamp_to_reach, vector
from kinesic.ik.solve import as_triple
from kinesic.ik.thesis.chain import BallChain
from kinesic.ik.thesis.direct import balance_springs
from kinesic.ik.thesis.limits import within_limits
from kinesic.ik.thesis.rotations import Carrier, ChainPosture, aim_bones, stance_of, swivel_chain
from kinesic.ik.thesis.task import Effort, RelaxationMethod, Rest, Task
from kinesic.ik.thesis.verlet import draw_by_force, swing_pinned

Method = Literal["force", "position", "direct"]
RELAXATION_METHODS: Mapping[Method, RelaxationMethod] = {  # name -> function of each relaxation method
    "force": draw_by_force,
    "position": swing_pinned,
    "direct": balance_springs,
}
STRAIGHTNESS_TOLERANCE = 1e-4  # [chain lengths] second singular value of the points below which a chain is straight
NUDGE_DISTANCE = 0.02  # [chain lengths] largest displacement along the up vector that bends a straight chain


@dataclass(frozen=True, eq=False)
class ChainStart:
    """Initial posture of a ball-joint chain."""

    rotations: Floats | None = None  # (n, 3, 3) away from rest, for instance an earlier result's; None: at rest
    carrier: Carrier | None = None  # base of the chain; None: fixed, at its rest


GROUND_START = ChainStart()  # start at rest with a fixed base


@dataclass(frozen=True, eq=False)
class Relaxed:
    """Solved ball-joint chain, with its remaining distance to the target."""

    points: Floats  # (n + 1, 3) [m], bones at their true lengths
    rotations: Floats  # (n, 3, 3) of the joints away from rest, each in the frame of its own bone at rest
    ups: Floats  # (n, 3) unit, where the up vectors went
    target: Floats  # (3,) [m] moved into the reach by eq. 7.3.7
    residual: float  # [m] from the hand to the requested target
    iterations: int  # number of iterations of all relaxations together
    rounds: int  # number of rounds of relaxation and limits
    energy: float  # remaining sum of the spring forces, per stiffness and length of the chain


def solve_ball_chain(
    chain: BallChain,
    target: Floats,
    *,
    method: Method = "position",
    start: ChainStart = GROUND_START,
    up: Floats | None = None,
    effort: Effort | None = None,
) -> Relaxed:
    """Move the end of a chain of ball joints to a target.

    Args:
        chain: at rest.
        target: (3,) [m].
        method: of relaxing the springs: an outer force, a pinned hand, or all springs at once.
        start: where the chain begins.
        up: (3,) direction to which the chain should bend (its swivel); None: any.
        effort: tolerances and caps.

    Returns:
        The best stance of all rounds. With limits it lies inside them.

    Raises:
        ValueError: a target or direction that is not three finite numbers, or an unknown method.
    """
    if method not in RELAXATION_METHODS:
        raise ValueError(f"method is {method!r}; known are {', '.join(RELAXATION_METHODS)}")
    hand_target = as_triple("target", target)
    wish = None if up is None else as_triple("up", up)
    effort = effort or Effort()
    tolerance = effort.tolerance * chain.size
    ground = start.carrier or Carrier.at_rest(chain)
    near = sealed(clamp_to_reach(vector(hand_target), vector(ground.point), chain.size))
    stance = within_limits(chain, stance_of(chain, _begun(chain, start.rotations), ground), near, ground)
    best, energy, iterations, done = stance, 0.0, 0, 0
    while done == 0 or (chain.limits is not None and done < effort.rounds and _miss(best, near) > tolerance):
        rest = _relaxed(chain, stance, near, method=method, effort=effort)
        points = rest.points if wish is None else swivel_chain(rest.points, wish)
        stance = within_limits(chain, aim_bones(chain, stance.rotations, points, ground), near, ground)
        iterations, done = iterations + rest.iterations, done + 1
        if done == 1 or _miss(stance, near) < _miss(best, near):
            best, energy = stance, rest.energy
    residual = float(np.linalg.norm(best.points[-1] - hand_target))
    ups = sealed(best.frames[:, :, 2])
    return Relaxed(sealed(best.points), sealed(best.rotations), ups, near, residual, iterations, done, energy)


def _begun(chain: BallChain, start: Floats | None) -> Floats:
    """Return the start rotations of all joints, (n, 3, 3)."""
    shape = chain.frames.shape
    if start is None:
        return np.broadcast_to(np.eye(3), shape)
    if start.shape != shape or not np.isfinite(start).all():
        raise ValueError(f"start has the shape {start.shape}; it needs {shape} finite numbers, an earlier rotations")
    return start


def bend_straight_chain(points: Floats, ups: Floats) -> Floats:
    """Bend a straight chain slightly, so that it can fold.

    Args:
        points: (n + 1, 3) in units of the chain, the last on the target.
        ups: (n, 3) unit, of the bones.
    """
    if len(points) < 3 or np.linalg.svd(points - points[0], compute_uv=False)[1] > STRAIGHTNESS_TOLERANCE:
        return points
    bow = NUDGE_DISTANCE * np.sin(np.linspace(0.0, np.pi, len(points)))
    nudged: Floats = points + bow[:, None] * ups[0]
    return nudged


def _relaxed(chain: BallChain, stance: ChainPosture, target: Floats, *, method: Method, effort: Effort) -> Rest:
    """Relax the chain's masses towards the target."""
    base, size = stance.points[0], chain.size
    points = np.vstack([stance.points[:-1], target])
    points = bend_straight_chain((points - base) / size, stance.frames[:, :, 2])
    points[-1] = (stance.points[-1] - base) / size
    task = Task(
        points,
        (target - base) / size,
        chain.lengths / size,
        chain.stiffness,
        chain.masses,
        chain.damping,
        effort,
    )
    rest = RELAXATION_METHODS[method](task)
    return Rest(base + size * rest.points, rest.iterations, rest.energy)


def _miss(stance: ChainPosture, target: Floats) -> float:
    return float(np.linalg.norm(stance.points[-1] - target))
