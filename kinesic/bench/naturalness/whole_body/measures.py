"""Measures of whole-body motion in one gesture clip.

All lengths are in arm lengths of the body that moves, so that bodies of different size are comparable. Collar and neck
depend on the skeleton nevertheless: joints lie at other places in each.
"""

from collections.abc import Iterator
from dataclasses import dataclass, fields

import numpy as np

from kinesic.bench.naturalness.measures import (
    PROFILE_PERIOD,
    PROFILE_RATE,
    count_units,
    measure_hand,
)
from kinesic.bench.naturalness.whole_body.motion import BodyMotion, smooth_frames
from kinesic.body.arrays import Floats
from kinesic.metrics.smoothness import spectral_arc_length
from kinesic.studies.sweep.geometry import length

WINDOW_TIME = 2.7  # [s] length of windows cut from clips without sync points; the median gesture is as long
MIN_WINDOW_TIME = 1.4  # [s] shortest compared window of a clip
MIN_WINDOW_SPEED = 0.3  # [arm lengths/s] largest hand speed up to which a window contains no gesture
STILL_RATIO = 0.1  # hand speed / largest hand speed, below which a hand counts as still


@dataclass(frozen=True)
class WholeBodyMeasures:
    """Motion measures of hands, trunk, head and collar bones in one clip."""

    trunk: float  # [deg] largest rotation of the chest since the first frame
    trunk_speed: float  # [deg/s] largest rotation speed of the chest
    head: float  # [deg] largest rotation of the head since the first frame
    head_speed: float  # [deg/s] largest rotation speed of the head
    collar: float  # [arm lengths] largest displacement of a shoulder in the chest since the first frame
    free_arm: float  # path of the hand that moves less / path of the hand that moves more
    hand_turning: float  # [deg/s] largest rotation speed of the main hand in the chest
    wrist_range: float  # [deg] range of the angle between main hand and forearm
    elbow_range: float  # [deg] range of the main elbow
    largest_speed: float  # [arm lengths/s] largest speed of the main wrist
    path: float  # [arm lengths] path length of the main wrist relative to the chest
    path_metres: float  # [m] path length of the main wrist relative to the chest
    units_per_second: float  # [1/s] rate of movement units
    sparc: float  # spectral arc length of the main wrist's speed
    still: float  # fraction of the time with the main hand still
    stroke_speed: float | None  # [arm lengths/s] largest speed of the stroke; None: no sync points
    stroke_path: float | None  # [arm lengths] path of the stroke
    flow: float | None  # speed at strokeStart / largest speed before strokeEnd


MEASURE_NAMES = tuple(field.name for field in fields(WholeBodyMeasures))


def cut_clips(motion: BodyMotion) -> Iterator[BodyMotion]:
    """Yield a clip's whole gesture, or moving windows if `relax` is missing.

    A gesture includes its return: in three of five captured sets `relax` marks the end of the return, so a cut there
    would compare whole captured gestures with parts of others. Windows last `WINDOW_TIME`; those without motion are
    left out.
    """
    begin, end = motion.syncs["start"], motion.syncs["end"]
    if "relax" in motion.syncs:
        yield motion.clip(begin, end)
        return
    count = max(1, int((end - begin) / WINDOW_TIME))
    for k in range(count):
        last = begin + (k + 1) * WINDOW_TIME
        window = motion.clip(begin + k * WINDOW_TIME, min(last, end), f"{motion.name} {k}" if count > 1 else "")
        if (
            window.times[-1] - window.times[0] >= MIN_WINDOW_TIME
            and measure_whole_body(window).largest_speed > MIN_WINDOW_SPEED
        ):
            yield window


