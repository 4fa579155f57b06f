import pytest

from kinesic.bml.reading.document import read_document
from kinesic.intent.fml.intentions import read_intentions
from kinesic.intent.fml.mark_times import estimate_mark_times
from kinesic.intent.reading.passage import SYLLABLE_DURATION

FML_DOCUMENT = """<fml-apml><bml><speech id="a" start="2"><tm id="m"/>One <tm id="n"/>two</speech>
<speech id="b"><tm id="m"/>three</speech><speech id="c" start="a:n + 0.5"/></bml>
<fml><x type="long" start="a:m"/><x type="short" start="a:m" end="a:m+0.1"/><x type="some" start="1" end="2"/></fml>
</fml-apml>"""


def test_fml_speeches_start_at_their_given_time_or_in_sequence():
    marks = estimate_mark_times(read_document(FML_DOCUMENT, source="b").bml)
    times = marks.times
    assert times["a:m"] == times["a:start"] == 2.0
    assert 2.0 < times["a:n"] < times["a:end"] == times["b:m"] < times["b:end"]
    assert times["c:start"] == pytest.approx(times["a:n"] + 0.5)
    longer = estimate_mark_times(read_document(FML_DOCUMENT.replace("One", "Banana"), source="b").bml).times
    assert longer["a:n"] - times["a:n"] == pytest.approx(2 * SYLLABLE_DURATION)
    assert marks.moment("a:none") is None
    assert marks.moment("1200").seconds == 1200.0
    assert marks.moment("1200.01") is marks.moment("a:m+1198.01") is None
    assert marks.speech_end("a:none").seconds == times["a:end"]


def test_fml_intention_has_its_given_or_a_default_or_minimum_duration():
    document = read_document(FML_DOCUMENT, source="b")
    root = document.root.children[-1]
    long, short, some = read_intentions([root], [], estimate_mark_times(document.bml))
    assert (long.end.seconds, long.end.reference) == (3.5, "a:m+1.50")
    assert short.end.seconds == pytest.approx(2.3)
    assert (some.stroke.reference, some.end.reference) == ("1.50", "2")
    assert long.stroke.seconds == pytest.approx(2.6)
