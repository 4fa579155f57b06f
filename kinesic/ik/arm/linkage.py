"""Arm chains regrouped: each bone with the hinges that aim it."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
from math import remainder, tau

import numpy as np

from kinesic.body.chain import Chain
from kinesic.body.skeleton import Hinge
from kinesic.ik.arm.accepts import accept_chain
from kinesic.ik.arm.subproblems import first_of_two, turn_towards
from kinesic.ik.scalar3 import (
    IDENTITY_ROTATION,
    Rotation,
    Vector,
    after,
    cross,
    norm,
    plus,
    rotated,
    scaled,
    turned,
    unit,
    vector,
)

PARALLEL_SINE = 1e-9  # sine of the angle below which a hinge axis is parallel to its bone
GIRDLE_MOBILITY = 0.1  # mobility of collar-bone hinges (other hinges: 1), so that they move least


@dataclass(frozen=True)
class Pivot:
    """Axis, range and rest angle of an arm's hinge, as floats."""

    axis: Vector
    lower: float  # [rad]
    upper: float  # [rad]
    rest: float  # [rad]

    def bring_into_range(self, angle: float, near: float) -> float:
        """Add whole turns to an angle [rad] to bring it into range.

        Of several such angles, return the nearest to `near`; without any, return the nearer stop.
        """
        same = near + remainder(angle - near, tau)
        if self.lower <= same <= self.upper:
            return same
        turns = [turn for turn in (same - tau, same + tau) if self.lower <= turn <= self.upper]
        if turns:
            return turns[0]
        below, above = abs(remainder(same - self.lower, tau)), abs(remainder(same - self.upper, tau))
        return self.lower if below < above else self.upper


@dataclass(frozen=True)
class Link:
    """Bone with the hinges that set its direction, innermost first."""

    pivots: tuple[Pivot, ...]
    bone: Vector  # [m]
    along: Vector  # unit, of the bone
    length: float  # [m] of the bone
    first: int  # index of its first hinge in the chain

    def turn(self, frame: Rotation, angles: Sequence[float]) -> Rotation:
        """Rotate a frame by the hinge angles [rad] of this link."""
        for pivot, angle in zip(self.pivots, angles, strict=True):
            frame = after(frame, pivot.axis, angle)
        return frame


@dataclass(frozen=True, eq=False)
class Linkage:
    """All links of an arm, from the base to the hand."""

    origin: Vector  # [m] in the base
    links: tuple[Link, ...]
    side: float  # +1: an arm on the left; -1: on the right
    farthest: float  # [m] shoulder to hand with the elbow as straight as it goes
    closest: float  # [m] shoulder to hand with the elbow as bent as it goes

    @cached_property
    def pivots(self) -> tuple[Pivot, ...]:
        """All hinges in chain order."""
        return tuple(pivot for link in self.links for pivot in link.pivots)

    @cached_property
    def girdle(self) -> tuple[Link, ...]:
        """Collar-bone links, empty for arms without collar bone."""
        return self.links[:-3]

    @cached_property
    def mobility(self) -> tuple[float, ...]:
        """Default mobility of each hinge: `GIRDLE_MOBILITY` for the collar bone, otherwise 1."""
        girdle = self.links[-3].first
        return tuple(GIRDLE_MOBILITY if k < girdle else 1.0 for k in range(len(self.pivots)))

    def walk(self, angles: Sequence[float], links: int) -> tuple[Rotation, list[Vector]]:
        """Compute the forward kinematics of the first links.

        Args:
            angles: [rad] of at least their hinges.
            links: number of links, counted from the base.

        Returns:
            Frame after their hinges, and their joints' centres [m] in the base, one more than links.
        """
        rotation, points = IDENTITY_ROTATION, [self.origin]
        for link in self.links[:links]:
            for k, pivot in enumerate(link.pivots, link.first):
                rotation = after(rotation, pivot.axis, angles[k])
            points.append(plus(points[-1], rotated(rotation, link.bone)))
        return rotation, points

    def hinge_lines(self, angles: Sequence[float]) -> tuple[Vector, list[tuple[Vector, Vector]]]:
        """Return the hand position [m] and axis lines of hinges moving it.

        A line is an axis (unit) and a centre [m], both in the base.
        """
        rotation, centre = IDENTITY_ROTATION, self.origin
        lines: list[tuple[Vector, Vector]] = []
        for link in self.links[:-1]:
            for k, pivot in enumerate(link.pivots, link.first):
                lines.append((rotated(rotation, pivot.axis), centre))
                rotation = after(rotation, pivot.axis, angles[k])
            centre = plus(centre, rotated(rotation, link.bone))
        return centre, lines

    def hand(self, angles: Sequence[float]) -> Vector:
        """Compute the wrist's position in the base frame [m]."""
        return self.walk(angles, len(self.links) - 1)[1][-1]


