"""Frechet distance between the arm motions of two sets of clips."""

from collections.abc import Mapping, Sequence

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.body.robot import SIDES, Side
from kinesic.capture.clip import ArmPath
from kinesic.capture.robot_motion import SAMPLE_RATE

SAMPLE_STEP = 5  # number of clip samples per sample of the distribution
VELOCITY_WEIGHT = 0.1  # [s] factor that converts velocities to features [arm lengths]
MIN_DEVIATION = 0.02  # [arm lengths] lower bound of a feature's standard deviation as a divisor, for still arms


def sample_features(arms: Mapping[Side, ArmPath]) -> Floats:
    """Return features (k, 24) of a clip: elbows, wrists and their velocities.

    Args:
        arms: paths at `SAMPLE_RATE`.
    """
    points = np.concatenate([np.concatenate([arms[side].elbow, arms[side].wrist], axis=1) for side in SIDES], axis=1)
    velocities = np.gradient(points, axis=0) * SAMPLE_RATE if len(points) > 1 else np.zeros_like(points)
    features: Floats = np.concatenate([points, VELOCITY_WEIGHT * velocities], axis=1)[::SAMPLE_STEP]
    return features


def frechet_distance(first: Sequence[Floats], second: Sequence[Floats]) -> float:
    """Return the Frechet distance between two sets of clips, as normal distributions.

    Features are divided by their standard deviations in the first set. The distance is 0 for equal distributions, and d
    if all features are shifted by d / sqrt(features) standard deviations.

    Args:
        first: features (k, f) of each clip, the reference.
        second: features (k, f) of each clip.
    """
    reference, other = np.concatenate(first), np.concatenate(second)
    scale = np.maximum(reference.std(axis=0), MIN_DEVIATION)
    reference, other = reference / scale, other / scale
    shift = reference.mean(axis=0) - other.mean(axis=0)
    a, b = np.cov(reference, rowvar=False), np.cov(other, rowvar=False)
    root = _square_root(a)
    mixed = np.sqrt(np.maximum(np.linalg.eigvalsh(root @ b @ root), 0.0)).sum()
    squared = float(shift @ shift + np.trace(a) + np.trace(b) - 2.0 * mixed)
    return float(np.sqrt(max(squared, 0.0)))


def _square_root(matrix: Floats) -> Floats:
    """Return the square root of a positive semi-definite matrix (f, f)."""
    values, vectors = np.linalg.eigh(matrix)
    root: Floats = (vectors * np.sqrt(np.maximum(values, 0.0))) @ vectors.T
    return root
