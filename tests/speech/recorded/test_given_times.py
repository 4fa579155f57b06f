from kinesic.speech.recorded.given_times import GivenTime, match_words
from kinesic.speech.timings.timed_words import TimedSpan


def test_words_match_those_of_a_timing_file_regardless_of_case_punctuation_and_accents():
    spans = [TimedSpan("HELLO,", 0.1, 0.5), TimedSpan("caf\u00e9!", 0.6, 1.0)]
    assert match_words(["Hello", "cafe"], spans) == [GivenTime(0.1, 0.5), GivenTime(0.6, 1.0)]


def test_timed_phrase_sets_the_start_of_its_first_word_and_the_end_of_its_last_word():
    times = match_words(["my", "dear", "friend"], [TimedSpan("My dear friend.", 1.0, 2.0)])
    assert times == [GivenTime(1.0, None), GivenTime(), GivenTime(None, 2.0)]


def test_words_of_a_recording_missing_from_its_timing_file_have_no_time():
    spans = [TimedSpan("one", 0.0, 0.2), TimedSpan("um", 0.3, 0.4), TimedSpan("three", 0.8, 1.0)]
    times = match_words(["one", "two", "three"], spans)
    assert times == [GivenTime(0.0, 0.2), GivenTime(), GivenTime(0.8, 1.0)]
    assert match_words(["one"], []) == [GivenTime()]
