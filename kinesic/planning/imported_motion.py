"""Plans a motion that was made elsewhere: its samples become keys of a motion that the servos can follow."""

from time import perf_counter

import numpy as np
from numpy.typing import NDArray

from kinesic.bml.block import Block, Notice, NoticeType
from kinesic.bml.schedule import schedule
from kinesic.body.arrays import Flags, Floats, sealed
from kinesic.body.config import ConfigError
from kinesic.expressivity.keyframes import KeyFrames
from kinesic.motion.condition import Conditioned
from kinesic.motion.double_s import least_rest_times
from kinesic.motion.keys import KeyPosture
from kinesic.planning.bap import BapFrames
from kinesic.planning.clearance import keep_clear
from kinesic.planning.plan import Plan
from kinesic.planning.postures import Postures
from kinesic.planning.setup import Setup
from kinesic.planning.syncs import SHIFT_TO_WARN, Syncs

EVERY = 0.1  # [s] between keys: a motion that servos can follow is then met within about a degree
NEAR_TURN = 0.045  # [s] from where a hinge turns back, within which it has no other key
TREMBLE = 0.01  # [rad] of turning back that is none
COMFORT = 1.5  # times the least time, from rest to the first frame and from the last to rest
LEAST = 0.3  # [s] of these
BEYOND = 1e-4  # [rad] outside a range, and it is worth telling


def plan_imported(frames: BapFrames, setup: Setup, *, source: str) -> Plan:
    """Plans a motion from a file: from rest to its first frame, through it, and back to rest.

    Block time is the file's. The motion is passed at keys, every 0.1 s and where a hinge turns back, and smoothly
    between them; where the servos cannot follow, keys come later or earlier, and a notice says by how much.

    Args:
        frames: of the motion.
        setup: robot and physics.
        source: file name, for messages.

    Raises:
        ConfigError: the motion speaks of no hinge of the robot.
    """
    began = perf_counter()
    if not frames.given:
        raise ConfigError(f"{source}: sets no parameter that {setup.robot.name} has a hinge for")
    block = Block(id="motion", behaviours=(), source=source)
    timeline = schedule(block, {}, {})
    asked = Postures(_keys(frames, setup), {})
    solved, motion, times, clearance = keep_clear(asked, setup)
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
        asked=asked.postures,
    )


def _keys(frames: BapFrames, setup: Setup) -> tuple[KeyPosture, ...]:
    """Rest, samples of the motion, and rest again.

    Each hinge has keys where it turns back, and evenly elsewhere.
    """
    begin, end = float(frames.times[0]), float(frames.times[-1])
    even = np.linspace(begin, end, max(1, round((end - begin) / EVERY)) + 1) if end > begin else np.array([begin])
    turns = [frames.times[_turns(column)] for column in frames.angles.T]
    times = np.unique(np.concatenate([even, *turns]))
    sampled = np.stack([np.interp(times, frames.times, column) for column in frames.angles.T], axis=1)
    angles = setup.robot.skeleton.clamp(sampled)
    keyed = np.stack([_keyed(times, even, own) for own in turns], axis=1)
    rest = setup.robot.skeleton.rest
    there, back = (_way(setup, rest, posture) for posture in (angles[0], angles[-1]))
    whole = (True,) * len(rest)
    inner = [
        KeyPosture(time, sealed(posture), tuple(flags))
        for time, posture, flags in zip(times.tolist(), angles, keyed.tolist(), strict=True)
    ]
    return (KeyPosture(begin - there, rest, whole), *inner, KeyPosture(end + back, rest, whole))


def _turns(column: Floats) -> NDArray[np.intp]:
    """Indices of (m,) angles at which a hinge turns back by more than a tremble."""
    from scipy.signal import find_peaks  # noqa: PLC0415 - slow to import, and few motions are others'

    return np.sort(np.concatenate([find_peaks(sign * column, prominence=TREMBLE)[0] for sign in (1.0, -1.0)]))


def _keyed(times: Floats, even: Floats, turns: Floats) -> Flags:
    """(m,) whether one hinge has a key: at its turns, and at even times that are not near to one; at both ends."""
    near = np.abs(times[:, None] - turns).min(axis=1, initial=np.inf)
    keyed: Flags = (near == 0.0) | (np.isin(times, even) & (near >= NEAR_TURN))
    keyed[[0, -1]] = True
    return keyed


def _way(setup: Setup, start: Floats, end: Floats) -> float:
    """[s] at ease from one posture to another."""
    return max(LEAST, COMFORT * float(least_rest_times(end - start, setup.limits).max()))


def _notices(frames: BapFrames, motion: Conditioned, setup: Setup) -> tuple[Notice, ...]:
    """Warnings of parameters without a hinge, of ranges that are left, and of times that had to move."""
    found = []
    if frames.strangers:
        numbers = ", ".join(str(number) for number in frames.strangers)
        found.append(f"the robot has no hinge for the parameters {numbers}")
    skeleton = setup.robot.skeleton
    beyond = np.abs(frames.angles - skeleton.clamp(frames.angles)).max(axis=0)
    found += [
        f"{name} is asked for {np.degrees(beyond[k]):.1f} deg beyond its range; it stops at the range's end"
        for k, name in enumerate(skeleton.names)
        if beyond[k] > BEYOND
    ]
    shifts = motion.planned - motion.asked
    worst = int(np.abs(shifts[1:-1]).argmax()) + 1
    if abs(shifts[worst]) > SHIFT_TO_WARN:
        found.append(f"faster than the servos: what is at {motion.asked[worst]:.2f} s comes {shifts[worst]:+.2f} s off")
    return tuple(Notice(NoticeType.IMPOSSIBLE_TO_SCHEDULE, "motion", text) for text in found)
