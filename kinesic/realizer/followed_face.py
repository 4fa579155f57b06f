"""Eyes and expression of a robot that follows people."""

import numpy as np

from kinesic.body.action_units import face_keys
from kinesic.body.arrays import Floats
from kinesic.body.command import COMMAND_RATE
from kinesic.expressivity.face.eyes import gaze_units
from kinesic.motion.easing import minimum_jerk
from kinesic.planning.torso import compute_torso_turn
from kinesic.realizer.follow_steps import TRUNK_CHAINS, FollowedFace, Glimpse
from kinesic.realizer.scene import Scene

FACE_ROWS = 4 * COMMAND_RATE  # number of samples computed in advance; the last one is held
SACCADE_DURATION = 0.06  # [s] duration of a shift of the eyes


def followed_action_units(scene: Scene, face: FollowedFace, begin: float) -> dict[str, Floats]:
    """Return action units of a robot that follows people, (m,) each.

    They are sampled at 100 Hz. The eyes keep their target while the head moves. Eye units are NaN while a block
    determines the gaze.
    """
    times = begin + np.arange(FACE_ROWS) / COMMAND_RATE
    arrived = minimum_jerk((times - face.begin) / SACCADE_DURATION)[:, None]
    before, after = (np.array([turn.torsion, -turn.tilt]) for turn in (face.before, face.gaze))
    eyes = before + arrived * (after - before) - _head_directions(scene, times)
    units = {unit: np.array(values) for unit, values in gaze_units(eyes).items()}
    blocked = np.zeros(len(times), dtype=np.bool_)
    for running in scene.playing:
        for entry in running.occupancy:
            if "look" in entry.roles:
                blocked |= (times >= entry.begin) & (times < entry.end)
    for values in units.values():
        values[blocked] = np.nan
    for shown in (face.expression, face.held, face.faded):
        strength = _strength(shown, times)
        for unit, value in shown.units:
            for key in face_keys(unit):
                units[key] = np.maximum(units.get(key, 0.0), value * strength)
    return units


def _strength(shown: Glimpse, times: Floats) -> Floats:
    """Return the visible fraction (m,) of an expression at times (m,) [s]."""
    appeared = minimum_jerk((times - shown.begin) / shown.onset)
    return np.asarray(appeared - minimum_jerk((times - shown.end + shown.onset) / shown.onset))


def _head_directions(scene: Scene, times: Floats) -> Floats:
    """Return the yaw and pitch (m, 2) [rad] of the head.

    They are zero for an upright head, and positive to the left and up.
    """
    robot = scene.setup.robot
    angles = scene.motion.angles(times) - robot.skeleton.rest
    turn = sum((compute_torso_turn(robot, chain, angles) for chain in TRUNK_CHAINS), np.zeros((len(times), 3)))
    return np.stack([turn[:, 0], -turn[:, 1]], axis=1)