def measure_whole_body(motion: BodyMotion) -> WholeBodyMeasures:
    """Measure the motion of the whole body in one clip."""
    relative = [smooth_frames(wrist - motion.chest) for wrist in motion.wrists]
    paths = [length(path) for path in relative]
    main = int(np.argmax(paths))
    hand = measure_hand(motion.times, relative[main], motion.syncs, motion.arm)
    speeds = np.linalg.norm(np.gradient(relative[main], motion.times, axis=0), axis=1) / motion.arm
    in_chest = np.einsum("mji,mjk->mik", motion.chest_rotations, motion.hand_rotations[main])
    return WholeBodyMeasures(
        trunk=_largest_rotation(motion.chest_rotations),
        trunk_speed=_largest_rotation_speed(motion.chest_rotations),
        head=_largest_rotation(motion.head_rotations),
        head_speed=_largest_rotation_speed(motion.head_rotations),
        collar=_collar_displacement(motion),
        free_arm=paths[1 - main] / paths[main] if paths[main] > 0.0 else 0.0,
        hand_turning=_largest_rotation_speed(in_chest),
        wrist_range=float(np.ptp(_bend_angles(motion, main))),
        elbow_range=float(np.ptp(elbow_angles(motion)[main])),
        largest_speed=float(speeds.max()),
        path=paths[main] / motion.arm,
        path_metres=paths[main],
        units_per_second=count_units(speeds) / float(motion.times[-1] - motion.times[0]),
        sparc=spectral_arc_length(speeds, period=PROFILE_PERIOD) or 0.0,
        still=float((speeds < STILL_RATIO * speeds.max(initial=0.0)).mean()),
        stroke_speed=hand.stroke_speed,
        stroke_path=hand.stroke_path,
        flow=hand.flow,
    )


def elbow_angles(motion: BodyMotion) -> Floats:
    """Return the flexion (2, m) [deg] of both elbows."""
    upper, fore = motion.elbows - motion.shoulders, motion.wrists - motion.elbows
    cosines = (upper * fore).sum(-1) / (np.linalg.norm(upper, axis=-1) * np.linalg.norm(fore, axis=-1))
    flexion: Floats = np.degrees(np.arccos(np.clip(cosines, -1.0, 1.0)))
    return flexion


def rotation_angles(rotations: Floats) -> Floats:
    """Return the angles (m,) [deg] of rotation matrices (m, 3, 3)."""
    cosines = (np.trace(rotations, axis1=-2, axis2=-1) - 1.0) / 2.0
    sines = np.linalg.norm(
        [
            rotations[..., 2, 1] - rotations[..., 1, 2],
            rotations[..., 0, 2] - rotations[..., 2, 0],
            rotations[..., 1, 0] - rotations[..., 0, 1],
        ],
        axis=0,
    )
    angles: Floats = np.degrees(np.arctan2(sines / 2.0, cosines))
    return angles


def _largest_rotation(rotations: Floats) -> float:
    smoothed = _smooth_rotations(rotations)
    return float(rotation_angles(smoothed[0].T @ smoothed).max())


def _largest_rotation_speed(rotations: Floats) -> float:
    smoothed = _smooth_rotations(rotations)
    steps = np.einsum("mji,mjk->mik", smoothed[:-1], smoothed[1:])
    return float(rotation_angles(steps).max() * PROFILE_RATE)


def _smooth_rotations(rotations: Floats) -> Floats:
    """Smooth rotations (m, 3, 3) over neighbouring frames."""
    u, _, v = np.linalg.svd(smooth_frames(rotations))
    signs = np.ones((len(u), 3))
    signs[:, 2] = np.linalg.det(u @ v)
    projected: Floats = np.einsum("mij,mj,mjk->mik", u, signs, v)
    return projected


def _collar_displacement(motion: BodyMotion) -> float:
    displacements: list[float] = []
    for shoulder in motion.shoulders:
        in_chest = smooth_frames(np.einsum("mji,mj->mi", motion.chest_rotations, shoulder - motion.chest))
        displacements.append(float(np.linalg.norm(in_chest - in_chest[0], axis=1).max()))
    return max(displacements) / motion.arm


def _bend_angles(motion: BodyMotion, arm: int) -> Floats:
    """Return the angles (m,) [deg] between forearm and hand."""
    hand = motion.hand_rotations[arm] @ motion.hand_axes[arm]
    fore = motion.wrists[arm] - motion.elbows[arm]
    cosines = (hand * fore).sum(-1) / np.linalg.norm(fore, axis=-1)
    bends: Floats = smooth_frames(np.degrees(np.arccos(np.clip(cosines, -1.0, 1.0))))
    return bends
