"""Feature vectors of clips for classifiers, and their statistics by set."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from kinesic.bench.naturalness.whole_body.classifier import Sample
from kinesic.bench.naturalness.whole_body.clips import OTHER_SET
from kinesic.bench.naturalness.whole_body.measures import (
    WholeBodyMeasures,
    cut_clips,
    measure_whole_body,
)
from kinesic.bench.naturalness.whole_body.motion import BodyMotion
from kinesic.bench.naturalness.whole_body.posture import (
    StandingPosture,
    measure_posture,
    posture_vector,
    starts_at_rest,
)
from kinesic.body.arrays import Floats

SMALLEST_VALUES: Mapping[str, float] = {  # measure compared by its logarithm -> lower bound of its values
    "trunk": 0.1,
    "trunk_speed": 0.1,
    "head": 0.1,
    "head_speed": 0.1,
    "collar": 0.001,
    "free_arm": 0.01,
    "hand_turning": 1.0,
    "wrist_range": 1.0,
    "elbow_range": 1.0,
    "largest_speed": 0.01,
    "path": 0.01,
    "units_per_second": 0.1,
}
PLAIN_MEASURES = ("sparc", "still")  # measures compared without logarithm
MOTION_FEATURES = (*SMALLEST_VALUES, *PLAIN_MEASURES)


@dataclass(frozen=True, eq=False)
class MeasuredSet:
    """Measures of the clips of a captured set or a robot."""

    name: str
    gestures: tuple[WholeBodyMeasures, ...]
    performances: tuple[str, ...]  # performance of each gesture
    postures: tuple[StandingPosture, ...]  # postures in the first frame of clips that start at rest
    rests: tuple[str, ...]  # performance of each posture

    def values(self, name: str) -> Floats:
        """Return the available values (m,) of one measure."""
        results = (getattr(measures, name) for measures in self.gestures)
        return np.array([value for value in results if value is not None], dtype=np.float64)

    def posture_values(self, name: str) -> Floats:
        """Return the values (m,) of one posture feature."""
        return np.array([getattr(posture, name) for posture in self.postures], dtype=np.float64)


def measure_set(name: str, motions: Iterable[BodyMotion]) -> MeasuredSet:
    """Measure motion and initial postures of the clips of one set."""
    clips = list(motions)
    gestures = [gesture for clip in clips for gesture in cut_clips(clip) if clip.set_name != OTHER_SET]
    resting = [clip for clip in clips if starts_at_rest(clip)]
    return MeasuredSet(
        name,
        tuple(map(measure_whole_body, gestures)),
        tuple(gesture.performance for gesture in gestures),
        tuple(map(measure_posture, resting)),
        tuple(clip.performance for clip in resting),
    )


def measure_sets(motions: Iterable[BodyMotion]) -> list[MeasuredSet]:
    """Measure clips set by set, in order of the sets' names."""
    groups: dict[str, list[BodyMotion]] = {}
    for motion in motions:
        groups.setdefault(motion.set_name, []).append(motion)
    return [measure_set(name, groups[name]) for name in sorted(groups)]


def motion_sample(sets: Sequence[MeasuredSet], *, whole_sets: bool = False) -> Sample:
    """Return the kinematic features of all gestures in the given sets.

    Args:
        sets: measured sets.
        whole_sets: whether a set counts as one performance, so that cross-validation leaves out whole sets.
    """
    rows = [_motion_vector(measures) for measured in sets for measures in measured.gestures]
    return Sample(np.reshape(rows, (-1, len(MOTION_FEATURES))), _performances(sets, "performances", whole_sets))


def posture_sample(sets: Sequence[MeasuredSet], *, whole_sets: bool = False) -> Sample:
    """Return the posture features of all clips' first frames in given sets."""
    rows = [posture_vector(posture) for measured in sets for posture in measured.postures]
    return Sample(np.array(rows), _performances(sets, "rests", whole_sets))


def _performances(sets: Sequence[MeasuredSet], field: str, whole_sets: bool) -> tuple[str, ...]:
    return tuple(
        measured.name if whole_sets else f"{measured.name}: {performance}"
        for measured in sets
        for performance in getattr(measured, field)
    )


def _motion_vector(measures: WholeBodyMeasures) -> list[float]:
    logarithms = [float(np.log(max(getattr(measures, name), least))) for name, least in SMALLEST_VALUES.items()]
    return [*logarithms, *(getattr(measures, name) for name in PLAIN_MEASURES)]
