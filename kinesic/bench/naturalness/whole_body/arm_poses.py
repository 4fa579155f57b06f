"""Fit of standing postures whose arms do not hang to resting frames of captured clips."""

from collections.abc import Iterable, Mapping, Sequence
from typing import Literal

import numpy as np

from kinesic.bench.naturalness.whole_body.motion import BodyMotion
from kinesic.bench.naturalness.whole_body.stances import (
    FIRST_ARM,
    MAX_HANGING,
    StanceGroups,
    group_changed,
    is_within,
)
from kinesic.body.arrays import Floats
from kinesic.planning.arm_directions import ARM_FEATURES
from kinesic.planning.stance import BODY_FEATURES, STANCE_FEATURES, ArmPoseTable, mirror_features

ArmPlace = Literal["hanging", "before"]
# Right arm and left arm of each pose, which counts with its mirror image.
POSE_PLACES: Mapping[str, tuple[ArmPlace, ArmPlace]] = {
    "one_hand_before": ("before", "hanging"),
    "both_hands_before": ("before", "before"),
}
# [deg] smallest and largest angles of an arm with its hand low before the body.
BEFORE_BODY = {
    "upper_arm_forward": (-35.0, 35.0),
    "upper_arm_outward": (-35.0, 35.0),
    "forearm_forward": (45.0, 100.0),
    "forearm_outward": (-35.0, 35.0),
}
MAX_COMPONENTS = 6  # principal components of each posture
MIN_ANGLE = 0.5  # [deg] smaller angles are left out
# Weights of features in the choice of principal components: viewers see a turned head sooner than a bent wrist.
BODY_WEIGHT = 2.0  # of trunk and head
HAND_WEIGHT = 0.3


def group_poses(clips: Iterable[BodyMotion]) -> Mapping[str, StanceGroups]:
    """Return the stances (k, s) [deg] by pose and clip group.

    Mirror images count as well, so that no pose has a side. A pose with one hand before the body has the right one
    there.
    """
    groups = group_changed(clips, lambda stance: find_pose(stance) is not None)
    poses: dict[str, dict[str, Floats]] = {name: {} for name in POSE_PLACES}
    for person, rows in groups.items():
        for name, places in POSE_PLACES.items():
            both = np.concatenate([rows, mirror_features(rows)])
            chosen = [row for row in both if (_find_place(row, 1), _find_place(row, 0)) == places]
            if chosen:
                poses[name][person] = np.stack(chosen)
    return poses


def find_pose(stance: Floats) -> str | None:
    """Return the pose of a stance (s,) [deg], or None."""
    right, left = _find_place(stance, 1), _find_place(stance, 0)
    return next((name for name, places in POSE_PLACES.items() if places in ((right, left), (left, right))), None)


def fit_poses(poses: Mapping[str, StanceGroups], hanging: StanceGroups) -> tuple[float, Sequence[ArmPoseTable]]:
    """Fit mean, components and probability of each pose.

    Sets count equally in probabilities, and stances in means and components. Symmetric poses are among the given
    stances twice, with their mirror images.

    Args:
        poses: stances (k, s) [deg] by pose and person, with mirror images.
        hanging: stances with hanging arms by person.

    Returns:
        Probability of hanging arms, and the poses.
    """
    weights = _weigh(poses, hanging)
    tables = []
    for name, groups in poses.items():
        rows = np.concatenate([*groups.values()])
        centre = rows.mean(axis=0)
        components = _find_seen_components((rows - centre) / np.sqrt(len(rows)))
        mean = _name_large(centre)
        tables.append(ArmPoseTable(name=name, weight=round(weights[name], 2), mean=mean, components=components))
    return round(1.0 - sum(table.weight for table in tables), 2), tables


def _find_seen_components(rows: Floats) -> Sequence[Mapping[str, float]]:
    """Return the largest principal components of rows (k, s), weighted by visibility."""
    weights = [_weigh_feature(name) for name in STANCE_FEATURES]
    _, sizes, directions = np.linalg.svd(rows * weights, full_matrices=False)
    components = (sizes[:, None] * directions / weights)[:MAX_COMPONENTS]
    return [_name_large(row) for row in components]


def _name_large(values: Floats) -> Mapping[str, float]:
    """Return the rounded values (s,) [deg] of at least `MIN_ANGLE` by feature."""
    pairs = zip(STANCE_FEATURES, values.tolist(), strict=True)
    return {name: round(value, 1) for name, value in pairs if abs(value) >= MIN_ANGLE}


def _weigh_feature(name: str) -> float:
    return BODY_WEIGHT if name in BODY_FEATURES else HAND_WEIGHT if "_hand_" in name else 1.0


def _weigh(poses: Mapping[str, StanceGroups], hanging: StanceGroups) -> Mapping[str, float]:
    """Return the mean fraction of each pose in the resting frames of a set."""
    groups = [hanging, *poses.values()]
    sets = sorted({_set_of(person) for group in groups for person in group})
    counts = np.array([[_count_frames(group, name) for group in groups] for name in sets])
    counts[:, 1:] /= [2.0 if right == left else 1.0 for right, left in (POSE_PLACES[name] for name in poses)]
    fractions = (counts / counts.sum(axis=1, keepdims=True)).mean(axis=0)
    return dict(zip(poses, fractions[1:].tolist(), strict=True))


def _count_frames(group: StanceGroups, set_name: str) -> float:
    return float(sum(len(rows) for person, rows in group.items() if _set_of(person) == set_name))


def _set_of(person: str) -> str:
    return person.split(maxsplit=1)[0]


def _find_place(stance: Floats, arm: int) -> ArmPlace | None:
    angles = dict(zip(ARM_FEATURES, np.split(stance[FIRST_ARM:], 2)[arm].tolist(), strict=True))
    hanging = {name: (-limit, limit) for name, limit in MAX_HANGING.items()}
    places: Mapping[ArmPlace, Mapping[str, tuple[float, float]]] = {
        "hanging": hanging,
        "before": BEFORE_BODY,
    }
    return next((place for place, ranges in places.items() if is_within(angles, ranges)), None)
