import pytest

from kinesic.bench.naturalness import synchrony
from kinesic.bench.naturalness.synchrony import (
    MAX_LAG,
    NODDED_WORDS,
    PASSAGE_PARTS,
    nod_lags,
    passage_lags,
    story_lags,
    synchrony_metrics,
)
from kinesic.metrics.synchrony import StrokeLag, compute_median_lag


def test_gesture_strokes_of_the_test_passage_coincide_with_word_accents(known):
    lags = passage_lags()
    assert [lag.behaviour for lag in lags] == [lexeme for _, lexeme in PASSAGE_PARTS if lexeme]
    assert max(abs(lag.stroke - lag.accent) for lag in lags) < 0.011
    assert compute_median_lag(lags) <= MAX_LAG
    assert all(len(known.lexicon.find(lag.behaviour, "unspecified").form.keys) > 1 for lag in lags)


@pytest.mark.parametrize(
    ("style", "limit"),
    [("neutral", 0.1), *(pytest.param(*row, marks=pytest.mark.soak) for row in (("calm", 0.16), ("joyful", 0.1)))],
)
def test_gesture_strokes_of_the_story_coincide_with_word_accents_in_three_styles(style, limit):
    lags = story_lags(style)
    assert len(lags) == 16
    assert max(abs(lag.stroke - lag.accent) for lag in lags) < 0.011
    assert compute_median_lag(lags) <= limit


def test_nods_end_within_80_ms_of_the_accented_syllable():
    lags = nod_lags()
    assert len(lags) == len(NODDED_WORDS)
    assert max(map(abs, lags.values())) < 0.08


def test_stroke_lag_metric_is_the_median_absolute_lag(monkeypatch):
    lags = tuple(StrokeLag("g", "stroke", "s:m", 1.0, 1.0, 1.0 + lag) for lag in (-0.3, 0.1, 0.2))
    monkeypatch.setattr(synchrony, "passage_lags", lambda: lags)
    monkeypatch.setattr(synchrony, "story_lags", lambda style: lags)
    metric, *stories, nodding = synchrony_metrics("naturalness")
    assert (metric.name, metric.value, metric.goal) == ("naturalness.word_lag", pytest.approx(0.2), 0.1)
    assert [(story.name.removeprefix("naturalness.word_lag_"), story.goal) for story in stories] == [
        ("story", 0.1),
        ("story_calm", None),
        ("story_joyful", None),
    ]
    assert (nodding.name, nodding.ok) == ("naturalness.nod_lag", True)
    assert metric.ok is False
    assert "n 3" in metric.why
