"""Leads a motion around the body: adds or moves keys where two segments would come too near."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from math import ceil

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.dynamics import Distances
from kinesic.body.limits import Limits
from kinesic.body.robot import SIDES, Robot
from kinesic.motion.desired import DesiredMotion, join_keys
from kinesic.motion.keys import KeyPassage, KeyPosture, Keys
from kinesic.motion.trajectory import Trajectory
from kinesic.planning.collision import Spacing, separate

ArmHinges = tuple[int, ...]  # joints of an arm

SCAN_RATE = 100  # [Hz]
STEPS, LONG = 16, 10.0  # changes of a motion, and [s] of a longer one that may have as many once more
WORK = 2600.0  # [s] of motion that all changes together may look at: one of 40 s has 64 changes, one of 150 s 17
DETOUR_ROOM = 0.008  # [m] that a detour keeps over the clearance that suffices
WITHDRAWALS = (0.0, 0.2, 0.35, 0.7)  # of the way to rest, where a detour begins to look for room
PLAINLY = 0.1  # of what is lacking, that a change must leave less than one which withdraws less
AWAY = (0.004, 0.016)  # [m] that a key goes farther away
LEAST_STEP = 0.06  # [s] between a detour and the keys of the same arm
KEY_SPACING = 1e-4  # [s] between the asked times of keys of different hinges
GAIN = 0.98  # of what is lacking: a change that leaves more is none


@dataclass(frozen=True, eq=False)
class PostureCourse:
    """Key postures, their planned times, and the desired motion through them."""

    postures: tuple[KeyPosture, ...]  # in the order of their times
    planned: Floats  # (k,) [s] block time
    robot: Robot
    limits: Limits
    stray: Floats | None = (
        None  # (m, n) [rad] at `SCAN_RATE`: how far another motion is off the desired one; None: none
    )

    @cached_property
    def motion(self) -> DesiredMotion:
        """The motion through the keys; performance time begins with the first."""
        return join_keys(self.planned, Keys.of(self.postures, self.limits, room=0.0))

    def at(self, time: float) -> Floats:
        """Looks up the angles (n,) [rad] at a block time."""
        angles: Floats = self.motion.angles(np.array([time + self.motion.zero]))[0]
        if self.stray is None:
            return angles
        last = len(self.stray) - 1  # the last sample lies up to one period before the last key
        return np.asarray(angles + self.stray[min(round((time + self.motion.zero) * SCAN_RATE), last)])

    def samples(self) -> Floats:
        """Samples the angles (m, n) [rad] at `SCAN_RATE`, from the first key on."""
        angles = self.motion.angles(np.arange(0.0, self.motion.duration, 1.0 / SCAN_RATE))
        return angles if self.stray is None else np.asarray(angles + self.stray)

    def straying(self, trajectory: Trajectory) -> "PostureCourse":
        """Adds to the desired motion how far a trajectory is off it: a detour is then made where the robot will be."""
        times = np.arange(0.0, self.motion.duration, 1.0 / SCAN_RATE)
        performed = trajectory.angles(times - self.motion.zero + trajectory.zero)
        return replace(self, stray=sealed(performed - self.motion.angles(times)))

    def near(self, arm: ArmHinges, time: float) -> int | None:
        """Finds the key of an arm that is nearer to a block time than a detour may be; None when there is none."""
        keys = [k for k, posture in enumerate(self.postures) if posture.keyed[arm[0]]]
        nearest = min(keys, key=lambda k: abs(self.planned[k] - time))
        return nearest if abs(self.planned[nearest] - time) < LEAST_STEP else None

    def detours(self, time: float, arms: list[ArmHinges]) -> set[int]:
        """Finds the keys of some arms next to a block time, on both sides, that an earlier detour has added."""
        found = set[int]()
        for arm in arms:
            keys = [k for k, posture in enumerate(self.postures) if posture.keyed[arm[0]]]
            after = int(np.searchsorted(self.planned[keys], time))
            found |= {k for k in keys[max(after - 1, 0) : after + 1] if self._is_detour(k, list(arm))}
        return found

    def _is_detour(self, key: int, joints: list[int]) -> bool:
        """Whether no sync point falls on a key, nor on another one in the same posture."""
        here = self.postures[key].angles[joints]
        return not any(posture.syncs and np.array_equal(posture.angles[joints], here) for posture in self.postures)

    def moved(self, key: int, angles: Floats, arm: ArmHinges) -> "PostureCourse":
        """Moves an arm at a key, and wherever else the arm is in the same posture: holds stay holds."""
        joints, old = list(arm), self.postures[key].angles[list(arm)]
        there = np.zeros(len(angles), dtype=bool)
        there[joints] = True
        return replace(
            self,
            postures=tuple(
                replace(posture, angles=sealed(np.where(there, angles, posture.angles)))
                if posture.keyed[joints[0]] and np.array_equal(posture.angles[joints], old)
                else posture
                for posture in self.postures
            ),
        )

    def keyed_alike(self, arms: list[ArmHinges]) -> list[ArmHinges]:
        """Joins arms with the same keys, so that mirrored arms stay mirrored."""
        found: dict[tuple[bool, ...], ArmHinges] = {}
        for arm in arms:
            keys = tuple(posture.keyed[arm[0]] for posture in self.postures)
            found[keys] = (*found.get(keys, ()), *arm)
        return list(found.values())

    def calmed(self, time: float) -> "PostureCourse":
        """Takes swing and accent out of the keys of both arms about a block time; the same where there are none."""
        calm = set[tuple[int, int]]()
        for joints in (self.robot.arm(side).joints for side in SIDES):
            lively = [k for k, posture in enumerate(self.postures) if joints and _is_lively(posture, joints[0])]
            before, after = ([k for k in lively if (self.planned[k] <= time) == early] for early in (True, False))
            calm |= {(k, joint) for k in (*before[-1:], *after[:1]) for joint in joints}
        if not calm:
            return self
        return replace(
            self,
            postures=tuple(
                replace(posture, passages=_calmed(posture.passages, {j for key, j in calm if key == k}))
                for k, posture in enumerate(self.postures)
            ),
        )

    def extended(self, time: float, angles: Floats, arm: ArmHinges) -> "PostureCourse":
        """Adds a key at a block time, for the hinges of an arm, or of two that have the same keys."""
        own = [k for k, posture in enumerate(self.postures) if posture.keyed[arm[0]]]
        asked = float(np.interp(time, self.planned[own], [self.postures[k].time for k in own]))
        while asked in {posture.time for posture in self.postures}:
            asked += KEY_SPACING
        keyed = tuple(joint in arm for joint in range(len(angles)))
        k = sum(posture.time < asked for posture in self.postures)
        return replace(
            self,
            postures=(*self.postures[:k], KeyPosture(asked, sealed(angles), keyed), *self.postures[k:]),
            planned=sealed(np.insert(self.planned, k, time)),
        )


class ClearPostures:
    """Clear postures near others, each looked for once: most of a course stays as it is while it changes."""

    def __init__(self, robot: Robot, distances: Distances) -> None:
        """None is known yet.

        Args:
            robot: whose postures they are.
            distances: those of the robot from itself.
        """
        self.distances = distances
        self._robot = robot
        self._known: dict[tuple[bytes, ArmHinges, Spacing], Floats | None] = {}

    def near(self, angles: Floats, joints: ArmHinges, spacing: Spacing) -> Floats | None:
        """Finds the posture nearest to (n,) [rad] in which segments keep apart by the turns of some joints."""
        asked = angles.tobytes(), joints, spacing
        if asked not in self._known:
            self._known[asked] = separate(angles, joints, self._robot, self.distances, spacing)
        return self._known[asked]


def lead_around(
    course: PostureCourse, distances: Distances, *, least: float, known: ClearPostures | None = None
) -> PostureCourse:
    """Changes a course wherever its motion comes too near to the body.

    One stretch after the other. Arms that swing through their keys, or accent their ways, do so no more if that helps;
    else, of several changes, the one is taken that leaves least to be done: an arm that has no key near gets one, in
    the nearest posture that is clear, or in one nearer to rest; else its key moves away.

    Args:
        course: at least two keys, the first and the last at rest.
        distances: those of the robot from itself.
        least: [m] clearance that suffices.
        known: clear postures that were found before.

    Returns:
        The same where nothing needs to be done; not clear everywhere where nothing helps.
    """
    scan, hopeless = _Scan.of(course, distances, least), set[int]()
    room = known or ClearPostures(course.robot, distances)
    for _ in range(_most_changes(course.motion.duration)):
        open_stretches = [sample for sample in _closest(scan.lacking) if sample not in hopeless]
        if not open_stretches:
            break
        sample = open_stretches[0]
        time = sample / SCAN_RATE - course.motion.zero
        if (calm := course.calmed(time)) is not course:
            calm_scan = scan.after(calm, distances, least)
            if calm_scan.lacking.sum() < scan.lacking.sum():
                course, scan, hopeless = calm, calm_scan, calm_scan.same(hopeless, scan)
                continue
        best, best_scan, allowed, lacking = course, scan, GAIN * scan.lacking.sum(), scan.lacking.sum()
        for change in _changes(course, time, room, least):
            left = scan.after(change, distances, least)
            if left.lacking.sum() < allowed:
                best, best_scan, allowed = change, left, left.lacking.sum() - PLAINLY * (lacking - left.lacking.sum())
            if allowed <= 0.0:
                break
        if best is course:
            hopeless.add(sample)
        else:
            course, scan, hopeless = best, best_scan, best_scan.same(hopeless, scan)
    return course


@dataclass(frozen=True, eq=False)
class _Scan:
    """A course as samples."""

    angles: Floats  # (m, n) [rad]
    lacking: Floats  # (m,) [m] of the clearance

    @classmethod
    def of(cls, course: PostureCourse, distances: Distances, least: float) -> "_Scan":
        angles = course.samples()
        return cls(angles, np.maximum(least - distances.clearance(angles).distances, 0.0))

    def after(self, change: PostureCourse, distances: Distances, least: float) -> "_Scan":
        """Scans another course of the same length: only where it is another."""
        angles = change.samples()
        other = np.flatnonzero((angles != self.angles).any(axis=1))
        lacking = self.lacking.copy()
        lacking[other] = np.maximum(least - distances.clearance(angles[other]).distances, 0.0)
        return _Scan(angles, lacking)

    def same(self, samples: set[int], before: "_Scan") -> set[int]:
        """Keeps those of some samples that are as they were: what helped elsewhere does not help there."""
        return {k for k in samples if self.lacking[k] == before.lacking[k]}


def _most_changes(duration: float) -> int:
    """How many changes a motion of some seconds may have: more when it is longer, as far as that costs no more."""
    return max(STEPS, min(ceil(STEPS * duration / LONG), int(WORK / max(duration, LONG))))


def _closest(lacking: Floats) -> Iterator[int]:
    """Worst sample of every stretch that comes too near."""
    stretches = np.split(np.arange(len(lacking)), np.flatnonzero(np.diff(lacking > 0)) + 1)
    return (int(s[lacking[s].argmax()]) for s in stretches if lacking[s].max(initial=0.0) > 0)


def _changes(course: PostureCourse, time: float, room: ClearPostures, least: float) -> Iterator[PostureCourse]:
    """Tries changes at a block time where the motion comes too near."""
    gaps = room.distances.gaps(course.at(time)[None])[0]
    close = {segment for k in np.flatnonzero(gaps < least) for segment in course.robot.counted_pairs[k]}
    arms = [arm.joints for side in SIDES if close & (arm := course.robot.arm(side)).bodies]
    near = [course.near(arm, time) for arm in arms]
    free = [arm for arm, key in zip(arms, near, strict=True) if key is None]
    if free:
        yield from _with_a_key(course, time, free, room, least)
    for key in sorted({key for key in near if key is not None} or course.detours(time, arms)):
        yield from _with_a_key_away(course, key, arms, room, least)


def _with_a_key(
    course: PostureCourse, time: float, arms: list[ArmHinges], room: ClearPostures, least: float
) -> Iterator[PostureCourse]:
    """Adds a key for some arms: clear, and near to where they are or a part of the way to rest."""
    angles, joints = course.at(time), _joined(arms)
    for share in WITHDRAWALS:
        start = angles.copy()
        start[[*joints]] += share * (course.robot.skeleton.rest - angles)[[*joints]]
        clear = room.near(start, joints, Spacing(least, least + DETOUR_ROOM))
        if clear is not None:
            change = course
            for together in course.keyed_alike(arms):
                change = change.extended(time, clear, together)
            yield change


def _with_a_key_away(
    course: PostureCourse, key: int, arms: list[ArmHinges], room: ClearPostures, least: float
) -> Iterator[PostureCourse]:
    """Moves the keys of some arms farther away; rest stays rest."""
    posture, angles = course.postures[key], course.at(float(course.planned[key]))
    rest = course.robot.skeleton.rest
    keyed = [arm for arm in arms if posture.keyed[arm[0]] and np.any(posture.angles[list(arm)] != rest[list(arm)])]
    gap = float(room.distances.gaps(angles[None])[0].min())
    for more in AWAY if keyed else ():
        clear = room.near(angles, _joined(keyed), Spacing(max(gap, least) + more))
        if clear is not None:
            change = course
            for arm in keyed:
                change = change.moved(key, clear, arm)
            yield change


def _is_lively(posture: KeyPosture, joint: int) -> bool:
    """Whether a hinge swings through its key, or comes to it with an accent."""
    if not posture.passages or not posture.keyed[joint]:
        return False
    return posture.passages[joint] != posture.passages[joint].calm


def _calmed(passages: tuple[KeyPassage, ...], joints: set[int]) -> tuple[KeyPassage, ...]:
    return tuple(each.calm if k in joints else each for k, each in enumerate(passages))


def _joined(arms: list[ArmHinges]) -> ArmHinges:
    return tuple(joint for arm in arms for joint in arm)
