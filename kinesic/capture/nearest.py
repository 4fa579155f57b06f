"""Nearest motion to a desired one within kinematic and duty limits."""

from dataclasses import dataclass
from functools import partial

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.ndimage import gaussian_filter1d, maximum_filter1d

from kinesic.body.arrays import Floats, sealed
from kinesic.body.limits import Limits
from kinesic.body.robot import Robot
from kinesic.capture.derivatives import compute_time_stretch
from kinesic.capture.robot_motion import SAMPLE_RATE, arm_paths
from kinesic.motion.condition import Conditioned, MakeDesired, condition
from kinesic.motion.desired import DesiredMotion
from kinesic.motion.easing import minimum_jerk
from kinesic.motion.keys import KeyPosture, Keys
from kinesic.motion.piecewise import QuinticSpline
from kinesic.planning.certify import keep_duties
from kinesic.planning.files.imported_motion import compute_comfortable_duration
from kinesic.planning.setup import Setup

PATH_KEY_INTERVAL = 0.1  # [s] interval between key postures that guide the path
MAX_WRIST_DISTANCE = 0.05  # [arm lengths] wrist distance from the desired path above which time is stretched
MAX_TIME_RATIO = 4.0  # upper bound on the required time ratio, before its smoothing
RATIO_WINDOW = 0.2  # [s] window of the maximum filter on required time ratios
RATIO_SMOOTHING = 0.05  # [s] standard deviation of the Gaussian filter on the stretch
STRETCH_AMOUNTS = (0.5, 1.0, 2.0, 4.0)  # amounts of stretch tried, as multiples of the missing time
BISECTION_STEPS = 3  # number of bisection steps that reduce the stretch amount
MAX_FIRST_RATIO = 0.95  # wrist distance with / without the smallest stretch, above which time is not stretched
MAX_LAST_RATIO = 0.7  # wrist distance with / without the largest stretch, above which time is not stretched
REST_TOLERANCE = 2e-3  # [rad] largest hinge deviation from rest at which a clip begins or ends at rest


@dataclass(frozen=True, eq=False)
class Course:
    """Desired angles at `SAMPLE_RATE`: approach from rest, clip, return to rest."""

    angles: Floats  # (m, n) [rad] within the joint ranges
    first: int  # index of the clip's first sample
    last: int  # index of the clip's last sample

    @property
    def clip(self) -> Floats:
        """Angles of the clip (k, n) [rad]."""
        return self.angles[self.first : self.last + 1]

    @classmethod
    def of(cls, angles: Floats, setup: Setup) -> "Course":
        """Add movements from and to rest around a clip's angles (k, n).

        An end of the clip that is at rest gets no movement.
        """
        rest = setup.robot.skeleton.rest
        lead, trail = (_approach_time(setup, rest, posture) for posture in (angles[0], angles[-1]))
        parts = [_ease(rest, angles[0], lead), angles, _ease(rest, angles[-1], trail)[::-1]]
        course = np.concatenate(parts)
        course[[0, -1]] = rest
        first = len(parts[0])
        return cls(sealed(course), first, first + len(angles) - 1)


@dataclass(frozen=True, eq=False)
class NearestMotion:
    """Motion within kinematic and duty limits, with the clip's performance times."""

    motion: Conditioned
    keys: tuple[KeyPosture, ...]  # key postures at requested times, from rest to rest
    clip_times: Floats  # (m,) [s] performance times of the desired samples
    stretch: Floats  # (m,) local time stretch that was requested, 1 without

    @property
    def angles(self) -> Floats:
        """Joint angles (m, n) [rad] at the times of the clip's samples."""
        return self.motion.trajectory.angles(self.clip_times)

    @property
    def total_stretch(self) -> float:
        """Duration of the clip in the motion / its original duration."""
        return float((self.clip_times[-1] - self.clip_times[0]) * SAMPLE_RATE / (len(self.clip_times) - 1))


def find_nearest(course: Course, setup: Setup, stretch: Floats | None = None) -> NearestMotion:
    """Return the nearest motion within kinematic and duty limits.

    Position, velocity, acceleration, jerk and duty limits hold at every instant. Time is stretched only where the
    limits keep a wrist more than `MAX_WRIST_DISTANCE` from its path.

    Args:
        course: desired angles, from rest to rest.
        setup: robot, limits and dynamics.
        stretch: (m,) local time stretch; searched by default.
    """
    trial = _search_stretch(course, setup) if stretch is None else _try_stretch(course, stretch, setup)

    def search(limits: Limits) -> Conditioned:
        return trial.nearest.motion if limits is setup.limits else trial.request.search(limits)

    return trial.request.match(keep_duties(search, setup))


