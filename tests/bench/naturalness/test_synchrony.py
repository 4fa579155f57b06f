import pytest

from kinesic.bench.naturalness import synchrony
from kinesic.bench.naturalness.synchrony import LARGEST, PASSAGE, passage_lags, synchrony_figures
from kinesic.controller.synchrony import StrokeLag, median_lag


def test_every_stroke_of_the_passage_meets_its_word(known):
    lags = passage_lags()
    assert [each.behaviour for each in lags] == [lexeme for _, lexeme in PASSAGE if lexeme]
    assert max(abs(each.stroke - each.accent) for each in lags) < 0.011
    assert median_lag(lags) <= LARGEST
    assert all(len(known.lexicon.find(each.behaviour, "unspecified").form.keys) > 1 for each in lags)


def test_the_row_is_the_median_and_the_spread(monkeypatch):
    found = tuple(StrokeLag("g", "stroke", "s:m", 1.0, 1.0, 1.0 + lag) for lag in (-0.3, 0.1, 0.2))
    monkeypatch.setattr(synchrony, "passage_lags", lambda: found)
    (figure,) = synchrony_figures("naturalness")
    assert (figure.name, figure.value, figure.goal) == ("naturalness.word_lag", pytest.approx(0.2), 0.1)
    assert figure.ok is False
    assert "n 3" in figure.why
