"""Decision whether a frame contains a sound other than the robot's voice.

A canceller leaves a part of the echo, which a voice detector takes for a voice. A frame counts only if its power is
well above the part that the canceller has left so far.
"""

import numpy as np

from kinesic.body.utterance import Samples
from kinesic.hearing.voice_activity import FRAME_SIZE, VOICE_RATE

VOICE_BAND = (300.0, 4000.0)  # [Hz] frequencies whose power is compared
MIN_POWER_RATIO = 4.0  # smallest power of a frame with another sound / expected power of the residual echo: 6 dB
INITIAL_RESIDUAL = 0.5  # initial estimate of the residual: fraction of the echo's power that the canceller leaves
RESIDUAL_FALL = 0.2  # fraction of the difference by which a too large residual estimate falls in a frame
RESIDUAL_GROWTH = 1.01  # factor per frame on a too small residual estimate; low, because a person may be speaking
ECHO_DECAY = 0.7  # factor on the power of the echo per frame, for the reverberation after a sound
ONSET_FRACTION = 0.1  # frame's echo power / decaying echo power, above which the residual estimate is updated
NOISE_GROWTH = 1.01  # factor on the noise power per frame; it falls at once to a quieter frame
NOISE_WEIGHT = 0.3  # fraction of the noise power in the expected residual
MIN_ECHO_POWER = 1e-5  # mean spectral power of the echo above which the residual estimate is updated
MIN_NOISE_POWER = 1e-9  # mean spectral power below the noise of any microphone


class OwnVoiceGate:
    """Comparison of the power of frames with the expected residual echo."""

    def __init__(self) -> None:
        """Create a gate with the initial estimate of the residual echo."""
        frequencies = np.fft.rfftfreq(2 * FRAME_SIZE, 1.0 / VOICE_RATE)
        self._band = (frequencies > VOICE_BAND[0]) & (frequencies < VOICE_BAND[1])
        self._residual = INITIAL_RESIDUAL  # fraction of the echo's power that remains
        self._echo = 0.0  # decaying power of the echo
        self._noise: float | None = None  # power of the quietest frames; None before the first frame

    def admits(self, frame: Samples, echo: Samples) -> bool:
        """Return whether a frame contains more than echo and noise.

        Args:
            frame: (512,) samples after the cancellation.
            echo: (512,) samples of the cancelled echo.
        """
        power, echo_power = self._powers(frame, echo)
        self._echo = max(echo_power, ECHO_DECAY * self._echo)
        quietest = max(power, MIN_NOISE_POWER)
        self._noise = quietest if self._noise is None else min(NOISE_GROWTH * self._noise, quietest)
        expected = self._residual * self._echo + NOISE_WEIGHT * self._noise
        if self._echo > MIN_ECHO_POWER and echo_power > ONSET_FRACTION * self._echo:
            observed = power / self._echo
            if observed < self._residual:
                self._residual += RESIDUAL_FALL * (observed - self._residual)
            else:
                self._residual = min(self._residual * RESIDUAL_GROWTH, 1.0)
        return power > MIN_POWER_RATIO * expected

    def _powers(self, *frames: Samples) -> list[float]:
        """Return the mean power of each frame in the voice band."""
        spectra = np.fft.rfft(np.stack(frames), 2 * FRAME_SIZE)[:, self._band]
        powers: list[float] = np.mean(np.abs(spectra) ** 2, axis=1).tolist()
        return powers
