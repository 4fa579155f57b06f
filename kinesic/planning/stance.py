"""Standing postures drawn from a distribution that was fitted on captured people."""

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

STANCE_FILE = CONFIGS / "standing.toml"
# Angles [deg] of trunk and head; `shoulder_rise` is that of the line of the shoulders over the rolled trunk.
BODY_FEATURES = ("trunk_tilt", "trunk_roll", "head_turn", "head_tilt", "head_roll", "shoulder_rise")
STANCE_FEATURES = (*BODY_FEATURES, *(f"{side}_{name}" for side in SIDES for name in ARM_FEATURES))
MAX_DRAW = 1.8  # [standard deviations] bound of the random value of each principal component
MAX_SPREAD = 1.5  # bound of the common random factor of all components, from the tails of the t distribution


class StanceComponents(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """TOML table of a multivariate t distribution by its principal components [deg]."""

    degrees_of_freedom: float  # the smaller, the more draws lie far from the mean
    symmetric: Sequence[Mapping[str, float]]  # equal for both arms
    asymmetric: Sequence[Mapping[str, float]]  # added to the left arm and subtracted from the right


class StanceTable(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """TOML table of a distribution of standing postures [deg]."""

    mean: Mapping[str, float]  # by feature; arms by features of one arm
    handedness: Mapping[str, float]  # mean asymmetry, added to the left arm and subtracted from the right
    persons: StanceComponents  # deviations of persons from the mean
    rests: StanceComponents  # deviations of rests from the mean of their person


class StanceFile(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """TOML file of standing postures."""

    hanging: StanceTable


@dataclass(frozen=True, eq=False)
class StanceDeviation:
    """Deviation of one person's stance from the mean."""

    features: Floats  # (s,) [deg] in the order of `STANCE_FEATURES`
    torsion: float  # [rad] of the trunk, + to the left of the feet

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


def expand_features(values: Mapping[str, float], right_sign: float = 1.0) -> Floats:
    """Return features (s,) [deg] in the order of `STANCE_FEATURES`.

    Args:
        values: by feature; missing ones are zero.
        right_sign: factor on the features of the right arm: 1 equal to the left, -1 opposite.
    """
    body = [values.get(name, 0.0) for name in BODY_FEATURES]
    arm = [values.get(name, 0.0) for name in ARM_FEATURES]
    return np.array([*body, *arm, *(right_sign * value for value in arm)])


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
        normals = np.clip(chance.normal(size=len(rows)), -MAX_DRAW, MAX_DRAW)
        freedom = components.degrees_of_freedom
        spread = min(sqrt(freedom / float(chance.chisquare(freedom))), MAX_SPREAD)
        drawn += spread * normals @ np.stack(rows)
    return drawn
