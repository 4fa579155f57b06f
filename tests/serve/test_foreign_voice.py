"""Speech sound of a client: timing, mouth and stressed syllables."""

import numpy as np
import pytest

from kinesic.conversation.events import SoundPiece, SoundPosition
from kinesic.serve.foreign_voice import (
    BEAT_INTERVAL,
    BEAT_LEAD,
    MAX_LEAD,
    MAX_STARVATION,
    NOD_INTERVAL,
    START_DELAY,
    ForeignVoice,
)
from kinesic.speech.speaker import SAMPLE_RATE

RATE = 24_000
SYLLABLES = tuple(0.5 + 0.8 * k for k in range(6))  # [s] loudest times of the test sound


def syllables(duration: float = 5.0) -> bytes:
    times = np.arange(round(duration * RATE)) / RATE
    loudness = sum(np.exp(-(((times - centre) / 0.06) ** 2)) for centre in SYLLABLES)
    return (20_000 * loudness * np.sin(2 * np.pi * 700.0 * times)).astype("<i2").tobytes()


def piece(data: bytes, **options) -> SoundPiece:
    return SoundPiece("a", RATE, data, **options)


@pytest.fixture
def voice() -> ForeignVoice:
    made = ForeignVoice("a", RATE, 10.0)
    made.take(piece(syllables(), ends=True), 10.0)
    return made


def test_sound_begins_after_a_short_delay_and_ends_with_its_last_sample(voice):
    sound = voice.sound(10.0)
    assert (sound.begin, sound.is_complete) == (10.0 + START_DELAY, True)
    assert sound.duration == pytest.approx(5.0, abs=0.01)
    assert voice.sound(sound.end - 0.01) is not None
    assert voice.sound(sound.end) is None


def test_parts_of_a_sound_follow_without_a_gap():
    voice, data = ForeignVoice("a", RATE, 0.0), syllables(1.0)
    for k in range(10):
        voice.take(piece(data[4800 * k : 4800 * (k + 1)]), 0.05 * k)
    pieces = voice.sound(0.5).pieces
    ends = [begin + sound.duration for begin, sound in pieces]
    assert [begin for begin, _ in pieces[1:]] == pytest.approx(ends[:-1], abs=1e-9)
    assert {sound.rate for _, sound in pieces} == {SAMPLE_RATE}
    assert pieces[0][0] == START_DELAY


def test_late_part_is_played_after_a_silence():
    voice = ForeignVoice("a", RATE, 0.0)
    voice.take(piece(syllables(0.5)), 0.0)
    voice.take(piece(syllables(0.5)), START_DELAY + 0.9)
    assert voice.sound(1.2).duration == pytest.approx(1.4, abs=0.01)


def test_sound_without_a_further_part_ends_after_a_while():
    voice = ForeignVoice("a", RATE, 0.0)
    voice.take(piece(syllables(0.5)), 0.0)
    end = voice.sound(0.0).end
    assert voice.next_time() == pytest.approx(end + MAX_STARVATION)
    assert voice.sound(end + 0.9 * MAX_STARVATION) is not None
    assert voice.sound(end + MAX_STARVATION) is None


def test_sound_that_the_client_plays_has_a_mouth_but_nothing_to_play():
    voice = ForeignVoice("a", RATE, 0.0)
    voice.take(piece(syllables(), plays=False), 0.0)
    assert voice.sound(0.0).pieces == ()
    assert voice.sound(0.0).face["26"].max() > 0.2


def test_mouth_opens_at_the_syllables(voice):
    sound = voice.sound(11.0)
    rows = [round((10.0 + START_DELAY + time - sound.face_begin) * 100) for time in SYLLABLES]
    opened = [sound.face["26"][row] for row in rows[1:]]
    closed = [sound.face["26"][row - 40] for row in rows[2:]]
    assert min(opened) > 5.0 * max(closed)


def test_nod_is_due_before_each_stressed_syllable(voice):
    times, now = [], 10.0
    while (due := voice.next_time()) < 14.9:
        now = due
        times += [stress.time for stress in voice.pop_nods(now)]
        voice.pop_beats(now)
    expected = [10.0 + START_DELAY + time for time in SYLLABLES]
    assert times == pytest.approx(expected, abs=0.03)
    assert np.diff(times).min() >= NOD_INTERVAL


def test_hand_beats_at_every_second_syllable_if_enough_sound_waits(voice):
    beats = voice.pop_beats(14.4 - BEAT_LEAD + 0.2)
    assert beats == [], "too late for the earlier ones"
    early = ForeignVoice("a", RATE, 10.0)
    early.take(piece(syllables()), 10.0)
    strokes = [stress.time for now in np.arange(10.0, 15.0, 0.1) for stress in early.pop_beats(now)]
    assert len(strokes) == 3
    assert np.diff(strokes).min() >= BEAT_INTERVAL


def test_reported_position_moves_the_sound(voice):
    voice.move(SoundPosition("a", 1.0), 11.6)
    assert voice.sound(11.6).begin == pytest.approx(10.6)
    assert voice.pop_nods(10.85)[0].time == pytest.approx(10.6 + SYLLABLES[0], abs=0.03)
    voice.move(SoundPosition("a", 1.02), 11.6)
    assert voice.sound(11.6).begin == pytest.approx(10.6), "a small change is ignored"


def test_too_much_waiting_sound_or_another_rate_is_refused(voice):
    with pytest.raises(ValueError, match=r"rate 8000 Hz after 24000 Hz"):
        voice.take(SoundPiece("a", 8000, b""), 10.0)
    with pytest.raises(ValueError, match=r"120 s of sound wait already"):
        voice.take(piece(b""), 10.0 - MAX_LEAD)
