"""Detection of the spoken parts of a recording."""

import numpy as np

from kinesic.body.arrays import Flags, Floats, find_runs

NOISE_PERCENTILE = 5  # percentile of the frames' levels that counts as background noise
LOUD_PERCENTILE = 95  # percentile of the frames' levels that counts as loud speech
THRESHOLD_FRACTION = 0.25  # fraction of the range from noise to loud speech above which a frame has speech
MAX_DEPTH = 35.0  # [dB] a frame this far below loud speech is silent
MIN_RANGE = 6.0  # [dB] with a smaller range of levels, the whole recording counts as speech
SILENT_LEVEL = -60.0  # [dB] a recording that never exceeds this level has no speech
MAX_BRIDGED_FRAMES = 15  # [frames] longest silence inside speech, such as a closure
MAX_CLICK_FRAMES = 3  # [frames] longest sound in silence that does not count as speech


def find_speech(levels: Floats, *, bridged: int = MAX_BRIDGED_FRAMES) -> Flags:
    """Return the mask of frames with speech, shape (n,).

    Args:
        levels: level of each frame [dB].
        bridged: longest silence inside speech [frames].
    """
    if not len(levels):
        return np.zeros(0, dtype=bool)
    noise, loud = np.percentile(levels, (NOISE_PERCENTILE, LOUD_PERCENTILE))
    if loud < SILENT_LEVEL:
        return np.zeros(len(levels), dtype=bool)
    if loud - noise < MIN_RANGE:
        return np.ones(len(levels), dtype=bool)
    is_speech: Flags = levels > max(noise + THRESHOLD_FRACTION * (loud - noise), loud - MAX_DEPTH)
    for begin, end in find_runs(~is_speech):
        if end - begin <= bridged and begin > 0 and end < len(levels):
            is_speech[begin:end] = True
    for begin, end in find_runs(is_speech):
        if end - begin <= MAX_CLICK_FRAMES:
            is_speech[begin:end] = False
    return is_speech
