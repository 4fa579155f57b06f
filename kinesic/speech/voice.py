"""Chooses who speaks: a recording where the document has one, else an engine, else the model of durations."""

from dataclasses import dataclass, replace
from pathlib import Path

from kinesic.body.choices import VoiceName
from kinesic.body.config import ConfigError, check_inside
from kinesic.body.utterance import Phoneme, Recording, Script, Sound, Utterance, Voice
from kinesic.speech.durations import DurationModel
from kinesic.speech.espeak import Espeak
from kinesic.speech.espeak_pool import espeak_fault
from kinesic.speech.recording import RecordingError, read_wav

ASTRAY = 0.05  # [s] by which a mark may be off its word without a remark


def voice(name: VoiceName = "durations") -> Voice:
    """Makes the voice of a name; each plays recordings, too.

    Args:
        name: `espeak` is heard; `durations` is silent and the same on every machine; `auto` is espeak where it works,
            else durations, and then every utterance remarks why it is not heard.

    Raises:
        ConfigError: espeak is asked for by its name and does not work.
    """
    why = "" if name == "durations" else espeak_fault()
    if why and name == "espeak":
        raise ConfigError(f"the voice espeak cannot speak: {why}; --voice durations is silent and needs nothing")
    if why or name == "durations":
        return Recorded(DurationModel(f"nothing is heard, only the time that it takes is known: {why}" if why else ""))
    return Recorded(Espeak())


@dataclass(frozen=True)
class Recorded:
    """A voice that plays recordings, and has another voice say everything else."""

    voice: Voice

    def say(self, script: Script, /, *, rate: float = 1.0, pitch: float = 1.0) -> Utterance:
        """Says a script, or plays its recording, which neither rate nor pitch changes.

        Marks whose time nobody gave, and what the lips do, are where the duration model has them, stretched to the
        length of the recording. One that cannot be read is said by the other voice, with a remark. Where the document
        says when a mark falls, it falls then, whoever speaks.
        """
        if script.recording is None:
            return _keep_times(script, self.voice.say(script, rate=rate, pitch=pitch))
        try:
            sound = read_wav(_find(script.recording))
        except RecordingError as error:
            said = self.say(replace(script, recording=None), rate=rate, pitch=pitch)
            return replace(said, remarks=(f"{error}: it is said instead", *said.remarks))
        return _played(script, script.recording, sound)


def _keep_times(script: Script, said: Utterance) -> Utterance:
    """Puts marks where the document has them, and remarks where the voice would have had them elsewhere."""
    given = {mark.name: mark.time for mark in reversed(script.marks) if mark.time is not None}
    if not given:
        return said
    kept = {name: min(max(time, 0.0), said.duration) for name, time in given.items()}
    apart = [
        f"{name} (given {given[name]:g} s, said {said.marks.get(name, 0.0):.2f} s)"
        for name in reversed(given)
        if abs(given[name] - said.marks.get(name, 0.0)) > ASTRAY
    ]
    remark = f"marks fall when the document says, not when the voice says their words: {', '.join(apart)}"
    return replace(said, marks={**said.marks, **kept}, remarks=(*said.remarks, *([remark] if apart else [])))


def _find(recording: Recording) -> Path:
    """The file of a recording, which may be named without its ending."""
    path = recording.path
    _check(path, recording.folder)
    if path.suffix or not path.name or path.exists():
        return path
    named = path.with_name(f"{path.name}.wav")
    _check(named, recording.folder)
    return named if named.exists() else path


def _check(path: Path, folder: Path | None) -> None:
    """Refuses a recording outside of the folder in which it must lie."""
    if folder is not None:
        try:
            check_inside(folder, path)
        except ConfigError as error:
            raise RecordingError(f"the recording {error}") from None


def _played(script: Script, recording: Recording, sound: Sound) -> Utterance:
    guessed = DurationModel().say(replace(script, pauses=()))
    stretch = sound.duration / guessed.duration if guessed.duration else 0.0
    in_text = {mark.name: mark.time for mark in reversed(script.marks) if mark.time is not None}
    known = in_text | dict(reversed(recording.marks))
    given = {name: min(max(time, 0.0), sound.duration) for name, time in known.items()}
    marks = {name: given.get(name, stretch * time) for name, time in guessed.marks.items()} | given
    late = [f"{name} ({time:g} s)" for name, time in known.items() if not 0.0 <= time <= sound.duration]
    open_ones = [name for name in guessed.marks if name not in given]
    remarks = []
    if late:
        what = f"marks outside the {sound.duration:.3f} s of {recording.path.name}"
        remarks.append(f"{what} are at its nearest end: {', '.join(late)}")
    if open_ones:
        remarks.append(f"when {', '.join(open_ones)} falls in {recording.path.name} is estimated: no time is given")
    phonemes = tuple(Phoneme(p.symbol, stretch * p.start, stretch * p.duration) for p in guessed.phonemes)
    return Utterance(sound.duration, marks, phonemes, "recording", sound, tuple(remarks))
