"""Fit of a standing posture distribution to first frames of captured clips."""

from collections.abc import Iterable, Mapping, Sequence
from math import sqrt

import numpy as np

from kinesic.bench.naturalness.whole_body.motion import BodyMotion
from kinesic.bench.naturalness.whole_body.posture import posture_axes, starts_at_rest
from kinesic.body.arrays import Floats
from kinesic.planning.arm_directions import ARM_FEATURES
from kinesic.planning.stance import BODY_FEATURES, STANCE_FEATURES, StanceTable

SYMMETRIC_BODY = ("trunk_tilt", "head_tilt")  # features of trunk and head that a mirror image keeps
ASYMMETRIC_BODY = tuple(name for name in BODY_FEATURES if name not in SYMMETRIC_BODY)
FIRST_ARM = STANCE_FEATURES.index(f"l_{ARM_FEATURES[0]}")
# [deg] largest angles of a hanging arm, by feature.
MAX_HANGING = {"upper_arm_forward": 30.0, "upper_arm_outward": 30.0, "forearm_forward": 45.0}
MIN_DEVIATION = 0.05  # [deg] principal components with smaller deviations are dropped


def measure_stance(motion: BodyMotion, frame: int = 0) -> Floats:
    """Measure the `STANCE_FEATURES` (s,) [deg] in one frame."""
    axes = posture_axes(motion, frame)
    up = axes @ motion.chest_rotations[frame, :, 2]
    head = axes @ motion.head_rotations[frame]
    features = [
        np.arctan2(up[0], up[2]),
        -np.arcsin(np.clip(up[1], -1.0, 1.0)),
        np.arctan2(head[1, 0], head[0, 0]),
        -np.arcsin(np.clip(head[2, 0], -1.0, 1.0)),
        -np.arcsin(np.clip(head[1, 2], -1.0, 1.0)),
    ]
    for k, sign in enumerate((1.0, -1.0)):
        points = [values[k, frame] for values in (motion.shoulders, motion.elbows, motion.wrists)]
        hand = motion.hand_rotations[k, frame] @ motion.hand_axes[k]
        for link in (points[1] - points[0], points[2] - points[1], hand):
            direction = axes @ link / np.linalg.norm(link)
            features += [np.arctan2(direction[0], -direction[2]), np.arcsin(np.clip(sign * direction[1], -1.0, 1.0))]
    return np.degrees(features)


def group_hanging(clips: Iterable[BodyMotion]) -> Mapping[str, Floats]:
    """Return the stances (k, s) [deg] with hanging arms, by clip group.

    A group has the clips of one set whose names agree between `@` and the first `_`. Groups of one clip are left out.
    """
    groups: dict[str, list[Floats]] = {}
    for clip in clips:
        if starts_at_rest(clip) and _is_hanging(stance := measure_stance(clip)):
            groups.setdefault(f"{clip.set_name} {clip.name.split('@')[-1].split('_')[0]}", []).append(stance)
    return {name: np.stack(rows) for name, rows in groups.items() if len(rows) > 1}


def fit_stances(groups: Mapping[str, Floats]) -> StanceTable:
    """Fit the predictive distribution of an unseen person's stance.

    Every group counts as one person. The standard deviations are those of the predictive t distribution, which is wider
    than the sample, as few people were captured. Mirror images have the same weight as captured stances.

    Args:
        groups: stances (k, s) [deg] by person.
    """
    centres = np.stack([rows.mean(axis=0) for rows in groups.values()])
    left, right = centres[:, FIRST_ARM:].reshape(len(centres), 2, -1).transpose(1, 0, 2)
    body = dict(zip(BODY_FEATURES, centres[:, :FIRST_ARM].T, strict=True))
    symmetric = np.column_stack([*(body[name] for name in SYMMETRIC_BODY), (left + right) / 2])
    asymmetric = np.column_stack([*(body[name] for name in ASYMMETRIC_BODY), (left - right) / 2])
    count, mean = len(centres), symmetric.mean(axis=0)
    widened = sqrt((1 + 1 / count) * (count - 1) / (count - 3))
    within = np.sqrt(np.mean([rows.var(axis=0) for rows in groups.values()], axis=0))
    arms = np.sqrt((within[FIRST_ARM:].reshape(2, -1) ** 2).mean(axis=0))
    return StanceTable(
        mean=_name((*SYMMETRIC_BODY, *ARM_FEATURES), mean),
        symmetric=_components(symmetric - mean, count - 1, widened, (*SYMMETRIC_BODY, *ARM_FEATURES)),
        asymmetric=_components(asymmetric, count, sqrt(count / (count - 2)), (*ASYMMETRIC_BODY, *ARM_FEATURES)),
        within=_name((*BODY_FEATURES, *ARM_FEATURES), np.concatenate([within[:FIRST_ARM], arms])),
    )


def _is_hanging(stance: Floats) -> bool:
    arms = stance[FIRST_ARM:].reshape(2, -1)
    columns = [ARM_FEATURES.index(name) for name in MAX_HANGING]
    return bool(np.all(np.abs(arms[:, columns]) <= [*MAX_HANGING.values()]))


def _components(rows: Floats, degrees_of_freedom: int, factor: float, names: Sequence[str]) -> list[dict[str, float]]:
    """Return the principal components, each scaled to its standard deviation."""
    _, sizes, directions = np.linalg.svd(rows, full_matrices=False)
    scaled = factor * sizes[:, None] / sqrt(degrees_of_freedom) * directions
    return [_name(names, row) for row in scaled if np.abs(row).max() > MIN_DEVIATION]


def _name(names: Sequence[str], values: Floats) -> dict[str, float]:
    return {name: round(float(value), 2) for name, value in zip(names, values, strict=True)}