@lru_cache(maxsize=32)
def linkage_of(chain: Chain) -> Linkage:
    """Regroup the hinges of a chain by the bone that they aim.

    A joint's last hinge, where it lies along the joint's own bone, turns only the bones after it: it joins the
    hinges of the next bone. So an elbow's plane (twist of the upper arm, flexion) is solved like a shoulder.

    Raises:
        ConfigError: the chain is not a solvable arm; the message names the broken rule.
    """
    chain = accept_chain(chain)
    links: list[Link] = []
    carried: list[Hinge] = []
    first = 0
    for joint in chain.joints:
        hinges, bone = [*carried, *joint.hinges], vector(joint.bone)
        twists = bool(joint.hinges) and joint is not chain.joints[-1]
        twists = twists and float(np.linalg.norm(np.cross(hinges[-1].axis, unit(bone)))) < PARALLEL_SINE
        carried = [hinges.pop()] if twists else []
        pivots = tuple(Pivot(vector(h.axis), float(h.lower), float(h.upper), float(h.rest)) for h in hinges)
        links.append(Link(pivots, bone, unit(bone), norm(bone), first))
        first += len(hinges)
    origin = vector(chain.origin_in_base)
    upper, fore = links[-3], links[-2]
    twisted = bool(fore.pivots) and norm(cross(fore.pivots[0].axis, upper.along)) < PARALLEL_SINE
    aside = origin[1] + sum(link.bone[1] for link in links[:-3])
    farthest, closest = (
        _compute_extreme_reach(upper.bone, fore.pivots[twisted:], fore.bone, sign=sign) for sign in (1.0, -1.0)
    )
    return Linkage(origin, tuple(links), -1.0 if aside < 0.0 else 1.0, farthest, closest)


def _compute_extreme_reach(upper: Vector, pivots: Sequence[Pivot], fore: Vector, *, sign: float) -> float:
    """Return the longest or shortest possible shoulder-hand distance [m].

    There, both hinges aim one bone along the other, or one hinge is at its stop and the other aims. `sign` is 1 for the
    longest distance and -1 for the shortest, at which the bones lie against one another.
    """
    if not pivots:
        return norm(plus(upper, fore))
    first, last, aim = pivots[0], pivots[-1], scaled(unit(upper), sign)
    if len(pivots) == 1:
        turn = turn_towards(first.axis, unit(fore), aim)
        angle = first.lower if turn is None else first.bring_into_range(turn, first.rest)
        return norm(plus(upper, turned(fore, first.axis, angle)))
    solutions = first_of_two(first.axis, last.axis, unit(fore), aim)
    firsts = (first.lower, first.upper, *(first.bring_into_range(turn, first.rest) for turn in solutions))
    distances = (
        *(_compute_extreme_reach(turned(upper, first.axis, -turn), (last,), fore, sign=sign) for turn in firsts),
        *(
            _compute_extreme_reach(upper, (first,), turned(fore, last.axis, turn), sign=sign)
            for turn in (last.lower, last.upper)
        ),
    )
    return max(distances) if sign > 0.0 else min(distances)
