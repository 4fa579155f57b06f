"""Arm postures that follow captured wrist and elbow paths."""

import numpy as np

from kinesic.body.arrays import Flags, Floats, find_runs
from kinesic.body.chain import Chain
from kinesic.capture.clip import ArmPath
from kinesic.capture.resampling import low_pass
from kinesic.capture.robot_motion import SAMPLE_RATE
from kinesic.ik.arm.swivel import measure_swivels
from kinesic.ik.solve import solve_path

SWIVEL_CUTOFF = 3.0  # [Hz] cut-off frequency of the elbow's swivel, which is noisy on straight arms
MIN_ELBOW_OFFSET = 0.04  # [arm lengths] elbow distance from the shoulder-wrist line below which swivel is undefined
SETTLING_STEPS = 20  # number of repeated solutions of the first target, starting at rest
MAX_STEP = 0.35  # [rad] hinge rotation between successive samples above which the motion counts as a leap
BRIDGE_TIME = 0.08  # [s] interval before and after a leap in which angles are interpolated


def track_arm(chain: Chain, path: ArmPath, length: float) -> tuple[Floats, int]:
    """Compute arm angles (m, k) [rad] along a path, and count leaps.

    The path is solved forward and backward in time. The solution with fewer leaps is taken, and the leaps that remain
    are bridged by a smooth rotation of all hinges.

    Args:
        chain: the arm.
        path: (m, 3) elbows and wrists [arm lengths].
        length: [m] of the arm.
    """
    shoulder = chain.frames(chain.rest)[1][-4]
    targets = shoulder + length * path.wrist
    swivels = low_pass(find_swivels(chain, path)[:, None], SWIVEL_CUTOFF)[:, 0]
    forward = _solve_all(chain, targets, swivels)
    if not find_leaps(forward).any():
        return forward, 0
    backward = _solve_all(chain, targets[::-1], swivels[::-1])[::-1]
    angles = min((forward, backward), key=lambda solution: int(find_leaps(solution).sum()))
    return bridge_leaps(angles)


def find_swivels(chain: Chain, path: ArmPath) -> Floats:
    """Return the swivel (m,) [rad] of each frame, continuous over time.

    Straight arms take the swivel of the frames before and after; an arm that is always straight gets 0.
    """
    swivels = np.full(len(path.wrist), np.nan)
    lines = path.wrist / np.maximum(np.linalg.norm(path.wrist, axis=1, keepdims=True), 1e-9)
    is_bent = np.linalg.norm(np.cross(path.elbow, lines), axis=1) > MIN_ELBOW_OFFSET
    swivels[is_bent] = measure_swivels(chain, path.elbow[is_bent], path.wrist[is_bent])
    is_known = np.isfinite(swivels)
    if not is_known.any():
        return np.zeros(len(swivels))
    frames = np.arange(len(swivels))
    continuous: Floats = np.interp(frames, frames[is_known], np.unwrap(swivels[is_known]))
    return continuous


def find_leaps(angles: Floats) -> Flags:
    """Return whether any hinge leaps between successive samples, (m - 1,)."""
    leaps: Flags = np.abs(np.diff(angles, axis=0)).max(axis=1) > MAX_STEP
    return leaps


def bridge_leaps(angles: Floats) -> tuple[Floats, int]:
    """Bridge leaps of angles (m, k) smoothly, and count the bridges.

    The samples up to `BRIDGE_TIME` before and after a leap are interpolated between both sides.
    """
    margin = round(BRIDGE_TIME * SAMPLE_RATE)
    is_bridged = np.zeros(len(angles), dtype=np.bool_)
    for k in np.flatnonzero(find_leaps(angles)):
        is_bridged[max(0, k - margin) : k + 2 + margin] = True
    return interpolate_runs(angles, is_bridged), len(find_runs(is_bridged))


def interpolate_runs(angles: Floats, is_replaced: Flags) -> Floats:
    """Replace runs of samples (m, k) by smooth rotations between their neighbours.

    A run at an end of the motion takes the angles of its only neighbour.
    """
    bridged = angles.copy()
    for begin, end in find_runs(is_replaced):
        before, after = angles[max(0, begin - 1)], angles[min(len(angles) - 1, end)]
        if begin == 0:
            before = after
        elif end == len(angles):
            after = before
        u = (np.arange(begin, end) - begin + 1.0)[:, None] / (end - begin + 1.0)
        bridged[begin:end] = before + (after - before) * (u**3 * (10.0 - 15.0 * u + 6.0 * u**2))
    return bridged


def _solve_all(chain: Chain, targets: Floats, swivels: Floats) -> Floats:
    turns = np.remainder(swivels + np.pi, 2.0 * np.pi) - np.pi
    return solve_path(chain, targets, turns, start=chain.rest, settling=SETTLING_STEPS)
