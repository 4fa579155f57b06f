"""Tests of speech pauses of successive marks."""

import pytest

from kinesic.bml.block import TimedBehaviour, Timeline
from kinesic.bml.parse import parse
from kinesic.body.utterance import Utterance
from kinesic.planning import speech
from kinesic.planning.speech import SpeechPause, find_required_pauses, lengthen_pauses
from kinesic.planning.syncs import SHIFT_TO_WARN

SPEECH_DOCUMENT = (  # speech with three marks
    '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b"><speech id="s"><text>See <sync id="a"/>this, '
    '<sync id="b"/>this and <sync id="c"/>that.</text></speech></bml>'
)
STROKE_POINT = ("g", "stroke")  # behaviour and sync point that is late
MARK_TIMES = {"a": 1.0, "b": 2.0, "c": 3.0}  # [s] time of each mark after the start of the speech


@pytest.fixture
def pauses(monkeypatch):
    """Return a function that computes speech pauses from delays of marks [s]."""

    def of(missed: dict[str, float], most: float = 9.0, before: tuple[SpeechPause, ...] = ()):
        block = parse(SPEECH_DOCUMENT)
        times = {"start": 10.0, "end": 14.0} | {mark: 10.0 + time for mark, time in MARK_TIMES.items()}
        timeline = Timeline(block, (TimedBehaviour(block.behaviours[0], times),))
        delays = {("s", mark): (late, STROKE_POINT) for mark, late in missed.items()}
        monkeypatch.setattr(speech, "compute_mark_delays", lambda *_: delays)
        return find_required_pauses(timeline, (), {"s": most}, before)

    return of


def told(found: tuple[SpeechPause, ...]) -> dict[str, tuple[float, float]]:
    return {item.mark: (pytest.approx(item.until), pytest.approx(item.later)) for item in found}


def test_pause_before_a_speech_mark_covers_only_delay_beyond_earlier_pauses(pauses):
    assert told(pauses({"a": 0.5, "b": 0.7, "c": 0.6})) == {"a": (1.5, 0.5), "b": (2.7, 0.2)}
    assert told(pauses({"b": 0.4})) == {"b": (2.4, 0.4)}
    assert pauses({}) == ()


def test_new_speech_pause_starts_with_zero_duration(pauses):
    (pause,) = pauses({"b": 0.4})
    assert (pause.speech, pause.mark, pause.duration) == ("s", "b", 0.0)


def test_delay_below_the_warning_threshold_needs_no_speech_pause(pauses):
    assert pauses({"a": SHIFT_TO_WARN}) == ()
    assert len(pauses({"a": 1.01 * SHIFT_TO_WARN})) == 1


def test_speech_pauses_are_limited_to_the_maximum_duration(pauses):
    assert told(pauses({"a": 0.5, "b": 1.5}, most=0.3)) == {"a": (1.3, 0.3), "b": (2.6, 0.3)}
    (first,) = pauses({"a": 0.5}, most=0.6)
    (again,) = pauses({"a": 0.5}, most=0.6, before=(first,))
    assert again.later == pytest.approx(0.6)


def test_existing_speech_pause_without_a_new_delay_is_kept(pauses):
    made = SpeechPause("s", "b", 2.4, STROKE_POINT, later=0.4, duration=0.4)
    assert told(pauses({}, before=(made,))) == {"b": (2.0, 0.4)}


def lengthened(waiting: tuple[SpeechPause, ...], **marks: float) -> list[float]:
    return [pause.duration for pause in lengthen_pauses(waiting, {"s": Utterance(5.0, marks=marks)})]


def test_speech_pauses_grow_in_whole_milliseconds():
    waiting = tuple(
        SpeechPause("s", mark, until, STROKE_POINT, duration=0.1) for mark, until in (("a", 1.5), ("b", 2.75))
    )
    assert lengthened(waiting, a=1.0, b=2.0) == pytest.approx([0.6, 0.35])
    assert lengthened(waiting, a=1.4921, b=2.75) == pytest.approx([0.108, 0.1])


def test_speech_pause_before_a_late_mark_is_not_shortened():
    waiting = (SpeechPause("s", "a", 1.5, STROKE_POINT, duration=0.1),)
    assert lengthened(waiting, a=1.5) == lengthened(waiting, a=1.9) == [0.1]
