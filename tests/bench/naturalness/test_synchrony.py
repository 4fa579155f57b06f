import pytest

from kinesic.bench.naturalness import synchrony
from kinesic.bench.naturalness.synchrony import (
    LARGEST,
    NODS,
    PASSAGE,
    nod_lags,
    passage_lags,
    story_lags,
    synchrony_figures,
)
from kinesic.controller.synchrony import StrokeLag, median_lag


def test_every_stroke_of_the_passage_meets_its_word(known):
    lags = passage_lags()
    assert [each.behaviour for each in lags] == [lexeme for _, lexeme in PASSAGE if lexeme]
    assert max(abs(each.stroke - each.accent) for each in lags) < 0.011
    assert median_lag(lags) <= LARGEST
    assert all(len(known.lexicon.find(each.behaviour, "unspecified").form.keys) > 1 for each in lags)


@pytest.mark.parametrize(
    ("style", "most"), [("neutral", 0.1), pytest.param("calm", 0.16, marks=pytest.mark.soak), ("joyful", 0.1)]
)
def test_a_story_that_nobody_wrote_for_it_meets_its_words_in_every_manner(style, most):
    lags = story_lags(style)
    assert len(lags) == 16
    assert max(abs(each.stroke - each.accent) for each in lags) < 0.011
    assert median_lag(lags) <= most


def test_nods_end_with_the_accented_syllable_of_their_word():
    found = nod_lags()
    assert len(found) == len(NODS)
    assert max(map(abs, found.values())) < 0.08


def test_the_row_is_the_median_and_the_spread(monkeypatch):
    found = tuple(StrokeLag("g", "stroke", "s:m", 1.0, 1.0, 1.0 + lag) for lag in (-0.3, 0.1, 0.2))
    monkeypatch.setattr(synchrony, "passage_lags", lambda: found)
    monkeypatch.setattr(synchrony, "story_lags", lambda style: found)
    figure, *stories, nodding = synchrony_figures("naturalness")
    assert (figure.name, figure.value, figure.goal) == ("naturalness.word_lag", pytest.approx(0.2), 0.1)
    assert [(each.name.removeprefix("naturalness.word_lag_"), each.goal) for each in stories] == [
        ("story", 0.1),
        ("story_calm", None),
        ("story_joyful", None),
    ]
    assert (nodding.name, nodding.ok) == ("naturalness.nod_lag", True)
    assert figure.ok is False
    assert "n 3" in figure.why
