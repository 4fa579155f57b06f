"""Voice that plays recordings, with matching lips, marks and accents."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

from kinesic.body.config import ConfigError, check_inside
from kinesic.body.utterance import Recording, Script, Sound, Utterance, Voice
from kinesic.speech.alignment import align_phonemes, find_audible_spans, order_anchors
from kinesic.speech.durations import DurationModel
from kinesic.speech.espeak import Espeak
from kinesic.speech.espeak_pool import espeak_fault
from kinesic.speech.recorded.follow import FollowedSpeech, follow_recording
from kinesic.speech.recorded.given_times import GivenTime, match_words
from kinesic.speech.recorded.rendition import Rendition, render
from kinesic.speech.recorded.unworded import lip_sounds
from kinesic.speech.recording import RecordingError, read_wav
from kinesic.speech.timings.reading import read_words_file
from kinesic.speech.timings.timed_words import TimedWords, TimingError

MAX_UNREMARKED_SHIFT = 0.05  # [s] largest shift of a mark from its word that causes no remark
NO_WORDS = TimedWords(())  # word times of a recording without a timing file


@dataclass(frozen=True)
class RecordedVoice:
    """Voice that plays recordings and synthesises scripts without a recording."""

    voice: Voice

    def say(self, script: Script, /, *, rate: float = 1.0, pitch: float = 1.0) -> Utterance:
        """Return the utterance of a script's recording, or synthesise the script.

        Words and lip sounds have their times of the file of words, or are found by comparing the recording with a
        synthesised rendition. Without an audible engine, sounds are spread over the audible parts of the recording,
        between the given times. An unreadable recording is spoken by the other voice, with a remark. Marks with times
        in the document fall at these times with every voice.
        """
        if script.recording is None:
            return _keep_times(script, self.voice.say(script, rate=rate, pitch=pitch))
        try:
            sound = read_wav(_find(script.recording, script.recording.path, ".wav"))
        except RecordingError as error:
            utterance = self.say(replace(script, recording=None), rate=rate, pitch=pitch)
            return replace(utterance, remarks=(f"{error}: its text is spoken instead", *utterance.remarks))
        timed, remarks = _read_words(script.recording)
        utterance = _play_recording(script, script.recording, sound, timed, self.comparison_voice)
        return replace(utterance, remarks=(*remarks, *utterance.remarks))

    @property
    def comparison_voice(self) -> Voice:
        """Voice to compare with recordings: espeak-ng, unless missing or durations are requested."""
        return self.voice if isinstance(self.voice, DurationModel) or espeak_fault() else Espeak()


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


def _find(recording: Recording, path: Path, suffix: str) -> Path:
    """Return the path of a recording's file, adding a missing suffix."""
    _check(path, recording.folder)
    if path.suffix or not path.name or path.exists():
        return path
    named = path.with_name(f"{path.name}{suffix}")
    _check(named, recording.folder)
    return named if named.exists() else path


def _check(path: Path, folder: Path | None) -> None:
    """Reject a file outside of the folder in which it must lie."""
    if folder is not None:
        try:
            check_inside(folder, path)
        except ConfigError as error:
            raise RecordingError(f"the recording {error}") from None


def _read_words(recording: Recording) -> tuple[TimedWords, tuple[str, ...]]:
    """Read the word times of a recording, or return a remark."""
    if recording.words is None:
        return NO_WORDS, ()
    try:
        return read_words_file(_find(recording, recording.words, ".json")), ()
    except (RecordingError, TimingError) as error:
        return NO_WORDS, (f"{error}: the words are found by their sound",)


def _play_recording(script: Script, recording: Recording, sound: Sound, timed: TimedWords, voice: Voice) -> Utterance:
    """Return the utterance of a script timed by its recording."""
    if not any(map(str.isalnum, script.text)):
        return _play_unworded(script, recording, sound)
    rendition = render(script, voice)
    in_text = {mark.name: mark.time for mark in reversed(script.marks) if mark.time is not None}
    given_times = in_text | dict(reversed(recording.marks))
    clipped = {name: min(max(time, 0.0), sound.duration) for name, time in given_times.items()}
    given = _combine(rendition, match_words(rendition.words, timed.words), clipped)
    followed = None if rendition.utterance.sound is None else follow_recording(rendition, sound, given, timed.phonemes)
    followed = followed or _spread(rendition, sound, given, clipped)
    marks = {name: followed.place(time) for name, time in rendition.utterance.marks.items()}
    words = followed.words
    marks |= {name: words[k][0] for name, k in rendition.marked_words.items() if k < len(words)} | clipped
    remarks = _list_remarks(rendition, recording, sound, timed, given_times, is_followed=followed.is_followed)
    return Utterance(sound.duration, marks, followed.phonemes, "recording", sound, remarks)


def _play_unworded(script: Script, recording: Recording, sound: Sound) -> Utterance:
    """Play a recording without text, with lips that follow the sound."""
    given = dict(reversed(recording.marks))
    marks = {mark.name: 0.0 for mark in script.marks} | {
        name: min(max(time, 0.0), sound.duration) for name, time in given.items()
    }
    remark = f"{recording.path.name} has no text: lips follow its loudness and spectrum alone"
    return Utterance(sound.duration, marks, lip_sounds(sound), "recording", sound, (remark,))


def _combine(rendition: Rendition, times: list[GivenTime], marks: Mapping[str, float]) -> list[GivenTime]:
    """Add the times of marks on words to the word times."""
    for name, word in reversed(list(rendition.marked_words.items())):
        if name in marks:
            times[word] = replace(times[word], start=marks[name])
    return times


def _spread(rendition: Rendition, sound: Sound, given: list[GivenTime], marks: Mapping[str, float]) -> FollowedSpeech:
    """Spread estimated sounds over the audible parts between given times."""
    estimate = rendition.utterance
    anchors = [(estimate.marks[name], time) for name, time in marks.items() if name in estimate.marks]
    anchors += [(float(rendition.starts[k]), time.start) for k, time in enumerate(given) if time.start is not None]
    phonemes, place = align_phonemes(
        estimate.phonemes,
        order_anchors(list(dict.fromkeys(anchors)), estimate.duration, sound.duration),
        find_audible_spans(sound),
    )
    return FollowedSpeech(phonemes, place, is_followed=False)


def _list_remarks(
    rendition: Rendition,
    recording: Recording,
    sound: Sound,
    timed: TimedWords,
    given_times: Mapping[str, float],
    *,
    is_followed: bool,
) -> tuple[str, ...]:
    """Return remarks for users about the word times of a recording."""
    name = recording.path.name
    remarks = list(rendition.utterance.remarks) if is_followed else []
    outside = [f"{mark} ({time:g} s)" for mark, time in given_times.items() if not 0.0 <= time <= sound.duration]
    if outside:
        remarks.append(
            f"marks outside the {sound.duration:.3f} s of {name} are at its nearest end: {', '.join(outside)}"
        )
    count = sum(time != GivenTime() for time in match_words(rendition.words, timed.words))
    if timed.words and count < len(rendition.words):
        remarks.append(
            f"{len(rendition.words) - count} of {len(rendition.words)} words of the text have no time in the "
            f"{timed.file_format}: they are placed between the others"
        )
    estimated = [mark for mark in rendition.utterance.marks if mark not in given_times]
    if estimated and not is_followed and not timed.words:
        remarks.append(f"the time of {', '.join(estimated)} in {name} is estimated: none is given")
    return tuple(remarks)