def _search_stretch(course: Course, setup: Setup) -> "_Trial":
    """Search the local time stretch that brings wrists near their paths.

    It is 1 where no stretch is needed, or none helps enough.
    """
    unstretched = _try_stretch(course, np.ones(len(course.clip)), setup)
    distance = unstretched.measure_distance(course, setup)
    if distance <= MAX_WRIST_DISTANCE:
        return unstretched
    ratios = np.minimum(compute_time_stretch(course.clip, setup.limits), MAX_TIME_RATIO)
    widest = maximum_filter1d(ratios, max(1, round(RATIO_WINDOW * SAMPLE_RATE)))
    excess = gaussian_filter1d(widest, RATIO_SMOOTHING * SAMPLE_RATE) - 1.0
    lower, upper = 0.0, 0.0
    for amount in STRETCH_AMOUNTS:
        lower, upper = upper, amount
        best = _try_stretch(course, _stretch_by(amount, excess), setup)
        reached = best.measure_distance(course, setup)
        if lower == 0.0 and reached > MAX_FIRST_RATIO * distance:
            return unstretched
        if reached <= MAX_WRIST_DISTANCE:
            break
    else:
        return unstretched if reached > MAX_LAST_RATIO * distance else best
    for _ in range(BISECTION_STEPS):
        middle = (lower + upper) / 2.0
        trial = _try_stretch(course, _stretch_by(middle, excess), setup)
        if trial.measure_distance(course, setup) > MAX_WRIST_DISTANCE:
            lower = middle
        else:
            upper, best = middle, trial
    return best


def _stretch_by(amount: float, excess: Floats) -> Floats:
    """Return the local time stretch (m,): 1 + amount x excess."""
    stretch: Floats = 1.0 + amount * excess
    return stretch


def largest_wrist_distance(robot: Robot, first: Floats, second: Floats) -> float:
    """Return the largest wrist distance [arm lengths] between motions (m, n)."""
    paths = zip(arm_paths(robot, first).values(), arm_paths(robot, second).values(), strict=True)
    return max(float(np.linalg.norm(a.wrist - b.wrist, axis=1).max()) for a, b in paths)


@dataclass(frozen=True, eq=False)
class _Request:
    """Keys and sampled desired motion at a given time stretch."""

    keys: tuple[KeyPosture, ...]
    times: Floats  # (m,) [s] requested times of the desired samples
    stretch: Floats  # (m,)
    make_desired: MakeDesired

    def search(self, limits: Limits) -> Conditioned:
        """Return the nearest motion within the given limits."""
        return condition(self.keys, limits, make_desired=self.make_desired)

    def match(self, motion: Conditioned) -> NearestMotion:
        """Add the performance times of the desired samples to a motion."""
        planned = np.interp(self.times, motion.requested_times, motion.planned)
        return NearestMotion(motion, self.keys, sealed(planned + motion.trajectory.zero), sealed(self.stretch))


@dataclass(frozen=True, eq=False)
class _Trial:
    """Nearest motion within limits for one local time stretch of a clip."""

    request: _Request
    nearest: NearestMotion

    def measure_distance(self, course: Course, setup: Setup) -> float:
        """Return the largest wrist distance [arm lengths] from a course."""
        return largest_wrist_distance(setup.robot, course.clip, self.nearest.angles)


def _try_stretch(course: Course, stretch: Floats, setup: Setup) -> _Trial:
    request = _request(course, stretch, setup)
    return _Trial(request, request.match(request.search(setup.limits)))


def _request(course: Course, stretch: Floats, setup: Setup) -> _Request:
    """Make keys and desired motion from rest through clip to rest.

    Only rest, the first and the last posture are exact keys. Further keys keep the path without binding it.
    """
    rest = setup.robot.skeleton.rest
    times = np.concatenate([[0.0], np.cumsum((stretch[1:] + stretch[:-1]) / 2.0)]) / SAMPLE_RATE
    lead, trail = course.first / SAMPLE_RATE, (len(course.angles) - 1 - course.last) / SAMPLE_RATE
    end = float(times[-1])
    count = max(1, round(end / PATH_KEY_INTERVAL))
    all_hinges = (True,) * len(rest)
    curve = CubicSpline(times, course.clip)
    keys = [
        KeyPosture(float(time), sealed(curve(time)), all_hinges, is_exact=k in (0, count))
        for k, time in enumerate(end * np.arange(count + 1) / count)
    ]
    if lead > 0.0:
        keys.insert(0, KeyPosture(-lead, rest, all_hinges))
    if trail > 0.0:
        keys.append(KeyPosture(end + trail, rest, all_hinges))
    course_times = np.concatenate(
        [
            np.arange(-course.first, 0) / SAMPLE_RATE,
            times,
            end + np.arange(1, len(course.angles) - course.last) / SAMPLE_RATE,
        ]
    )
    make_desired = partial(_warp, course_times=course_times, course=course.angles)
    return _Request(tuple(keys), times, stretch, make_desired)


def _approach_time(setup: Setup, rest: Floats, posture: Floats) -> float:
    """Return the duration [s] of a movement from rest to a posture.

    It is zero for a posture within `REST_TOLERANCE` of rest.
    """
    if float(np.abs(posture - rest).max()) < REST_TOLERANCE:
        return 0.0
    return compute_comfortable_duration(setup, rest, posture)


def _ease(start: Floats, end: Floats, duration: float) -> Floats:
    """Return minimum-jerk samples between two postures, without the last sample."""
    count = round(duration * SAMPLE_RATE)
    fractions = minimum_jerk(np.arange(count) / max(count, 1))
    samples: Floats = start + fractions[:, None] * (end - start)
    return samples


def _warp(times: Floats, keys: Keys, *, course_times: Floats, course: Floats) -> DesiredMotion:
    """Return the desired motion, warped to key times (m,) [s]."""
    performance = np.interp(course_times, keys.requested_times, times) - times[0]
    curve = CubicSpline(performance, course, bc_type="clamped")
    states = sealed([course, curve(performance, 1), curve(performance, 2)])
    hinges = tuple(range(course.shape[1]))
    return DesiredMotion({hinges: QuinticSpline(sealed(performance), states)}, -float(times[0]))
