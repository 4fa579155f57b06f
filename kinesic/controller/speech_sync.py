"""What is said while servos perform, heard at the time to which they have come."""

from kinesic.body.utterance import Sound
from kinesic.controller.servo_performance import FULL
from kinesic.hardware.supervisor.channel import Status
from kinesic.speech.speaker import Speaker

ASTRAY = 0.03  # [s] between the robot's time and the sound's beyond which the sound is put right


class SpeechPlayback:
    """Speaks while performance time runs as planned, and is silent while it stands or changes its pace."""

    def __init__(self, sound: Sound, speaker: Speaker) -> None:
        """Silent at first.

        Args:
            sound: on performance time, from its 0.
            speaker: whose clock is the machine's monotonic one, as the supervisor's is.
        """
        self._sound, self._speaker = sound, speaker
        self._zero: float | None = None  # [s] on the clock of performance time 0; None: silent

    def __call__(self, told: Status) -> None:
        """Hears how the servos go on."""
        if not told.stage.runs or not told.scale > FULL:
            self._hush()
            return
        zero = told.clock - told.time
        if self._zero is not None and abs(zero - self._zero) <= ASTRAY:
            return
        self._hush()
        self._speaker.play(self._sound, zero)
        self._zero = zero

    def _hush(self) -> None:
        if self._zero is not None:
            self._speaker.stop()
            self._zero = None
