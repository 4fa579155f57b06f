import pytest

from kinesic.speech.timings import timed_words
from kinesic.speech.timings.timed_words import RawSpan, TimedSpan, TimingError, check_spans, check_time


def test_timed_word_without_an_end_lasts_until_the_next_one():
    first, second = check_spans([RawSpan("a", "one", 1.0), RawSpan("b", " two\n words ", 2.0, 3.0)])
    assert (first, second) == (TimedSpan("one", 1.0, 2.0), TimedSpan("two words", 2.0, 3.0))


def test_timed_span_without_text_is_left_out_but_checked():
    assert check_spans([RawSpan("a", " ", 1.0, 2.0)]) == ()
    with pytest.raises(TimingError):
        check_spans([RawSpan("a", " ", 2.0, 1.0)])


def test_timing_file_with_too_many_words_is_refused(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(timed_words, "MAX_SPANS", 2)
    with pytest.raises(TimingError, match="more than 2 words"):
        check_spans(RawSpan("a", "x", float(k)) for k in range(4))


@pytest.mark.parametrize("value", [-0.001, float("nan"), float("inf"), 1301, 10**500])
def test_word_time_outside_the_allowed_range_is_refused(value: float):
    with pytest.raises(TimingError, match=r"x is .*; times are 0 to 1300"):
        check_time(value, "x")
    assert check_time(1300_000, "x", per_second=1000.0) == pytest.approx(1300.0)
