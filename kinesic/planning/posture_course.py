"""Key postures with planned times, and edits of them."""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.limits import Limits
from kinesic.body.robot import Robot
from kinesic.motion.desired import DesiredMotion, join_keys
from kinesic.motion.keys import KeyPassage, KeyPosture, Keys
from kinesic.motion.trajectory import Trajectory

ArmHinges = tuple[int, ...]  # joints of an arm

SCAN_RATE = 100  # [Hz] sampling rate of the clearance check
MIN_KEY_INTERVAL = 0.06  # [s] smallest time between a detour's key and other keys of the same arm
KEY_SPACING = 1e-4  # [s] delay of a new key at the requested time of another key


@dataclass(frozen=True, eq=False)
class PostureCourse:
    """Key postures with planned times, as input of detours."""

    postures: tuple[KeyPosture, ...]  # in the order of their times
    planned: Floats  # (k,) [s] block time
    robot: Robot
    limits: Limits
    stray: Floats | None = None  # (m, n) [rad] at `SCAN_RATE`: deviation of the actual from the desired motion

    @cached_property
    def motion(self) -> DesiredMotion:
        """Desired motion through the keys at their planned times.

        Block time 0 is at time `motion.zero` [s] of it.
        """
        return join_keys(self.planned, Keys.of(self.postures, self.limits, margin=0.0))

    def at(self, time: float) -> Floats:
        """Return the angles (n,) [rad] at a block time."""
        angles: Floats = self.motion.angles(np.array([time + self.motion.zero]))[0]
        if self.stray is None:
            return angles
        last = len(self.stray) - 1  # the last sample lies up to one period before the last key
        return np.asarray(angles + self.stray[min(round((time + self.motion.zero) * SCAN_RATE), last)])

    def samples(self) -> Floats:
        """Sample the joint angles (m, n) [rad] at `SCAN_RATE`."""
        angles = self.motion.angles(np.arange(0.0, self.motion.duration, 1.0 / SCAN_RATE))
        return angles if self.stray is None else np.asarray(angles + self.stray)

    def with_deviation(self, trajectory: Trajectory) -> "PostureCourse":
        """Return the course with a trajectory's deviation from the desired motion added.

        Detours then start from the actual motion.
        """
        times = np.arange(0.0, self.motion.duration, 1.0 / SCAN_RATE)
        performed = trajectory.angles(times - self.motion.zero + trajectory.zero)
        return replace(self, stray=sealed(performed - self.motion.angles(times)))

    def near(self, arm: ArmHinges, time: float) -> int | None:
        """Return an arm's key index near a block time, or None.

        It is the nearest key, if less than `MIN_KEY_INTERVAL` away.
        """
        keys = [k for k, posture in enumerate(self.postures) if posture.keyed[arm[0]]]
        nearest = min(keys, key=lambda k: abs(self.planned[k] - time))
        return nearest if abs(self.planned[nearest] - time) < MIN_KEY_INTERVAL else None

    def detours(self, time: float, arms: list[ArmHinges]) -> set[int]:
        """Return the arms' detour keys directly before and after a time."""
        return {k for arm in arms for k in self._neighbours(time, arm) if self._is_detour(k, list(arm))}

    def colliding_keys(self, time: float, arms: list[ArmHinges], deficits: Floats, *, min_deficit: float) -> set[int]:
        """Return the arms' colliding keys directly before and after a time.

        Args:
            time: block time [s].
            arms: joints of the arms.
            deficits: (m,) [m] missing clearance of the samples.
            min_deficit: [m] keys with at most this missing clearance do not count as colliding.
        """
        last = len(deficits) - 1
        samples = np.minimum(np.round((self.planned + self.motion.zero) * SCAN_RATE).astype(int), last)
        return {k for arm in arms for k in self._neighbours(time, arm) if deficits[samples[k]] > min_deficit}

    def _neighbours(self, time: float, arm: ArmHinges) -> list[int]:
        """Return indices of an arm's keys directly before and after a time."""
        keys = [k for k, posture in enumerate(self.postures) if posture.keyed[arm[0]]]
        after = int(np.searchsorted(self.planned[keys], time))
        return keys[max(after - 1, 0) : after + 1]

    def _is_detour(self, key: int, joints: list[int]) -> bool:
        """Return whether an arm's posture at a key comes from a detour.

        It does if the arm has another posture at all keys with sync points.
        """
        here = self.postures[key].angles[joints]
        return not any(posture.syncs and np.array_equal(posture.angles[joints], here) for posture in self.postures)

    def moved(self, key: int, angles: Floats, arm: ArmHinges) -> "PostureCourse":
        """Return the course with an arm's posture at a key replaced.

        All keys of the arm with the same posture change, so that holds remain holds.
        """
        joints, old = list(arm), self.postures[key].angles[list(arm)]
        is_arm = np.zeros(len(angles), dtype=bool)
        is_arm[joints] = True
        return replace(
            self,
            postures=tuple(
                replace(posture, angles=sealed(np.where(is_arm, angles, posture.angles)))
                if posture.keyed[joints[0]] and np.array_equal(posture.angles[joints], old)
                else posture
                for posture in self.postures
            ),
        )

    def group_by_key_times(self, arms: list[ArmHinges]) -> list[ArmHinges]:
        """Group arms with equal key times, so that detours move them together."""
        matches: dict[tuple[bool, ...], ArmHinges] = {}
        for arm in arms:
            keys = tuple(posture.keyed[arm[0]] for posture in self.postures)
            matches[keys] = (*matches.get(keys, ()), *arm)
        return list(matches.values())

    def reduce_overshoot(self, time: float, swing_ratio: float = 0.0) -> "PostureCourse":
        """Return the course with less overshoot and accents around a block time.

        Of each arm's keys with overshoot or an accent, the last one before and the first one after the time change.
        The course itself is returned if there are none.

        Args:
            time: block time [s].
            swing_ratio: remaining fraction of the overshoot; accents are removed only if it is 0.
        """
        calm_keys = set[tuple[int, int]]()
        for joints in (self.robot.arm(side).joints for side in self.robot.sides):
            lively_keys = [k for k, posture in enumerate(self.postures) if joints and _is_lively(posture, joints[0])]
            before, after = ([k for k in lively_keys if (self.planned[k] <= time) == early] for early in (True, False))
            calm_keys |= {(k, joint) for k in (*before[-1:], *after[:1]) for joint in joints}
        if not calm_keys:
            return self
        return replace(
            self,
            postures=tuple(
                replace(
                    posture,
                    passages=_reduce_overshoot(posture.passages, {j for key, j in calm_keys if key == k}, swing_ratio),
                )
                for k, posture in enumerate(self.postures)
            ),
        )

    def extended(self, time: float, angles: Floats, arm: ArmHinges) -> "PostureCourse":
        """Return the course with an additional key of one or two arms.

        Two arms must have equal key times.

        Args:
            time: block time of the key.
            angles: (n,) [rad].
            arm: joints of the arms.
        """
        rows = [k for k, posture in enumerate(self.postures) if posture.keyed[arm[0]]]
        requested = float(np.interp(time, self.planned[rows], [self.postures[k].time for k in rows]))
        while requested in {posture.time for posture in self.postures}:
            requested += KEY_SPACING
        keyed = tuple(joint in arm for joint in range(len(angles)))
        k = sum(posture.time < requested for posture in self.postures)
        return replace(
            self,
            postures=(*self.postures[:k], KeyPosture(requested, sealed(angles), keyed), *self.postures[k:]),
            planned=sealed(np.insert(self.planned, k, time)),
        )


def _is_lively(posture: KeyPosture, joint: int) -> bool:
    """Return whether a hinge has an overshoot or accent at a key."""
    if not posture.passages or not posture.keyed[joint]:
        return False
    return posture.passages[joint] != posture.passages[joint].without_accent


def _reduce_overshoot(passages: tuple[KeyPassage, ...], joints: set[int], swing_ratio: float) -> tuple[KeyPassage, ...]:
    return tuple(
        passage
        if k not in joints
        else replace(passage, swing=swing_ratio * passage.swing)
        if swing_ratio > 0.0
        else passage.without_accent
        for k, passage in enumerate(passages)
    )
