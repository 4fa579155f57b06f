"""Arm poses with hands before the body, fitted to captured resting frames."""

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from typing import Literal

import numpy as np

from kinesic.bench.naturalness.whole_body.motion import BodyMotion
from kinesic.bench.naturalness.whole_body.stances import (
    FIRST_ARM,
    MAX_HANGING,
    StanceGroups,
    find_resting_frames,
    group_changed,
    is_hanging,
    is_within,
    measure_stance,
)
from kinesic.body.arrays import Floats
from kinesic.planning.arm_directions import ARM_FEATURES
from kinesic.planning.stance import BODY_FEATURES, STANCE_FEATURES, ArmPoseTable, mirror_features

ArmPlace = Literal["hanging", "before"]
# Positions of right and left arm in each pose; a mirror image counts as the same pose.
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
MAX_COMPONENTS = 6  # largest number of principal components of each pose
MIN_ANGLE = 0.5  # [deg] smaller angles of a pose are left out
# Weights of features in the choice of principal components: viewers see a turned head sooner than a bent wrist.
BODY_WEIGHT = 2.0  # weight of trunk and head features
HAND_WEIGHT = 0.3  # weight of hand features


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
    """Return the arm pose's name of posture angles (s,) [deg], or None."""
    right, left = _find_place(stance, 1), _find_place(stance, 0)
    return next((name for name, places in POSE_PLACES.items() if places in ((right, left), (left, right))), None)


def weigh_poses(clips: Iterable[BodyMotion]) -> Mapping[str, float]:
    """Return each pose's fraction of resting frames, averaged over sets.

    Frames in the first pose of their clip count as well. The fractions of hanging arms and of all poses sum to one.
    """
    counts: dict[str, Counter[str]] = {}
    for clip in clips:
        stances = (measure_stance(clip, frame) for frame in find_resting_frames(clip))
        names = ("hanging" if is_hanging(stance) else find_pose(stance) for stance in stances)
        counts.setdefault(clip.set_name, Counter()).update(name for name in names if name is not None)
    return {
        name: float(np.mean([count[name] / count.total() for count in counts.values()]))
        for name in ("hanging", *POSE_PLACES)
    }


def fit_poses(poses: Mapping[str, StanceGroups], weights: Mapping[str, float]) -> Sequence[ArmPoseTable]:
    """Fit the mean and principal components of each pose's stances.

    Args:
        poses: stances (k, s) [deg] by pose and person, with mirror images.
        weights: probability of each pose.
    """
    tables = []
    for name, groups in poses.items():
        rows = np.concatenate([*groups.values()])
        centre = rows.mean(axis=0)
        components = _find_seen_components((rows - centre) / np.sqrt(len(rows)))
        mean, weight = _name_large(centre), round(weights[name], 2)
        tables.append(ArmPoseTable(name=name, weight=weight, mean=mean, components=components))
    return tables


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


def _find_place(stance: Floats, arm: int) -> ArmPlace | None:
    angles = dict(zip(ARM_FEATURES, np.split(stance[FIRST_ARM:], 2)[arm].tolist(), strict=True))
    hanging = {name: (-limit, limit) for name, limit in MAX_HANGING.items()}
    places: Mapping[ArmPlace, Mapping[str, tuple[float, float]]] = {
        "hanging": hanging,
        "before": BEFORE_BODY,
    }
    return next((place for place, ranges in places.items() if is_within(angles, ranges)), None)
