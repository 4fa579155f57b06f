"""How head, trunk and shoulders take part in gestures, beside what accompanies the hands in people."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import degrees, radians
from typing import Literal

import numpy as np

from kinesic.bench.figure import Figure
from kinesic.body.arrays import Floats
from kinesic.body.robot import SIDES, Robot

Part = Literal["head", "trunk", "shoulders"]
PARTS: tuple[Part, ...] = ("head", "trunk", "shoulders")
LEAST_TURN = radians(1)  # from which on a part is seen to move
PEOPLE: Mapping[tuple[str, Part], str] = {  # [deg] by category or gesture; not measured by us
    ("beat", "head"): "2 to 4",
    ("beat", "shoulders"): "2 to 4",
    ("deictic", "trunk"): "5 to 10",
    ("doubt_shrug", "shoulders"): "12 to 20",
    ("doubt_shrug", "head"): "5 to 8",
    ("hush", "head"): "5",
    ("refuse_push", "trunk"): "2",
    ("large", "trunk"): "3",
}
SHOWN = ("doubt_shrug", "hush", "refuse_push", "large")  # gestures of which people's values are known


@dataclass(frozen=True)
class BodyMeasures:
    """How far parts of the body turn away from rest [rad], at most."""

    head: float = 0.0  # in the room
    trunk: float = 0.0
    shoulders: float = 0.0  # collar bones, the one that goes farther

    @property
    def moves(self) -> bool:
        """Whether any of them is seen to move."""
        return max(self.head, self.trunk, self.shoulders) > LEAST_TURN


def measure_body(robot: Robot, angles: Floats) -> BodyMeasures:
    """Measures the body in a motion of (m, n) [rad]; a part that the robot lacks stays still."""
    rotations, rest = robot.skeleton.frames(angles).rotations, robot.skeleton.resting.rotations
    turned: dict[str, float] = {}
    for chain in ("neck", "torso"):
        if robot.chains.get(chain):
            k = robot.skeleton.segment(robot.chains[chain][-1])
            cosines = (np.einsum("mij,ij->m", rotations[:, k], rest[k]) - 1.0) / 2.0
            turned[chain] = float(np.arccos(np.clip(cosines, -1.0, 1.0)).max(initial=0.0))
    collars = [joint for side in SIDES for joint in robot.skeleton.joints_of(robot.arm(side).segments[:-3])]
    lifted = float(np.ptp(angles[:, collars], axis=0).max(initial=0.0)) if collars else 0.0
    return BodyMeasures(turned.get("neck", 0.0), turned.get("torso", 0.0), lifted)


def body_figures(part: str, bodies: Sequence[tuple[str, str, BodyMeasures]]) -> list[Figure]:
    """Gives the share of gestures in which each part moves, and how far it goes.

    Args:
        part: what the names of the figures begin with.
        bodies: gesture, its category, and its body.
    """
    moving = np.array([body.moves for *_, body in bodies])
    figures = [
        Figure(f"{part}.whole_body", float(moving.mean()), "", 0.9, "higher", "head, trunk or collar bones move")
    ]
    for name in PARTS:
        seen = np.array([getattr(body, name) > LEAST_TURN for *_, body in bodies])
        figures.append(Figure(f"{part}.whole_body_{name}", float(seen.mean()), "", None, "higher", "move over 1 deg"))
    groups = {category: [body for _, other, body in bodies if other == category] for _, category, _ in bodies}
    groups |= {gesture: [body] for gesture, _, body in bodies if gesture in SHOWN}
    for group in sorted(groups, key=lambda name: (name in SHOWN, name)):
        figures += [_amount(part, group, name, groups[group]) for name in PARTS]
    return figures


def _amount(part: str, group: str, name: Part, bodies: Sequence[BodyMeasures]) -> Figure:
    median = degrees(float(np.median([getattr(body, name) for body in bodies])))
    people = PEOPLE.get((group, name))
    return Figure(
        f"{part}.body.{group}.{name}", median, "deg", None, "higher", f"people about {people}" if people else ""
    )
