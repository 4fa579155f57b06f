"""Random standing postures from distributions that were fitted to captured people."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from math import sqrt

import msgspec
import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.config import CONFIGS, read_toml
from kinesic.body.robot import SIDES
from kinesic.planning.arm_directions import ARM_FEATURES

STANCE_FILE = CONFIGS / "standing.toml"  # distributions of standing postures
# Angles [deg] of trunk and head: `trunk_turn` is that of the shoulders from the hips, and `shoulder_rise` that of the
# line of the shoulders over the rolled trunk.
BODY_FEATURES = ("trunk_turn", "trunk_tilt", "trunk_roll", "head_turn", "head_tilt", "head_roll", "shoulder_rise")
# features of body and both arms
STANCE_FEATURES = (*BODY_FEATURES, *(f"{side}_{name}" for side in SIDES for name in ARM_FEATURES))
SYMMETRIC_BODY = ("trunk_tilt", "head_tilt")  # features of trunk and head that a mirror image keeps
MAX_DRAW = 1.8  # [standard deviations] bound of the random value of each principal component
MIRROR_PROBABILITY = 0.5  # probability that a posture with hands before the body is mirrored
MAX_SPREAD = 1.5  # bound of the common random factor of all components, from the tails of the t distribution


class StanceComponents(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """TOML table of a multivariate t distribution by its principal components [deg]."""

    degrees_of_freedom: float  # the smaller, the more draws lie far from the mean
    symmetric: Sequence[Mapping[str, float]]  # principal components that are equal for both arms
    asymmetric: Sequence[Mapping[str, float]]  # components added to the left arm and subtracted from the right


class StanceTable(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """TOML table of a distribution of standing postures [deg]."""

    weight: float  # relative probability of hanging arms
    mean: Mapping[str, float]  # mean angle by feature; both arms have the features of one arm
    handedness: Mapping[str, float]  # mean asymmetry, added to the left arm and subtracted from the right
    persons: StanceComponents  # deviations of persons from the mean
    rests: StanceComponents  # deviations of a person's rests from the mean of that person


class ArmPoseTable(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """TOML table of standing postures with hands before the body [deg]."""

    name: str
    weight: float  # relative probability of this posture, with its mirror image
    mean: Mapping[str, float]  # mean angle by feature of the whole body
    components: Sequence[Mapping[str, float]]  # principal components of the deviations


class StanceFile(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """TOML file of standing postures."""

    hanging: StanceTable
    poses: Sequence[ArmPoseTable]


@dataclass(frozen=True, eq=False)
class Stance:
    """Standing posture: mean and deviation (s,) [deg], ordered as `STANCE_FEATURES`."""

    mean: Floats | None  # None for the robot's own rest posture
    deviation: Floats

    def scaled(self, factor: float) -> "Stance":
        """Return the stance with its deviation times a factor."""
        return Stance(self.mean, sealed(factor * self.deviation))


@cache
def read_stances() -> StanceFile:
    """Read the built-in distribution of standing postures.

    Raises:
        ConfigError: the file is missing or invalid.
    """
    return read_toml(STANCE_FILE, StanceFile)


def expand_features(values: Mapping[str, float], right_sign: float = 1.0) -> Floats:
    """Expand features of body and one arm to `STANCE_FEATURES` (s,) [deg].

    Args:
        values: by feature; missing ones are zero.
        right_sign: factor on the features of the right arm: 1 equal to the left, -1 opposite.
    """
    body = [values.get(name, 0.0) for name in BODY_FEATURES]
    arm = [values.get(name, 0.0) for name in ARM_FEATURES]
    return np.array([*body, *arm, *(right_sign * value for value in arm)])


def draw_arm_pose(file: StanceFile, chance: np.random.Generator) -> Stance | None:
    """Draw a posture with hands before the body, or None.

    None means hanging arms.

    Args:
        file: distribution of all postures.
        chance: random generator.
    """
    weights = np.array([file.hanging.weight, *(pose.weight for pose in file.poses)])
    chosen = int(chance.choice(len(weights), p=weights / weights.sum()))
    if chosen == 0:
        return None
    pose = file.poses[chosen - 1]
    rows = np.stack([_whole_body(row) for row in pose.components])
    stance = np.stack([_whole_body(pose.mean), _draw_normals(len(rows), chance) @ rows])
    if chance.uniform() < MIRROR_PROBABILITY:
        stance = mirror_features(stance)
    return Stance(*map(sealed, stance))


def mirror_features(features: Floats) -> Floats:
    """Return the features (..., s) [deg] of the mirror image."""
    count = len(BODY_FEATURES)
    signs = [1.0 if name in SYMMETRIC_BODY else -1.0 for name in BODY_FEATURES]
    left, right = np.split(features[..., count:], len(SIDES), axis=-1)
    return np.concatenate([features[..., :count] * signs, right, left], axis=-1)


def _whole_body(values: Mapping[str, float]) -> Floats:
    return np.array([values.get(name, 0.0) for name in STANCE_FEATURES])


def _draw_normals(count: int, chance: np.random.Generator) -> Floats:
    return np.clip(chance.normal(size=count), -MAX_DRAW, MAX_DRAW)


def draw_deviation(table: StanceTable, chance: np.random.Generator) -> Floats:
    """Draw one person's random deviation (s,) [deg] from the symmetric mean posture."""
    person, rest = (draw_components(components, chance) for components in (table.persons, table.rests))
    return np.asarray(expand_features(table.handedness, -1.0) + person + rest)


def draw_components(components: StanceComponents, chance: np.random.Generator) -> Floats:
    """Draw a random sum (s,) [deg] of principal components.

    Most draws lie near the mean, and a few far from it: one factor scales all components of equal symmetry.
    """
    drawn = np.zeros(len(STANCE_FEATURES))
    for table, right_sign in ((components.symmetric, 1.0), (components.asymmetric, -1.0)):
        rows = [expand_features(row, right_sign) for row in table]
        normals = _draw_normals(len(rows), chance)
        freedom = components.degrees_of_freedom
        spread = min(sqrt(freedom / float(chance.chisquare(freedom))), MAX_SPREAD)
        drawn += spread * normals @ np.stack(rows)
    return drawn
