"""Planning of imported motions: samples become keys of a motion within limits."""

from time import perf_counter

import numpy as np

from kinesic.bml.block import Block, Notice, NoticeType
from kinesic.bml.schedule import schedule
from kinesic.body.arrays import Flags, Floats, Indices, sealed
from kinesic.body.config import ConfigError
from kinesic.expressivity.keyframes import KeyFrames
from kinesic.motion.condition import Conditioned
from kinesic.motion.double_s import least_rest_times
from kinesic.motion.keys import KeyPosture
from kinesic.planning.clearance import keep_clear
from kinesic.planning.files.bap import BapFrames
from kinesic.planning.plan import Plan
from kinesic.planning.postures import Postures
from kinesic.planning.setup import Setup
from kinesic.planning.syncs import SHIFT_TO_WARN, Syncs

KEY_INTERVAL = 0.1  # [s] interval between keys, short enough to reproduce motions within about 1 degree
REVERSAL_MARGIN = 0.045  # [s] time before and after a reversal without further keys of the hinge
REVERSAL_PROMINENCE = 0.01  # [rad] rotation below which a reversal counts as noise
COMFORT_FACTOR = 1.5  # duration of approach and return / minimum rest-to-rest time
MIN_APPROACH_TIME = 0.3  # [s] shortest approach from rest, and shortest return
RANGE_TOLERANCE = 1e-4  # [rad] excess over a joint range that needs no notice


def plan_imported(frames: BapFrames, setup: Setup, *, source: str) -> Plan:
    """Plan a motion from a file, starting and ending at rest.

    Block time is that of the file. Keys are placed every 0.1 s and at reversals. If the servos cannot follow, keys move
    in time, and a notice names the shift.

    Args:
        frames: of the motion.
        setup: robot and limits.
        source: file name, for messages.

    Raises:
        ConfigError: the motion has no hinge of the robot.
    """
    began = perf_counter()
    if not frames.given:
        raise ConfigError(f"{source}: none of its parameters moves a hinge of {setup.robot.name}")
    block = Block(id="motion", behaviours=(), source=source)
    timeline = schedule(block, {}, {})
    requested = Postures(_keys(frames, setup), {})
    solved, motion, times, clearance = keep_clear(requested, setup)
    return Plan(
        setup=setup,
        timeline=timeline,
        utterances={},
        keyframes=KeyFrames(timeline, (), {}),
        postures=solved,
        motion=motion,
        clearance=clearance,
        clearance_times=times,
        syncs=Syncs(),
        notices=_notices(frames, motion, setup),
        seconds=perf_counter() - began,
        requested_postures=requested.postures,
    )


def _keys(frames: BapFrames, setup: Setup) -> tuple[KeyPosture, ...]:
    """Return key postures from rest through the samples and back to rest.

    Each hinge has keys at its reversals, and evenly elsewhere.
    """
    begin, end = float(frames.times[0]), float(frames.times[-1])
    even_times = (
        np.linspace(begin, end, max(1, round((end - begin) / KEY_INTERVAL)) + 1) if end > begin else np.array([begin])
    )
    reversals = [frames.times[_find_reversals(column)] for column in frames.angles.T]
    times = np.unique(np.concatenate([even_times, *reversals]))
    sampled = np.stack([np.interp(times, frames.times, column) for column in frames.angles.T], axis=1)
    angles = setup.robot.skeleton.clamp(sampled)
    keyed = np.stack([_flag_keys(times, even_times, times_of_hinge) for times_of_hinge in reversals], axis=1)
    rest = setup.robot.skeleton.rest
    approach_time, return_time = (
        compute_comfortable_duration(setup, rest, posture) for posture in (angles[0], angles[-1])
    )
    all_hinges = (True,) * len(rest)
    inner = [
        KeyPosture(time, sealed(posture), tuple(flags))
        for time, posture, flags in zip(times.tolist(), angles, keyed.tolist(), strict=True)
    ]
    return (
        KeyPosture(begin - approach_time, rest, all_hinges),
        *inner,
        KeyPosture(end + return_time, rest, all_hinges),
    )


def _find_reversals(column: Floats) -> Indices:
    """Return the indices of reversals in angles (m,), ignoring noise.

    Successive reversals differ by more than noise. The middle of a pause counts, and the first of several equal peaks
    that noise separates.
    """
    starts = np.flatnonzero(np.diff(column, prepend=np.nan))
    middles = (starts + np.append(starts[1:], len(column)) - 1) // 2
    rises = np.diff(column[starts]) > 0.0
    extremes = np.flatnonzero(np.diff(rises, prepend=~rises[:1], append=~rises[-1:]))
    angles = column[starts[extremes]].tolist()
    chosen: list[int] = []
    lowest = highest = direction = 0
    for k, angle in enumerate(angles):
        if angle > angles[highest]:
            highest = k
        elif angle < angles[lowest]:
            lowest = k
        if direction >= 0 and angles[highest] - angle >= REVERSAL_PROMINENCE:
            chosen += [highest] * direction
            direction, lowest = -1, k
        elif direction <= 0 and angle - angles[lowest] >= REVERSAL_PROMINENCE:
            chosen += [lowest] * -direction
            direction, highest = 1, k
    reversals: Indices = middles[extremes[chosen]]
    return reversals


def _flag_keys(times: Floats, even_times: Floats, reversals: Floats) -> Flags:
    """Flag the samples (m,) that become keys of a hinge.

    It has keys at its reversals, at even times away from these, and at both ends.
    """
    near = np.abs(times[:, None] - reversals).min(axis=1, initial=np.inf)
    keyed: Flags = (near == 0.0) | (np.isin(times, even_times) & (near >= REVERSAL_MARGIN))
    keyed[[0, -1]] = True
    return keyed


def compute_comfortable_duration(setup: Setup, start: Floats, end: Floats) -> float:
    """Return a comfortable duration [s] for a movement between two postures."""
    return max(MIN_APPROACH_TIME, COMFORT_FACTOR * float(least_rest_times(end - start, setup.limits).max()))


def _notices(frames: BapFrames, motion: Conditioned, setup: Setup) -> tuple[Notice, ...]:
    """Return notices about unknown parameters, exceeded joint ranges and shifted times."""
    texts = []
    if frames.strangers:
        numbers = ", ".join(str(number) for number in frames.strangers)
        texts.append(f"the robot has no hinge for the parameters {numbers}")
    skeleton = setup.robot.skeleton
    excess = np.abs(frames.angles - skeleton.clamp(frames.angles)).max(axis=0)
    texts += [
        f"{name} is requested {np.degrees(excess[k]):.1f} deg beyond its range and stops at its end"
        for k, name in enumerate(skeleton.names)
        if excess[k] > RANGE_TOLERANCE
    ]
    shifts = motion.planned - motion.requested_times
    worst = int(np.abs(shifts[1:-1]).argmax()) + 1
    if abs(shifts[worst]) > SHIFT_TO_WARN:
        time, shift = motion.requested_times[worst], shifts[worst]
        texts.append(f"faster than the servos: the posture of {time:.2f} s is shifted by {shift:+.2f} s")
    return tuple(Notice(NoticeType.IMPOSSIBLE_TO_SCHEDULE, "motion", text) for text in texts)
