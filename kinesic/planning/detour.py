"""Detours around the body by additional or displaced keys."""

from collections.abc import Iterator
from dataclasses import dataclass
from math import ceil

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.body.dynamics import Distances
from kinesic.body.robot import Robot
from kinesic.planning.collision import Spacing, separate
from kinesic.planning.posture_course import SCAN_RATE, ArmHinges, PostureCourse

MIN_DETOURS = 16  # number of detours allowed in even the shortest motion
DETOUR_INTERVAL = 10.0  # [s] additional motion time that allows `MIN_DETOURS` further detours
SCAN_BUDGET = 2600.0  # [s] motion time scanned for all detours: 64 detours in a 40 s motion, 17 in 150 s
DETOUR_MARGIN = 0.008  # [m] extra clearance of a detour in addition to the required clearance
WITHDRAWAL_FRACTIONS = (0.2, 0.35, 0.7)  # fractions of the path to rest at which a key is tried
MIN_VISIBLE_DEFICIT = (
    0.002  # [m] smallest missing clearance for which an arm moves visibly: towards rest, or away from a key
)
REST_PENALTY = 0.3  # fraction of the best gain so far that keys nearer to rest must add, because viewers see arms drop
WITHDRAWAL_PENALTY = 0.1  # fraction of the best gain so far by which a later candidate must exceed it
KEY_OFFSETS = (0.004, 0.016)  # [m] extra clearances tried when an existing key is moved
SWING_RATIO = 0.5  # fraction of the overshoot that is kept if removing more hardly adds clearance
# Fraction of the clearance that a motion without overshoot gains, given up to keep `SWING_RATIO` of the overshoot.
CALM_TOLERANCE = 0.1
ACCEPT_RATIO = 0.98  # largest remaining fraction of the missing clearance with which a detour is accepted


class ClearPostures:
    """Finder of collision-free postures, with a cache.

    Most of a course does not change between searches.
    """

    def __init__(self, robot: Robot, distances: Distances) -> None:
        """Start with an empty cache.

        Args:
            robot: the robot.
            distances: self-distances of the robot.
        """
        self.distances = distances
        self._robot = robot
        self._cache: dict[tuple[bytes, ArmHinges, Spacing], Floats | None] = {}

    def near(self, angles: Floats, joints: ArmHinges, spacing: Spacing) -> Floats | None:
        """Return the nearest collision-free posture that some joints reach, or None.

        Args:
            angles: (n,) [rad].
            joints: that may turn.
            spacing: required distances.
        """
        requested = angles.tobytes(), joints, spacing
        if requested not in self._cache:
            self._cache[requested] = separate(angles, joints, self._robot, self.distances, spacing)
        return self._cache[requested]


def add_detours(
    course: PostureCourse, distances: Distances, *, min_clearance: float, cache: ClearPostures | None = None
) -> PostureCourse:
    """Add detours to key postures wherever the motion nearly hits the body.

    Colliding intervals are handled one after the other. Overshoot of the arms is halved first, or removed with their
    accents, if that helps. Otherwise the change with the smallest remaining violation is taken: an arm without a close
    key gets one in the nearest clear posture; an existing key moves away if it is close or collides itself. If this
    helps much more, and at least `MIN_VISIBLE_DEFICIT` is missing, the arm gets a key nearer to rest instead.

    Args:
        course: at least two keys, the first and the last at rest.
        distances: self-distances of the robot.
        min_clearance: [m] sufficient clearance.
        cache: cache of collision-free postures.

    Returns:
        The given course if nothing needs a change. It may still collide where no change helps.
    """
    scan, stuck = _Scan.of(course, distances, min_clearance), set[int]()
    clear_postures = cache or ClearPostures(course.robot, distances)
    for _ in range(_compute_max_detours(course.motion.duration)):
        open_stretches = [sample for sample in _find_closest_samples(scan.deficits) if sample not in stuck]
        if not open_stretches:
            break
        sample = open_stretches[0]
        time = sample / SCAN_RATE - course.motion.zero
        if (calm_keys := course.reduce_overshoot(time)) is not course:
            calm_scan = scan.after(calm_keys, distances, min_clearance)
            if calm_scan.deficits.sum() < scan.deficits.sum():
                reduced = course.reduce_overshoot(time, SWING_RATIO)
                reduced_scan = scan.after(reduced, distances, min_clearance)
                remaining, gain = calm_scan.deficits.sum(), scan.deficits.sum() - calm_scan.deficits.sum()
                if reduced_scan.deficits.sum() <= remaining + CALM_TOLERANCE * gain:
                    calm_keys, calm_scan = reduced, reduced_scan
                course, scan, stuck = calm_keys, calm_scan, calm_scan.same(stuck, scan)
                continue
        best, best_scan, allowed, total_deficit = course, scan, ACCEPT_RATIO * scan.deficits.sum(), scan.deficits.sum()
        for fractions in ((0.0,), WITHDRAWAL_FRACTIONS):
            if any(fractions):
                if scan.deficits[sample] < MIN_VISIBLE_DEFICIT:
                    break
                allowed -= REST_PENALTY * (total_deficit - best_scan.deficits.sum())
            for change in _propose_detours(course, time, clear_postures, min_clearance, scan.deficits, fractions):
                candidate_scan = scan.after(change, distances, min_clearance)
                if candidate_scan.deficits.sum() < allowed:
                    best, best_scan, allowed = (
                        change,
                        candidate_scan,
                        candidate_scan.deficits.sum()
                        - WITHDRAWAL_PENALTY * (total_deficit - candidate_scan.deficits.sum()),
                    )
                if allowed <= 0.0:
                    break
            if allowed <= 0.0:
                break
        if best is course:
            stuck.add(sample)
        else:
            course, scan, stuck = best, best_scan, best_scan.same(stuck, scan)
    return course


