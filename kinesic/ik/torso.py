"""Torso rotation that brings hand targets within reach (thesis 8.6).

The thesis turns the torso towards the middle of the targets. Here it turns as if each far target drew its shoulder
by a string: in proportion to the moments, which is the smallest turn that serves. For two hands in front both mean
the same; for one hand far out on its own side the thesis' rule would take the shoulder away from its target.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from math import radians

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.body.robot import Robot, Side
from kinesic.ik.arm.compiled import arm_of
from kinesic.ik.arm.linkage import Linkage, linkage_of
from kinesic.ik.scalar3 import Vector, cross, dot, minus, plus, turned, unit, vector
from kinesic.ik.solve import as_triple

EASY_REACH_RATIO = 0.96  # fraction of the arm's reach within which the torso stays upright
MAX_TURN = radians(20.0)  # [rad] default of the largest rotation of each torso hinge
MAX_SCALE = 3.0  # largest unclipped rotation of the most strongly pulled hinge / `max_turn`
SCALE_SAMPLES = 15  # number of nonzero rotation scales tried before the bisection
BISECTION_STEPS = 10  # number of bisection steps for the rotation scale


@dataclass(frozen=True)
class _Turn:
    """Axis, centre and range of an upright torso's hinge, in world coordinates."""

    kind: int  # 0 torsion, 1 tilt, 2 roll
    axis: Vector
    centre: Vector  # [m]
    lower: float  # [rad]
    upper: float  # [rad]

    def clamp(self, angle: float, max_turn: float) -> float:
        """Clip an angle [rad] to the hinge's range and to `max_turn`."""
        return min(max(angle, self.lower, -max_turn), self.upper, max_turn)


@dataclass(frozen=True)
class _Arm:
    """Arm of the upright torso with its hand target."""

    linkage: Linkage
    base: Vector  # [m] origin of the segment that carries the arm, in the world
    target: Vector  # [m] in the world
    gap: Callable[[Vector], float]  # [m] from a position in the base to the nearest possible shoulder


def lean_torso(robot: Robot, hands: Mapping[Side, Floats], *, max_turn: float = MAX_TURN) -> tuple[float, float, float]:
    """Compute the smallest torso rotation that brings hand targets within easy reach.

    Args:
        robot: whose arms reach.
        hands: (3,) [m] targets of the hands in the world; they stay there while the torso moves.
        max_turn: [rad] of each hinge.

    Returns:
        Torsion, tilt and roll [rad], signed as their hinges and inside their ranges. All zero when every target is
        in easy reach of the upright torso; the most helpful turn within `max_turn` if a target is out of reach.

    Raises:
        ValueError: a target is not three finite numbers.
    """
    turns, arms = _turns(robot), [_arm(robot, side, target) for side, target in hands.items()]
    far = [arm for arm in arms if _excess(arm, turns, [0.0] * len(turns)) > 0.0]
    if not far:
        return 0.0, 0.0, 0.0
    pulls = [_compute_pull_moment(turn, far) for turn in turns]
    strongest = max((abs(pull) for pull in pulls), default=0.0) or 1.0

    def angles_at(scale: float) -> list[float]:
        return [turn.clamp(scale * pull / strongest, max_turn) for turn, pull in zip(turns, pulls, strict=True)]

    def excess(scale: float) -> float:
        return max(_excess(arm, turns, angles_at(scale)) for arm in arms)

    scales = [MAX_SCALE * max_turn * k / SCALE_SAMPLES for k in range(SCALE_SAMPLES + 1)]
    first = next((k for k, scale in enumerate(scales) if excess(scale) <= 0.0), None)
    scale = min(scales, key=excess) if first is None else _bisect(excess, scales[first - 1], scales[first])
    angles = {turn.kind: angle for turn, angle in zip(turns, angles_at(scale), strict=True)}
    return angles.get(0, 0.0), angles.get(1, 0.0), angles.get(2, 0.0)


def _bisect(excess: Callable[[float], float], insufficient: float, sufficient: float) -> float:
    for _ in range(BISECTION_STEPS):
        middle = 0.5 * (insufficient + sufficient)
        insufficient, sufficient = (insufficient, middle) if excess(middle) <= 0.0 else (middle, sufficient)
    return sufficient


def _compute_pull_moment(turn: _Turn, far: Sequence[_Arm]) -> float:
    """Return the moment [m] of unit shoulder-to-target forces about a hinge."""
    moment = 0.0
    for arm in far:
        rest = [pivot.rest for pivot in arm.linkage.pivots]
        shoulder = plus(arm.base, arm.linkage.walk(rest, len(arm.linkage.girdle))[1][-1])
        moment += dot(turn.axis, cross(minus(shoulder, turn.centre), unit(minus(arm.target, shoulder))))
    return moment


def _excess(arm: _Arm, turns: Sequence[_Turn], angles: Sequence[float]) -> float:
    """Return the target's distance [m] beyond easy reach, negative within it."""
    target = arm.target
    for turn, angle in zip(turns, angles, strict=True):
        target = plus(turn.centre, turned(minus(target, turn.centre), turn.axis, -angle))
    return arm.gap(minus(target, arm.base)) - EASY_REACH_RATIO * arm.linkage.farthest


def _arm(robot: Robot, side: Side, target: Floats) -> _Arm:
    point = as_triple(f"target of hand {side}", target)
    chain = robot.arms[side]
    base = vector(robot.skeleton.zero_frames.origins[robot.skeleton.segment(chain.base)])
    linkage = linkage_of(chain)
    return _Arm(linkage, base, vector(point), arm_of(chain).gap)


@lru_cache(maxsize=8)
def _turns(robot: Robot) -> tuple[_Turn, ...]:
    """Return the first torso hinge of each kind: torsion, tilt, roll."""
    skeleton = robot.skeleton
    origins = skeleton.zero_frames.origins
    first_turns: dict[int, _Turn] = {}
    for joint in robot.joints("torso"):
        hinge = skeleton.hinges[joint]
        centre = vector(origins[skeleton.segment(hinge.segment)])
        kind = 2 - int(np.argmax(np.abs(hinge.axis)))  # 0, 1, 2 for an axis mostly up, left or forward
        turn = _Turn(kind, vector(hinge.axis), centre, float(hinge.lower), float(hinge.upper))
        first_turns.setdefault(turn.kind, turn)
    return tuple(first_turns.values())
