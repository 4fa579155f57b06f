"""Fit of a standing posture distribution to resting frames of captured clips."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from math import sqrt

import numpy as np

from kinesic.bench.naturalness.measures import PROFILE_RATE
from kinesic.bench.naturalness.whole_body.motion import BodyMotion
from kinesic.bench.naturalness.whole_body.posture import MAX_REST_SPEED, posture_axes
from kinesic.body.arrays import Floats, Indices
from kinesic.planning.arm_directions import ARM_FEATURES
from kinesic.planning.stance import BODY_FEATURES, STANCE_FEATURES, SYMMETRIC_BODY, StanceComponents, StanceTable

StanceGroups = Mapping[str, Floats]  # clip group, which counts as one person -> stances (k, s) [deg]
ASYMMETRIC_BODY = tuple(name for name in BODY_FEATURES if name not in SYMMETRIC_BODY)
SYMMETRIC_FEATURES = (*SYMMETRIC_BODY, *ARM_FEATURES)  # features of the symmetric part, arms as mean of both
ASYMMETRIC_FEATURES = (*ASYMMETRIC_BODY, *ARM_FEATURES)  # features of the asymmetric part, arms as half difference
FIRST_ARM = STANCE_FEATURES.index(f"l_{ARM_FEATURES[0]}")  # index of the first arm feature
# [deg] largest angles of a hanging arm, by feature.
MAX_HANGING = {"upper_arm_forward": 30.0, "upper_arm_outward": 30.0, "forearm_forward": 45.0}
MIN_DEVIATION = 0.3  # [deg] principal components with smaller deviations are dropped
# [deg] smallest change of a feature since the first frame; clips of a set begin and end in one pose of the animator.
MIN_POSE_CHANGE = 3.0
MIN_CLIP_COUNT = 5  # persons with fewer clips are left out
REST_FREEDOM = 2.0  # degrees of freedom of the t distribution that best fits resting postures of the tuned sets
SCATTER_STEPS = 60  # fixed-point iterations of the scatter matrix, which converge in about 30


def measure_stance(motion: BodyMotion, frame: int = 0) -> Floats:
    """Measure the `STANCE_FEATURES` (s,) [deg] in one frame of a motion."""
    axes = posture_axes(motion, frame)
    up = axes @ motion.chest_rotations[frame, :, 2]
    head = axes @ motion.head_rotations[frame]
    line = motion.shoulders[0, frame] - motion.shoulders[1, frame]
    hips = axes @ motion.hip_lines[frame]
    roll = -np.arcsin(np.clip(up[1], -1.0, 1.0))
    features = [
        np.arctan2(hips[0], hips[1]),
        np.arctan2(up[0], up[2]),
        roll,
        np.arctan2(head[1, 0], head[0, 0]),
        -np.arcsin(np.clip(head[2, 0], -1.0, 1.0)),
        -np.arcsin(np.clip(head[1, 2], -1.0, 1.0)),
        np.arcsin(line[2] / np.linalg.norm(line)) - roll,
    ]
    for k, sign in enumerate((1.0, -1.0)):
        points = [values[k, frame] for values in (motion.shoulders, motion.elbows, motion.wrists)]
        hand = motion.hand_rotations[k, frame] @ motion.hand_axes[k]
        for link in (points[1] - points[0], points[2] - points[1], hand):
            direction = axes @ link / np.linalg.norm(link)
            features += [np.arctan2(direction[0], -direction[2]), np.arcsin(np.clip(sign * direction[1], -1.0, 1.0))]
    return np.degrees(features)


def group_hanging(clips: Iterable[BodyMotion]) -> StanceGroups:
    """Return the stances (k, s) [deg] with hanging arms, by clip group."""
    return group_changed(clips, is_hanging)


def group_changed(clips: Iterable[BodyMotion], is_counted: Callable[[Floats], bool]) -> StanceGroups:
    """Return resting stances (k, s) [deg] unlike each clip's first, by group.

    `is_counted` selects the stances. Frames in the pose of the first frame are left out. A group has the clips of one
    set whose names agree between `@` and the first `_`. Groups with stances from fewer than `MIN_CLIP_COUNT` clips are
    left out.
    """
    groups: dict[str, list[Floats]] = {}
    for clip in clips:
        stances = [stance for frame in find_resting_frames(clip) if is_counted(stance := measure_stance(clip, frame))]
        first = measure_stance(clip)
        changed = [stance for stance in stances if np.abs(stance - first).max() > MIN_POSE_CHANGE]
        if changed:
            name = f"{clip.set_name} {clip.name.split('@')[-1].split('_')[0]}"
            groups.setdefault(name, []).append(np.stack(changed))
    return {name: np.concatenate(rows) for name, rows in groups.items() if len(rows) >= MIN_CLIP_COUNT}


def find_resting_frames(motion: BodyMotion) -> Indices:
    """Return the indices (k,) of frames in which both hands are slow."""
    hands = (motion.wrists - motion.chest) / motion.arm
    speeds = np.linalg.norm(np.gradient(hands, 1.0 / PROFILE_RATE, axis=1), axis=-1)
    return np.flatnonzero(speeds.max(axis=0) < MAX_REST_SPEED)


def fit_stances(groups: StanceGroups, weight: float = 1.0) -> StanceTable:
    """Fit the predictive distribution of an unseen person's stance.

    Every group counts as one person. Persons follow the predictive t distribution, which is wider than the sample, as
    few people were captured. Rests have heavy tails: most are near the mean, and a few far from it. People are not
    symmetric on average, as most are right-handed.

    Args:
        groups: stances (k, s) [deg] by person.
        weight: probability of hanging arms.
    """
    centres = np.stack([rows.mean(axis=0) for rows in groups.values()])
    symmetric, asymmetric = _split(centres)
    count, mean, handedness = len(centres), symmetric.mean(axis=0), asymmetric.mean(axis=0)
    widened = sqrt(1 + 1 / count)
    parts = [_split(rows - rows.mean(axis=0)) for rows in groups.values()]
    within = [_scale_tails([part[k] for part in parts]) for k in range(2)]
    return StanceTable(
        weight=weight,
        mean=name_features(SYMMETRIC_FEATURES, mean),
        handedness=name_features(ASYMMETRIC_FEATURES, handedness),
        persons=StanceComponents(
            degrees_of_freedom=count - 1,
            symmetric=_find_components((symmetric - mean) / sqrt(count - 1), widened, SYMMETRIC_FEATURES),
            asymmetric=_find_components((asymmetric - handedness) / sqrt(count - 1), widened, ASYMMETRIC_FEATURES),
        ),
        rests=StanceComponents(
            degrees_of_freedom=REST_FREEDOM,
            symmetric=_find_components(within[0], 1.0, SYMMETRIC_FEATURES),
            asymmetric=_find_components(within[1], 1.0, ASYMMETRIC_FEATURES),
        ),
    )


def _split(stances: Floats) -> tuple[Floats, Floats]:
    """Split stances (k, s) into symmetric and asymmetric features."""
    left, right = stances[:, FIRST_ARM:].reshape(len(stances), 2, -1).transpose(1, 0, 2)
    body = dict(zip(BODY_FEATURES, stances[:, :FIRST_ARM].T, strict=True))
    symmetric = np.column_stack([*(body[name] for name in SYMMETRIC_BODY), (left + right) / 2])
    asymmetric = np.column_stack([*(body[name] for name in ASYMMETRIC_BODY), (left - right) / 2])
    return symmetric, asymmetric


def _scale_tails(parts: Sequence[Floats]) -> Floats:
    """Scale deviations so that their scatter equals a t distribution's, (k, c).

    Args:
        parts: deviations (k, c) of each person; persons have equal weights.
    """
    rows = np.concatenate(parts)
    weights = np.concatenate([np.full(len(part), 1.0 / (len(parts) * len(part))) for part in parts])
    scaled = np.sqrt(weights)[:, None] * rows
    for _ in range(SCATTER_STEPS):
        inverse = np.linalg.pinv(scaled.T @ scaled)
        distances = np.einsum("ij,jk,ik->i", rows, inverse, rows)
        tail_weights = (REST_FREEDOM + rows.shape[1]) / (REST_FREEDOM + distances)
        scaled = np.sqrt(weights * tail_weights)[:, None] * rows
    return np.asarray(scaled)


def is_hanging(stance: Floats) -> bool:
    """Return whether both arms of a stance (s,) [deg] hang."""
    ranges = {name: (-limit, limit) for name, limit in MAX_HANGING.items()}
    arms = np.split(stance[FIRST_ARM:], 2)
    return all(is_within(dict(zip(ARM_FEATURES, arm.tolist(), strict=True)), ranges) for arm in arms)


def is_within(angles: Mapping[str, float], ranges: Mapping[str, tuple[float, float]]) -> bool:
    """Return whether each named angle is within its range."""
    return all(lower <= angles[name] <= upper for name, (lower, upper) in ranges.items())


def _find_components(rows: Floats, factor: float, names: Sequence[str]) -> list[dict[str, float]]:
    """Return the principal components of rows (k, c), multiplied by `factor`."""
    _, sizes, directions = np.linalg.svd(rows, full_matrices=False)
    scaled = factor * sizes[:, None] * directions
    return [name_features(names, row) for row in scaled if np.abs(row).max() > MIN_DEVIATION]


def name_features(names: Sequence[str], values: Floats) -> dict[str, float]:
    """Return rounded values by the names of their features."""
    return {name: round(float(value), 2) for name, value in zip(names, values, strict=True)}