@dataclass(frozen=True, eq=False)
class _Scan:
    """Sampled postures with the missing clearance [m] of each."""

    angles: Floats  # (m, n) [rad] of the samples
    deficits: Floats  # (m,) [m] missing clearance

    @classmethod
    def of(cls, course: PostureCourse, distances: Distances, min_clearance: float) -> "_Scan":
        angles = course.samples()
        return cls(angles, np.maximum(min_clearance - distances.clearance(angles).distances, 0.0))

    def after(self, change: PostureCourse, distances: Distances, min_clearance: float) -> "_Scan":
        """Return the collision scan of a changed posture course.

        Only samples with a changed posture are measured again.
        """
        angles = change.samples()
        other = np.flatnonzero((angles != self.angles).any(axis=1))
        deficits = self.deficits.copy()
        deficits[other] = np.maximum(min_clearance - distances.clearance(angles[other]).distances, 0.0)
        return _Scan(angles, deficits)

    def same(self, samples: set[int], before: "_Scan") -> set[int]:
        """Return the given samples with the same missing clearance in another scan.

        A detour elsewhere has not helped there.
        """
        return {k for k in samples if self.deficits[k] == before.deficits[k]}


def _compute_max_detours(duration: float) -> int:
    """Return the maximum number of detours for a motion duration [s]."""
    return max(
        MIN_DETOURS,
        min(ceil(MIN_DETOURS * duration / DETOUR_INTERVAL), int(SCAN_BUDGET / max(duration, DETOUR_INTERVAL))),
    )


def _find_closest_samples(deficits: Floats) -> Iterator[int]:
    """Yield the index of the closest sample of each colliding interval."""
    stretches = np.split(np.arange(len(deficits)), np.flatnonzero(np.diff(deficits > 0)) + 1)
    return (int(s[deficits[s].argmax()]) for s in stretches if deficits[s].max(initial=0.0) > 0)


def _propose_detours(
    course: PostureCourse,
    time: float,
    clear_postures: ClearPostures,
    min_clearance: float,
    deficits: Floats,
    fractions: tuple[float, ...],
) -> Iterator[PostureCourse]:
    """Yield candidate detours around the collision at a block time.

    Args:
        course: key postures.
        time: block time [s].
        clear_postures: finder of collision-free postures.
        min_clearance: [m] sufficient clearance.
        deficits: (m,) [m] missing clearance of the course's samples.
        fractions: of the path to rest at which a key is added; existing keys move only on the path itself.
    """
    gaps = clear_postures.distances.gaps(course.at(time)[None])[0]
    close = {segment for k in np.flatnonzero(gaps < min_clearance) for segment in course.robot.counted_pairs[k]}
    arms = [arm.joints for side in course.robot.sides if close & (arm := course.robot.arm(side)).bodies]
    near = [course.near(arm, time) for arm in arms]
    free = [arm for arm, key in zip(arms, near, strict=True) if key is None]
    if free:
        yield from _add_key_candidates(course, time, free, clear_postures, min_clearance, fractions)
    if any(fractions):
        return
    keys = {key for key in near if key is not None} or course.detours(time, arms)
    for key in sorted(keys | course.colliding_keys(time, arms, deficits, min_deficit=MIN_VISIBLE_DEFICIT)):
        yield from _move_key_candidates(course, key, arms, clear_postures, min_clearance)


def _add_key_candidates(
    course: PostureCourse,
    time: float,
    arms: list[ArmHinges],
    clear_postures: ClearPostures,
    min_clearance: float,
    fractions: tuple[float, ...],
) -> Iterator[PostureCourse]:
    """Yield detours with an additional collision-free key for some arms.

    The key is near their posture, moved by each of `fractions` of the path to rest.
    """
    angles, joints = course.at(time), _joined(arms)
    for fraction in fractions:
        start = angles.copy()
        start[[*joints]] += fraction * (course.robot.skeleton.rest - angles)[[*joints]]
        clear = clear_postures.near(start, joints, Spacing(min_clearance, min_clearance + DETOUR_MARGIN))
        if clear is not None:
            change = course
            for together in course.group_by_key_times(arms):
                change = change.extended(time, clear, together)
            yield change


def _move_key_candidates(
    course: PostureCourse, key: int, arms: list[ArmHinges], clear_postures: ClearPostures, min_clearance: float
) -> Iterator[PostureCourse]:
    """Yield detours that move existing arm keys away from the body.

    Keys at rest stay.
    """
    posture, angles = course.postures[key], course.at(float(course.planned[key]))
    rest = course.robot.skeleton.rest
    keyed = [arm for arm in arms if posture.keyed[arm[0]] and np.any(posture.angles[list(arm)] != rest[list(arm)])]
    gap = float(clear_postures.distances.gaps(angles[None])[0].min())
    for offset in KEY_OFFSETS if keyed else ():
        clear = clear_postures.near(angles, _joined(keyed), Spacing(max(gap, min_clearance) + offset))
        if clear is not None:
            change = course
            for arm in keyed:
                change = change.moved(key, clear, arm)
            yield change


def _joined(arms: list[ArmHinges]) -> ArmHinges:
    return tuple(joint for arm in arms for joint in arm)
