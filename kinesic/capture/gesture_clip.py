"""Conversion of captured clips to gesture motions, independent of actor and robot."""

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.robot import SIDES, Robot, Side
from kinesic.capture.arm_tracking import find_swivels
from kinesic.capture.clip import ArmPath, BodyClip
from kinesic.capture.reading.text import CaptureError
from kinesic.capture.resampling import low_pass, resample, resample_times, smooth_paths
from kinesic.capture.retarget import unwrap_vectors
from kinesic.expressivity.lexicon.gesture_motion import MAX_SAMPLES, GestureMotion, HandMotion

SAMPLE_STRIDE = 2  # number of 100 Hz samples per stored sample: 50 Hz keeps motion below the filter's 6 Hz
MAX_DURATION = MAX_SAMPLES * SAMPLE_STRIDE / 100.0  # [s] longest clip that becomes a gesture
SWIVEL_CUTOFF = 3.0  # [Hz] cut-off frequency of the elbow's swivel, which is noisy on straight arms


def gesture_motion(clip: BodyClip, robot: Robot, source: str) -> GestureMotion:
    """Convert a clip to the motion of a gesture.

    Positions are measured from the midline at the height of the hanging elbows, in arm lengths of the actor.

    Args:
        clip: captured motion of a body.
        robot: defines the elbow swivel.
        source: name of the file, for messages.

    Raises:
        CaptureError: the clip is too long.
    """
    if clip.times[-1] > MAX_DURATION:
        raise CaptureError(f"{source}: it lasts {clip.times[-1]:.0f} s; a gesture lasts at most {MAX_DURATION:.0f} s")
    times = resample_times(clip.times)
    trunk = np.zeros((len(clip.times), 3)) if clip.trunk is None else clip.trunk
    return GestureMotion(
        times=sealed(times[::SAMPLE_STRIDE]),
        hands={side: _hand_motion(clip, side, robot, times) for side in SIDES},
        head=_smooth(clip.times, unwrap_vectors(clip.head), times),
        trunk=_smooth(clip.times, unwrap_vectors(trunk), times),
    )


def _hand_motion(clip: BodyClip, side: Side, robot: Robot, times: Floats) -> HandMotion:
    arm, hand = clip.arms[side], clip.hands.get(side)
    outward = np.array([1.0, 1.0 if side == "l" else -1.0, 1.0])
    elbow, wrist = smooth_paths(clip.times, (arm.elbow, arm.wrist), times)
    swivels = low_pass(find_swivels(robot.arms[side], ArmPath(elbow, wrist))[:, None], SWIVEL_CUTOFF)[:, 0]
    position = outward * wrist + [0.0, clip.half_width, clip.upper_arm]
    pointing, palm, straight = None, None, None
    if hand is not None:
        pointing, palm = (
            _normalise(outward * _smooth(clip.times, vectors, times)) for vectors in (hand.pointing, hand.palm)
        )
        straight = sealed(np.clip(_smooth(clip.times, hand.straight, times), 0.0, 1.0))
    return HandMotion(
        wrist=sealed(position[::SAMPLE_STRIDE]),
        swivel=sealed(np.remainder(swivels[::SAMPLE_STRIDE] + np.pi, 2.0 * np.pi) - np.pi),
        pointing=pointing,
        palm=palm,
        straight=straight,
    )


def _smooth(clip_times: Floats, values: Floats, times: Floats) -> Floats:
    """Return low-pass filtered samples (k, n) at the rate of gesture motions."""
    return sealed(low_pass(resample(clip_times, values, times))[::SAMPLE_STRIDE])


def _normalise(vectors: Floats) -> Floats:
    lengths = np.linalg.norm(vectors, axis=1, keepdims=True)
    return sealed(vectors / np.maximum(lengths, np.finfo(float).tiny))
