"""Standing postures drawn from a distribution that was fitted on captured people."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache

import msgspec
import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.config import CONFIGS, read_toml
from kinesic.body.robot import SIDES, Robot, Side

STANCE_FILE = CONFIGS / "standing.toml"
BODY_FEATURES = ("trunk_tilt", "trunk_roll", "head_turn", "head_tilt", "head_roll")  # angles [deg] of trunk and head
LINK_NAMES = ("upper_arm", "forearm", "hand")  # links of an arm whose directions a stance sets
ARM_FEATURES = tuple(f"{link}_{way}" for link in LINK_NAMES for way in ("forward", "outward"))  # [deg] of a link
STANCE_FEATURES = (*BODY_FEATURES, *(f"{side}_{name}" for side in SIDES for name in ARM_FEATURES))
MAX_DRAW = 1.8  # [standard deviations] largest random draw
SOLVER_STEPS = 8  # Gauss-Newton steps of an arm
HINGE_WEIGHT = 0.06  # weight of a hinge's distance from the start [1/rad], compared with directions
DIFFERENCE_STEP = 1e-4  # [rad] angle step of numeric derivatives
SMALLEST_SINE = 1e-6  # [m] smallest divisor, a horizontal shoulder distance, which avoids division by zero


class StanceTable(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """TOML table of a distribution of standing postures [deg]."""

    mean: Mapping[str, float]  # by feature; arms by features of one arm
    symmetric: Sequence[Mapping[str, float]]  # standard deviations along each component, equal for both arms
    asymmetric: Sequence[Mapping[str, float]]  # likewise, added to the left arm and subtracted from the right
    within: Mapping[str, float]  # standard deviation between two rests of one person


class StanceFile(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """TOML file of standing postures."""

    hanging: StanceTable


@dataclass(frozen=True, eq=False)
class StanceDeviation:
    """Deviation of one person's stance from the mean."""

    features: Floats  # (s,) [deg] in the order of `STANCE_FEATURES`
    torsion: float  # [rad] of the trunk, + left

    def scaled(self, factor: float) -> "StanceDeviation":
        """Return the deviation times a factor."""
        return StanceDeviation(sealed(factor * self.features), factor * self.torsion)


@cache
def read_stances() -> StanceFile:
    """Read the built-in distribution of standing postures.

    Raises:
        ConfigError: the file is missing or invalid.
    """
    return read_toml(STANCE_FILE, StanceFile)


def spread_features(values: Mapping[str, float], right_sign: float = 1.0) -> Floats:
    """Return a stance (s,) [deg] whose arms have equal or opposite features.

    Args:
        values: by feature; missing ones are zero.
        right_sign: factor on the features of the right arm.
    """
    body = [values.get(name, 0.0) for name in BODY_FEATURES]
    arm = [values.get(name, 0.0) for name in ARM_FEATURES]
    return np.array([*body, *arm, *(right_sign * value for value in arm)])


def draw_deviation(table: StanceTable, chance: np.random.Generator) -> Floats:
    """Draw the deviation (s,) [deg] of one person's stance from the mean."""
    components = [spread_features(row) for row in table.symmetric]
    components += [spread_features(row, -1.0) for row in table.asymmetric]
    draws = np.clip(chance.normal(size=len(components)), -MAX_DRAW, MAX_DRAW)
    within = np.clip(chance.normal(size=len(STANCE_FEATURES)), -MAX_DRAW, MAX_DRAW)
    return np.asarray(draws @ np.stack(components) + within * spread_features(table.within))


def measure_arm(robot: Robot, side: Side, angles: Floats) -> Floats:
    """Return the `ARM_FEATURES` (..., 6) [deg] of an arm."""
    directions = _link_directions(robot, side, angles)
    outward = directions[..., 1] * (1.0 if side == "l" else -1.0)
    forward_angle = np.arctan2(directions[..., 0], -directions[..., 2])
    pairs = np.stack([forward_angle, np.arcsin(np.clip(outward, -1.0, 1.0))], axis=-1)
    return np.asarray(np.degrees(pairs.reshape(*pairs.shape[:-2], -1)))


def set_arm(robot: Robot, side: Side, features: Floats, angles: Floats) -> Floats:
    """Return the posture (n,) [rad] whose arm is nearest to given `ARM_FEATURES`.

    Args:
        robot: with the arm.
        side: of the arm.
        features: (6,) [deg] in the order of `ARM_FEATURES`.
        angles: (n,) [rad] posture with the torso in place; the arm stays close to it.
    """
    skeleton, arm, solved = robot.skeleton, robot.arm(side), np.array(angles)
    joints = [joint for joint in arm.joints if joint not in arm.shoulder_lift_joints]
    wanted, start = _to_directions(side, features), np.array(angles[joints])
    lower, upper = (np.asarray(bound)[joints] for bound in (skeleton.lower, skeleton.upper))
    for _ in range(SOLVER_STEPS):
        nudged = np.repeat(solved[None], len(joints) + 1, axis=0)
        nudged[np.arange(len(joints)), joints] += DIFFERENCE_STEP
        directions = _link_directions(robot, side, nudged).reshape(len(nudged), -1)
        slopes = (directions[:-1] - directions[-1]).T / DIFFERENCE_STEP
        error = wanted.ravel() - directions[-1]
        matrix = np.vstack([slopes, HINGE_WEIGHT * np.eye(len(joints))])
        right = np.concatenate([error, HINGE_WEIGHT * (start - solved[joints])])
        solved[joints] = np.clip(solved[joints] + np.linalg.lstsq(matrix, right, rcond=None)[0], lower, upper)
    return solved


def _to_directions(side: Side, features: Floats) -> Floats:
    """Return the link directions (3, 3) of `ARM_FEATURES`, in shoulder axes."""
    forward, outward = np.radians(np.asarray(features).reshape(-1, 2)).T
    across = np.sin(outward) * (1.0 if side == "l" else -1.0)
    return np.stack([np.cos(outward) * np.sin(forward), across, -np.cos(outward) * np.cos(forward)], axis=-1)


def _link_directions(robot: Robot, side: Side, angles: Floats) -> Floats:
    """Return an arm's link directions (..., 3, 3) in shoulder axes."""
    skeleton, arm = robot.skeleton, robot.arm(side)
    needed = frozenset({arm.wrist, *(robot.arm(which).shoulder for which in SIDES)})
    frames = skeleton.frames(angles, without=skeleton.segments_off_path(needed))
    points = [frames.origins[..., joint, :] for joint in (arm.shoulder, arm.elbow, arm.wrist)]
    straight = skeleton.zero_frames.rotations[arm.wrist].T @ (
        skeleton.zero_frames.origins[arm.wrist] - skeleton.zero_frames.origins[arm.elbow]
    )
    links = np.stack(
        [points[1] - points[0], points[2] - points[1], frames.rotations[..., arm.wrist, :, :] @ straight], axis=-2
    )
    links /= np.linalg.norm(links, axis=-1, keepdims=True)
    left, right = (frames.origins[..., robot.arm(which).shoulder, :] for which in SIDES)
    across = (left - right) * [1.0, 1.0, 0.0]
    across /= np.maximum(np.linalg.norm(across, axis=-1, keepdims=True), SMALLEST_SINE)
    up = np.array([0.0, 0.0, 1.0])
    axes = np.stack([np.cross(across, up), across, np.broadcast_to(up, across.shape)], axis=-2)
    return np.asarray(links @ np.swapaxes(axes, -1, -2))
