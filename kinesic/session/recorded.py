"""Planning of a recording with gestures, with or without its text."""

from dataclasses import dataclass, replace
from pathlib import Path

from kinesic.bml.block import Behaviour, Block, Notice, NoticeType, Speech
from kinesic.bml.parse import parse
from kinesic.bml.timing.syllables import find_accented_vowels
from kinesic.body.config import ConfigError
from kinesic.body.utterance import STRESS_MARKS, Mark, Recording, Script, Utterance
from kinesic.intent.author import AuthoredText
from kinesic.intent.pacing.memory import NO_MEMORY
from kinesic.intent.reading.passage import Passage
from kinesic.intent.recorded import RecordedAudio, choose_accent_behaviours
from kinesic.intent.writing import write_block
from kinesic.planning.setup import Setup
from kinesic.session.documents import MAX_TEXT_DURATION, TEXT_BOUNDS, author_with_setup, intention_sets
from kinesic.speech.recording import RecordingError, read_wav
from kinesic.speech.timings.reading import read_words_file
from kinesic.speech.timings.timed_words import TimingError

UNWORDED_WARNING = (
    "there is no text: gestures are beats on the accents that are heard; "
    "give the text, or a file with the times of words, for lips and gestures that match the words"
)


@dataclass(frozen=True)
class SpokenRecording:
    """Sound file to perform, and optional file with its word times."""

    audio: Path  # WAV file of the speech
    words: Path | None = None  # Whisper, ElevenLabs, Polly or Azure JSON, TextGrid, EAF, SRT, VTT


def read_recording(text: str | None, recording: SpokenRecording, setup: Setup, *, source: str) -> Block:
    """Turn a recording into a block of speech and gestures.

    Args:
        text: of the recording; None: that of the file of words, or none.
        recording: sound and times of words.
        setup: style, seed, language and voice.
        source: name in messages and reports.

    Raises:
        ConfigError: the sound, or the file of words, cannot be read.
    """
    written = write_recording(text, recording, setup)
    block = parse(written.bml, source=source, dialect=setup.dialect, performer=setup.character, bounds=TEXT_BOUNDS)
    notices = tuple(Notice(NoticeType.CANNOT_CREATE_BEHAVIOR, block.id, warning) for warning in written.warnings)
    behaviours = tuple(_use_recording(behaviour, recording) for behaviour in block.behaviours)
    return replace(block, behaviours=behaviours, notices=(*block.notices, *notices), max_duration=MAX_TEXT_DURATION)


def write_recording(text: str | None, recording: SpokenRecording, setup: Setup) -> AuthoredText:
    """Return BML that plays a recording with matching gestures, and warnings.

    Without a text, the gestures are beats on audible accents.

    Raises:
        ConfigError: the sound, or the file of words, cannot be read.
    """
    spoken = _check_files(recording)
    text = spoken if text is None else text
    words = "" if recording.words is None else str(recording.words)
    audio = RecordedAudio(str(recording.audio), words, lambda passage: _hear_passage(passage, recording, setup))
    if text.strip():
        return author_with_setup(text, setup, recorded=audio)
    utterance = _say("", (), recording, setup)
    accents = find_accented_vowels(utterance.phonemes) if _has_stress(utterance) else []
    sets, seed = intention_sets(setup), setup.idling.seed
    selection = choose_accent_behaviours(accents, utterance.duration, setup.style, sets, seed=seed)
    bml = write_block(Passage((), (), language=setup.language), selection.behaviours, recorded=audio)
    return AuthoredText(bml, (UNWORDED_WARNING,), NO_MEMORY)


def _check_files(recording: SpokenRecording) -> str:
    """Check a recording's files and return the text of the words file.

    The text is empty without a words file.

    Raises:
        ConfigError: a file cannot be read.
    """
    try:
        read_wav(recording.audio)
        return "" if recording.words is None else read_words_file(recording.words).text
    except (RecordingError, TimingError) as error:
        raise ConfigError(str(error)) from None


def _use_recording(behaviour: Behaviour, recording: SpokenRecording) -> Behaviour:
    """Return a speech behaviour with its sound replaced by the recording.

    Other behaviours are returned unchanged. The recording may lie in any folder.
    """
    if not isinstance(behaviour.action, Speech):
        return behaviour
    script = replace(behaviour.action.script, recording=Recording(recording.audio, words=recording.words))
    return replace(behaviour, action=replace(behaviour.action, script=script))


def _hear_passage(passage: Passage, recording: SpokenRecording, setup: Setup) -> Passage:
    """Return a passage with the word times and accents of its recording."""
    text, marks = "", list[Mark]()
    for k, word in enumerate(passage.words):
        text += word.before if k else word.before.lstrip()
        marks.append(Mark(f"w{k}", len(text)))
        text += word.text
    utterance = _say(text + passage.tail, tuple(marks), recording, setup, passage.voice or passage.language)
    times, latest = list[float](), 0.0
    for mark in marks:
        latest = max(latest, utterance.marks[mark.name])
        times.append(latest)
    end = max([sound.end for sound in utterance.phonemes] or [utterance.duration])
    accents = frozenset(
        k
        for k, begin in enumerate(times)
        for sound in utterance.phonemes
        if sound.symbol.startswith(STRESS_MARKS[0])
        and begin - 0.005 <= sound.start < (times[k + 1] - 0.005 if k + 1 < len(times) else end)
    )
    return replace(passage, times=(*times, max(end, latest)), accents=accents if _has_stress(utterance) else None)


def _say(
    text: str, marks: tuple[Mark, ...], recording: SpokenRecording, setup: Setup, language: str = "en"
) -> Utterance:
    heard = Recording(recording.audio, words=recording.words)
    return setup.voice.say(Script(text, marks, language, recording=heard))


def _has_stress(utterance: Utterance) -> bool:
    return any(sound.symbol.startswith(STRESS_MARKS[0]) for sound in utterance.phonemes)
