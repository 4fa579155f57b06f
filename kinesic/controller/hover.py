"""Keeps the hands of one posture clear of the body: a touch is performed as a hover."""

from collections.abc import Callable, Mapping

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.dynamics import Distances
from kinesic.body.reach import Reach
from kinesic.body.robot import Robot, Side

HOVER = 0.015  # [m]
STEPS = (0.02, 0.04, 0.06, 0.09, 0.12)  # [m] tried in turn
AWAY = ((0.0, 1.0, 0.0), (1.0, 0.0, 0.0), (0.7, 0.7, 0.0), (0.6, 0.6, 0.5), (0.6, 0.6, -0.5))  # forward, outward, up

Arms = Callable[[Floats, Mapping[Side, Reach | None], Robot], Floats]


def clear_hands(
    angles: Floats, wanted: Mapping[Side, Reach | None], robot: Robot, distances: Distances, arms: Arms
) -> Floats:
    """Moves the hands outward or forward until the posture keeps the hover distance.

    Args:
        angles: (n,) [rad] the posture as solved.
        wanted: the reaches that it was solved for, in the world.
        robot: the robot.
        distances: its self-distance.
        arms: solves both arms for other reaches.

    Returns:
        (n,) [rad]; the clearest posture found when none keeps the distance.
    """
    movable = {side: reach for side, reach in wanted.items() if reach is not None}
    best, best_distance = angles, _distance(angles, distances)
    if best_distance >= HOVER or not movable:
        return best
    for step in STEPS:
        for away in AWAY:
            moved = {side: _moved(reach, side, step, away) for side, reach in movable.items()}
            candidate = arms(angles, moved, robot)
            distance = _distance(candidate, distances)
            if distance > best_distance:
                best, best_distance = candidate, distance
            if distance >= HOVER:
                return best
    return best


def _distance(angles: Floats, distances: Distances) -> float:
    return float(distances.clearance(angles[None, :]).distances[0])


def _moved(reach: Reach, side: Side, step: float, away: tuple[float, float, float]) -> Reach:
    forward, outward, up = away
    offset = step * np.array([forward, outward if side == "l" else -outward, up])
    return Reach(sealed(reach.position + offset), reach.pointing, reach.palm, reach.swivel)
