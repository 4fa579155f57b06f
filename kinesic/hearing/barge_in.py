"""Decision whether a person takes the turn while the robot speaks.

A voice first makes the robot quiet (duck), and makes it yield if it lasts. After a short voice, such as "mhm", the
robot goes on. A cough, a knock or the robot's own echo is no voice.
"""

from dataclasses import dataclass
from enum import Enum, auto


@dataclass(frozen=True)
class BargeInThresholds:
    """Thresholds for the decision that a person takes the turn.

    They were chosen on seeds 1 and 4 of the benchmark `hearing`.
    """

    voice: float = 0.6  # probability above which a frame counts as voice
    clear_voice: float = 0.85  # probability above which a frame counts as clear voice; music seldom reaches it
    duck_frames: int = 2  # voiced frames after which the robot is quiet: 64 ms
    turn_frames: int = 16  # frames from the first to the last clear one after which the robot yields: 0.51 s
    min_clear_frames: int = 9  # smallest number of frames with a clear voice among these frames
    max_gap: int = 8  # frames without voice that do not end the voice: 0.26 s


class BargeInDecision(Enum):
    """Reaction of the robot to a voice."""

    DUCK = auto()  # a voice has begun: be quiet
    END = auto()  # the voice has ended: go on, unless the turn was taken
    YIELD = auto()  # a person takes the turn


@dataclass
class _Voice:
    """Frame counts of the voice that is currently heard."""

    frames: int = 0  # all frames since the voice began
    voiced: int = 0  # frames with a voice
    clear: int = 0  # frames with a clear voice
    first_clear: int = 0  # number of the first clear frame; 0: none yet
    gap: int = 0  # frames since the last one with a voice
    has_ducked: bool = False
    has_yielded: bool = False


class BargeInDetector:
    """Detector of barge-in from the voice probabilities of consecutive frames."""

    def __init__(self, thresholds: BargeInThresholds = BargeInThresholds()) -> None:
        """Create a detector at the start of a stream."""
        self._thresholds = thresholds
        self._voice: _Voice | None = None

    def step(self, probability: float, *, admitted: bool = True) -> tuple[BargeInDecision, int] | None:
        """Return the reaction to the next frame, or None.

        Args:
            probability: probability that the frame contains a voice.
            admitted: whether it contains more than the robot's own voice.

        Returns:
            The reaction, and the number of frames since the voice began or ended.
        """
        if admitted and probability > self._thresholds.voice:
            return self._take_voice(is_clear=probability > self._thresholds.clear_voice)
        voice = self._voice
        if voice is None:
            return None
        voice.frames, voice.gap = voice.frames + 1, voice.gap + 1
        if voice.gap <= self._thresholds.max_gap:
            return None
        self._voice = None
        return (BargeInDecision.END, voice.gap) if voice.has_ducked else None

    def _take_voice(self, *, is_clear: bool) -> tuple[BargeInDecision, int] | None:
        """Count a voiced frame, and return a reaction if one is due."""
        thresholds = self._thresholds
        voice = self._voice = self._voice or _Voice()
        voice.frames, voice.voiced, voice.gap = voice.frames + 1, voice.voiced + 1, 0
        if is_clear:
            voice.clear, voice.first_clear = voice.clear + 1, voice.first_clear or voice.frames
            is_long = voice.frames - voice.first_clear + 1 >= thresholds.turn_frames
            if not voice.has_yielded and is_long and voice.clear >= thresholds.min_clear_frames:
                voice.has_yielded = voice.has_ducked = True
                return BargeInDecision.YIELD, voice.frames
        if not voice.has_ducked and voice.voiced >= thresholds.duck_frames:
            voice.has_ducked = True
            return BargeInDecision.DUCK, voice.frames
        return None
