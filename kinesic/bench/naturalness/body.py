"""Motion of head, trunk and shoulders in gestures, compared with people."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import degrees, radians
from typing import Literal

import numpy as np

from kinesic.bench.metric import Metric
from kinesic.body.arrays import Floats
from kinesic.body.robot import SIDES, Robot

Part = Literal["head", "trunk", "shoulders"]
BODY_PARTS: tuple[Part, ...] = ("head", "trunk", "shoulders")
MIN_VISIBLE_TURN = radians(1)  # [rad] smallest visible rotation of head, trunk or shoulders
HUMAN_TURNS: Mapping[tuple[str, Part], str] = {  # [deg] human rotations by category or gesture, from the literature
    ("beat", "head"): "2 to 4",
    ("beat", "shoulders"): "2 to 4",
    ("deictic", "trunk"): "5 to 10",
    ("doubt_shrug", "shoulders"): "12 to 20",
    ("doubt_shrug", "head"): "5 to 8",
    ("hush", "head"): "5",
    ("refuse_push", "trunk"): "2",
    ("large", "trunk"): "3",
}
COMPARED_GESTURES = ("doubt_shrug", "hush", "refuse_push", "large")  # gestures with human rotations in the literature


@dataclass(frozen=True)
class BodyMeasures:
    """Largest rotations of body parts away from rest [rad]."""

    head: float = 0.0  # [rad] rotation of the head in world coordinates
    trunk: float = 0.0
    shoulders: float = 0.0  # [rad] range of the clavicle joint that moves most

    @property
    def moves(self) -> bool:
        """Whether head, trunk or shoulders move visibly."""
        return max(self.head, self.trunk, self.shoulders) > MIN_VISIBLE_TURN


def measure_body(robot: Robot, angles: Floats) -> BodyMeasures:
    """Measure the largest rotations [rad] of head, trunk and collar bones.

    Missing parts count as still.
    """
    rotations, rest = robot.skeleton.frames(angles).rotations, robot.skeleton.rest_frames.rotations
    largest_turns: dict[str, float] = {}
    for chain in ("neck", "torso"):
        if robot.chains.get(chain):
            k = robot.skeleton.segment(robot.chains[chain][-1])
            cosines = (np.einsum("mij,ij->m", rotations[:, k], rest[k]) - 1.0) / 2.0
            largest_turns[chain] = float(np.arccos(np.clip(cosines, -1.0, 1.0)).max(initial=0.0))
    clavicles = [joint for side in SIDES for joint in robot.skeleton.joints_of(robot.arm(side).segments[:-3])]
    lifted = float(np.ptp(angles[:, clavicles], axis=0).max(initial=0.0)) if clavicles else 0.0
    return BodyMeasures(largest_turns.get("neck", 0.0), largest_turns.get("torso", 0.0), lifted)


def body_metrics(part: str, bodies: Sequence[tuple[str, str, BodyMeasures]]) -> list[Metric]:
    """Measure how often and how far head, trunk and shoulders move.

    Args:
        part: prefix of the metric names.
        bodies: gesture, its category and its body motion.
    """
    moving = np.array([body.moves for *_, body in bodies])
    metrics = [
        Metric(f"{part}.whole_body", float(moving.mean()), "", 0.9, "higher", "head, trunk or collar bones move")
    ]
    for name in BODY_PARTS:
        is_visible = np.array([getattr(body, name) > MIN_VISIBLE_TURN for *_, body in bodies])
        metrics.append(
            Metric(f"{part}.whole_body_{name}", float(is_visible.mean()), "", None, "higher", "move over 1 deg")
        )
    groups = {category: [body for _, other, body in bodies if other == category] for _, category, _ in bodies}
    groups |= {gesture: [body] for gesture, _, body in bodies if gesture in COMPARED_GESTURES}
    for group in sorted(groups, key=lambda name: (name in COMPARED_GESTURES, name)):
        metrics += [_amount(part, group, name, groups[group]) for name in BODY_PARTS]
    return metrics


def _amount(part: str, group: str, name: Part, bodies: Sequence[BodyMeasures]) -> Metric:
    median = degrees(float(np.median([getattr(body, name) for body in bodies])))
    people = HUMAN_TURNS.get((group, name))
    return Metric(
        f"{part}.body.{group}.{name}", median, "deg", None, "higher", f"people about {people}" if people else ""
    )
