"""A chain as the solver walks it: for each bone, the hinges that aim it."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
from math import remainder, tau

import numpy as np

from kinesic.body.chain import Chain
from kinesic.body.skeleton import Hinge
from kinesic.ik.vectors import IDENTITY, Rotation, Vector, after, distance, norm, plus, rotated, unit, vector

PARALLEL = 1e-9  # sine of the angle below which a hinge lies along its bone
ELBOW_SAMPLES = 65  # of the elbow's range, to find how near and how far the hand can be


@dataclass(frozen=True)
class Pivot:
    """One hinge in plain numbers."""

    axis: Vector
    lower: float  # [rad]
    upper: float  # [rad]
    rest: float  # [rad]

    def held(self, angle: float, near: float) -> float:
        """The angle inside the range that stands for `angle`, whole turns aside: nearest to `near`, or a stop [rad]."""
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
    """A bone and the hinges that aim it, the nearest to the base first."""

    pivots: tuple[Pivot, ...]
    bone: Vector  # [m]
    along: Vector  # unit, of the bone
    length: float  # [m] of the bone
    first: int  # index of its first hinge in the chain


@dataclass(frozen=True, eq=False)
class Linkage:
    """Links from the base outward; the last bone runs along the hand and moves no position."""

    origin: Vector  # [m] in the base
    links: tuple[Link, ...]
    side: float  # +1: an arm on the left; -1: on the right
    nearest: float  # [m] shoulder to hand with the elbow bent as far as it goes
    farthest: float  # [m] with the elbow as straight as it goes

    @cached_property
    def pivots(self) -> tuple[Pivot, ...]:
        """All hinges in the chain's order."""
        return tuple(pivot for link in self.links for pivot in link.pivots)

    @cached_property
    def girdle(self) -> tuple[Link, ...]:
        """What carries the shoulder; empty for an arm without collar bone."""
        return self.links[:-3]

    def walk(self, angles: Sequence[float], links: int) -> tuple[Rotation, list[Vector]]:
        """Forward kinematics of the first links.

        Args:
            angles: [rad] of at least their hinges.
            links: how many.

        Returns:
            Frame after their hinges, and their joints' centres [m] in the base, one more than links.
        """
        rotation, points = IDENTITY, [self.origin]
        for link in self.links[:links]:
            for k, pivot in enumerate(link.pivots, link.first):
                rotation = after(rotation, pivot.axis, angles[k])
            points.append(plus(points[-1], rotated(rotation, link.bone)))
        return rotation, points

    def hand(self, angles: Sequence[float]) -> Vector:
        """[m] the wrist's centre in the base."""
        return self.walk(angles, len(self.links) - 1)[1][-1]


@lru_cache(maxsize=32)
def linkage_of(chain: Chain) -> Linkage:
    """Regroups the hinges of a chain by the bone that they aim.

    A joint's last hinge, where it lies along the joint's own bone, turns only what comes after: it joins the
    hinges of the next bone. So an elbow's plane (twist of the upper arm, flexion) is solved like a shoulder.

    Raises:
        ValueError: the chain has fewer than three joints.
    """
    if len(chain.joints) < 3:
        raise ValueError(
            f"chain {chain.name} has {len(chain.joints)} joints; an arm has at least shoulder, elbow, wrist"
        )
    links: list[Link] = []
    carried: list[Hinge] = []
    first = 0
    for joint in chain.joints:
        hinges, bone = [*carried, *joint.hinges], vector(joint.bone)
        twists = bool(joint.hinges) and joint is not chain.joints[-1] and _parallel(hinges[-1], bone)
        carried = [hinges.pop()] if twists else []
        pivots = tuple(Pivot(vector(h.axis), float(h.lower), float(h.upper), float(h.rest)) for h in hinges)
        links.append(Link(pivots, bone, unit(bone), norm(bone), first))
        first += len(hinges)
    origin = vector(chain.origin_in_base)
    near, far = _span(links[-3], links[-2])
    draft = Linkage(origin, tuple(links), 1.0, near, far)
    shoulder = draft.walk([0.0] * first, len(links) - 3)[1][-1]
    return Linkage(origin, tuple(links), -1.0 if shoulder[1] < 0.0 else 1.0, near, far)


def _parallel(hinge: Hinge, bone: Vector) -> bool:
    return float(np.linalg.norm(np.cross(hinge.axis, unit(bone)))) < PARALLEL


def _span(upper: Link, fore: Link) -> tuple[float, float]:
    """How near to the shoulder and how far from it the elbow's last hinge can hold the hand [m]."""
    if not fore.pivots:
        reach = norm(plus(upper.bone, fore.bone))
        return reach, reach
    elbow = fore.pivots[-1]
    reaches = [
        distance(plus(upper.bone, rotated(after(IDENTITY, elbow.axis, float(angle)), fore.bone)), (0.0, 0.0, 0.0))
        for angle in np.linspace(elbow.lower, elbow.upper, ELBOW_SAMPLES)
    ]
    return min(reaches), max(reaches)
