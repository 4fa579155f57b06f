"""How far the torso turns and leans so that the arms reach their targets (thesis 8.6, by trigonometry).

The thesis turns the torso towards the middle of the targets. Here it turns as if each far target drew its shoulder
by a string: in proportion to the moments, which is the smallest turn that serves. For two hands in front both mean
the same; for one hand far out on its own side the thesis' rule would take the shoulder away from its target.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache, partial
from math import radians

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.body.robot import Robot, Side
from kinesic.ik.arm.compiled import KERNEL, arm_of
from kinesic.ik.arm.linkage import Linkage, linkage_of
from kinesic.ik.arm.shoulder_elbow import gap
from kinesic.ik.scalar3 import Vector, cross, dot, minus, plus, turned, unit, vector
from kinesic.ik.solve import three
from kinesic.kernels import Kernel

EASY = 0.96  # of the arm's reach, within which no hand asks the torso
LARGEST_TURN = radians(20.0)  # of each hinge; a target beyond is pointed at
WIDEST_SCALE = 3.0  # the weaker hinges go on when the strongest has come to its end
SAMPLES = 15  # of the way there, then bisected
BISECTIONS = 10


@dataclass(frozen=True)
class _Turn:
    """One torso hinge, in the world of the upright torso."""

    kind: int  # 0 torsion, 1 tilt, 2 roll
    axis: Vector
    centre: Vector  # [m]
    lower: float  # [rad]
    upper: float  # [rad]

    def clamp(self, angle: float, most: float) -> float:
        """The angle inside the range and within `most` of upright [rad]."""
        return min(max(angle, self.lower, -most), self.upper, most)


@dataclass(frozen=True)
class _Arm:
    """An arm and its target, with the torso upright."""

    linkage: Linkage
    base: Vector  # [m] origin of the segment that carries the arm, in the world
    target: Vector  # [m] in the world
    gap: Callable[[Vector], float]  # [m] from the shoulder that helps most to a place in the base


def lean_torso(
    robot: Robot, hands: Mapping[Side, Floats], *, most: float = LARGEST_TURN, kernel: Kernel = KERNEL
) -> tuple[float, float, float]:
    """Finds the smallest turn and lean that bring each shoulder near enough to its hand's target.

    Args:
        robot: whose arms reach.
        hands: (3,) [m] targets of the hands in the world; they stay there while the torso moves.
        most: [rad] of each hinge.
        kernel: which implementation answers; "numpy" is the specification of the other.

    Returns:
        Torsion, tilt and roll [rad], signed as their hinges and inside their ranges. All zero when every target is
        in easy reach of the upright torso; the most helpful turn within `most` when a target is beyond all reach.

    Raises:
        ValueError: a target is not three finite numbers.
    """
    turns, arms = _turns(robot), [_arm(robot, side, target, kernel) for side, target in hands.items()]
    far = [arm for arm in arms if _excess(arm, turns, [0.0] * len(turns)) > 0.0]
    if not far:
        return 0.0, 0.0, 0.0
    pulls = [_pull(turn, far) for turn in turns]
    strongest = max((abs(pull) for pull in pulls), default=0.0) or 1.0

    def turned_by(scale: float) -> list[float]:
        return [turn.clamp(scale * pull / strongest, most) for turn, pull in zip(turns, pulls, strict=True)]

    def excess(scale: float) -> float:
        return max(_excess(arm, turns, turned_by(scale)) for arm in arms)

    scales = [WIDEST_SCALE * most * k / SAMPLES for k in range(SAMPLES + 1)]
    first = next((k for k, scale in enumerate(scales) if excess(scale) <= 0.0), None)
    scale = min(scales, key=excess) if first is None else _bisected(excess, scales[first - 1], scales[first])
    found = {turn.kind: angle for turn, angle in zip(turns, turned_by(scale), strict=True)}
    return found.get(0, 0.0), found.get(1, 0.0), found.get(2, 0.0)


def _bisected(excess: Callable[[float], float], insufficient: float, sufficient: float) -> float:
    for _ in range(BISECTIONS):
        middle = 0.5 * (insufficient + sufficient)
        insufficient, sufficient = (insufficient, middle) if excess(middle) <= 0.0 else (middle, sufficient)
    return sufficient


def _pull(turn: _Turn, far: Sequence[_Arm]) -> float:
    """The moment about a hinge when each far target draws its shoulder with unit force [m], positive with the hinge."""
    moment = 0.0
    for arm in far:
        rest = [pivot.rest for pivot in arm.linkage.pivots]
        shoulder = plus(arm.base, arm.linkage.walk(rest, len(arm.linkage.girdle))[1][-1])
        moment += dot(turn.axis, cross(minus(shoulder, turn.centre), unit(minus(arm.target, shoulder))))
    return moment


def _excess(arm: _Arm, turns: Sequence[_Turn], angles: Sequence[float]) -> float:
    """How far the target lies beyond easy reach with the torso turned [m]; negative inside."""
    target = arm.target
    for turn, angle in zip(turns, angles, strict=True):
        target = plus(turn.centre, turned(minus(target, turn.centre), turn.axis, -angle))
    return arm.gap(minus(target, arm.base)) - EASY * arm.linkage.farthest


def _arm(robot: Robot, side: Side, target: Floats, kernel: Kernel) -> _Arm:
    point = three(f"target of hand {side}", target)
    chain = robot.arms[side]
    base = vector(robot.skeleton.straight.origins[robot.skeleton.segment(chain.base)])
    linkage = linkage_of(chain)
    return _Arm(linkage, base, vector(point), arm_of(chain).gap if kernel == "compiled" else partial(gap, linkage))


@lru_cache(maxsize=8)
def _turns(robot: Robot) -> tuple[_Turn, ...]:
    """The first torso hinge of each kind, from the root outward."""
    skeleton = robot.skeleton
    origins = skeleton.straight.origins
    found: dict[int, _Turn] = {}
    for joint in robot.joints("torso"):
        hinge = skeleton.hinges[joint]
        centre = vector(origins[skeleton.segment(hinge.segment)])
        kind = 2 - int(np.argmax(np.abs(hinge.axis)))  # 0, 1, 2 for an axis mostly up, left or forward
        turn = _Turn(kind, vector(hinge.axis), centre, float(hinge.lower), float(hinge.upper))
        found.setdefault(turn.kind, turn)
    return tuple(found.values())
