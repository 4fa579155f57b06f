"""Selection of the speech engine, and playback of recordings.

A recording has precedence over an engine, and an engine over the duration model.
"""

from dataclasses import dataclass, replace
from pathlib import Path

from kinesic.body.choices import VoiceName
from kinesic.body.config import ConfigError, check_inside
from kinesic.body.utterance import Recording, Script, Sound, Utterance, Voice
from kinesic.speech.alignment import align_phonemes, find_audible_spans, order_anchors
from kinesic.speech.durations import DurationModel
from kinesic.speech.espeak import Espeak
from kinesic.speech.espeak_pool import espeak_fault
from kinesic.speech.recording import RecordingError, read_wav

MAX_UNREMARKED_SHIFT = 0.05  # [s] largest shift of a mark from its word that causes no remark


def voice(name: VoiceName = "durations") -> Voice:
    """Create the voice with a name such as `auto` or `espeak`.

    Every voice also plays recordings.

    Args:
        name: `espeak` is audible; `durations` is silent and the same on every machine; `auto` is espeak if it works,
            else durations
            with a remark in every utterance.

    Raises:
        ConfigError: espeak is requested explicitly and does not work.
    """
    why = "" if name == "durations" else espeak_fault()
    if why and name == "espeak":
        raise ConfigError(f"the voice espeak cannot speak: {why}; --voice durations is silent and needs nothing")
    if why or name == "durations":
        return RecordedVoice(DurationModel(f"nothing is heard, only its duration is estimated: {why}" if why else ""))
    return RecordedVoice(Espeak())


@dataclass(frozen=True)
class RecordedVoice:
    """Voice that plays recordings and synthesises scripts without a recording."""

    voice: Voice

    def say(self, script: Script, /, *, rate: float = 1.0, pitch: float = 1.0) -> Utterance:
        """Return the utterance of a script's recording, or synthesise the script.

        Mark times that are not given, and lip sounds, come from the duration model, and are placed in the audible parts
        of the recording, each word between the given times around it. An unreadable recording is spoken by the other
        voice, with a remark. Marks with times in the document fall at these times with every voice.
        """
        if script.recording is None:
            return _keep_times(script, self.voice.say(script, rate=rate, pitch=pitch))
        try:
            sound = read_wav(_find(script.recording))
        except RecordingError as error:
            utterance = self.say(replace(script, recording=None), rate=rate, pitch=pitch)
            return replace(utterance, remarks=(f"{error}: it is said instead", *utterance.remarks))
        return _play_recording(script, script.recording, sound)


def _keep_times(script: Script, utterance: Utterance) -> Utterance:
    """Move speech marks to the document's times, and report large shifts."""
    given = {mark.name: mark.time for mark in reversed(script.marks) if mark.time is not None}
    if not given:
        return utterance
    clipped = {name: min(max(time, 0.0), utterance.duration) for name, time in given.items()}
    shifted = [
        f"{name} (given {given[name]:g} s, said {utterance.marks.get(name, 0.0):.2f} s)"
        for name in reversed(given)
        if abs(given[name] - utterance.marks.get(name, 0.0)) > MAX_UNREMARKED_SHIFT
    ]
    remark = f"marks keep the times of the document, which differ from those of their words: {', '.join(shifted)}"
    return replace(
        utterance, marks={**utterance.marks, **clipped}, remarks=(*utterance.remarks, *([remark] if shifted else []))
    )


def _find(recording: Recording) -> Path:
    """Return the path of a recording, adding a missing suffix .wav."""
    path = recording.path
    _check(path, recording.folder)
    if path.suffix or not path.name or path.exists():
        return path
    named = path.with_name(f"{path.name}.wav")
    _check(named, recording.folder)
    return named if named.exists() else path


def _check(path: Path, folder: Path | None) -> None:
    """Reject a recording outside of the folder in which it must lie."""
    if folder is not None:
        try:
            check_inside(folder, path)
        except ConfigError as error:
            raise RecordingError(f"the recording {error}") from None


def _play_recording(script: Script, recording: Recording, sound: Sound) -> Utterance:
    estimate = DurationModel().say(replace(script, pauses=()))
    in_text = {mark.name: mark.time for mark in reversed(script.marks) if mark.time is not None}
    given_times = in_text | dict(reversed(recording.marks))
    given = {name: min(max(time, 0.0), sound.duration) for name, time in given_times.items()}
    anchors = [(estimate.marks[name], time) for name, time in given.items() if name in estimate.marks]
    phonemes, place = align_phonemes(
        estimate.phonemes, order_anchors(anchors, estimate.duration, sound.duration), find_audible_spans(sound)
    )
    marks = {name: given.get(name, place(time)) for name, time in estimate.marks.items()} | given
    outside = [f"{name} ({time:g} s)" for name, time in given_times.items() if not 0.0 <= time <= sound.duration]
    estimated_marks = [name for name in estimate.marks if name not in given]
    remarks = []
    if outside:
        subject = f"marks outside the {sound.duration:.3f} s of {recording.path.name}"
        remarks.append(f"{subject} are at its nearest end: {', '.join(outside)}")
    if estimated_marks:
        remarks.append(f"the time of {', '.join(estimated_marks)} in {recording.path.name} is estimated: none is given")
    return Utterance(sound.duration, marks, phonemes, "recording", sound, tuple(remarks))
