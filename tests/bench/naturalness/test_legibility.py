from math import radians

import numpy as np
import pytest

from kinesic.bench.naturalness.legibility import different_pairs, legibility_metrics, shoulder_metric
from kinesic.expressivity.lexicon.legibility_table import AlikeTable, LegibilityTable, PlaceTable, legibility_table
from kinesic.expressivity.lexicon.lexicon import Lexicon

STROKE_POINTS = {
    name: np.full((2, 1, 3), [0.0, at, 0.0]) for name, at in (("hush", 0.0), ("nose", 0.03), ("come", 0.2))
}
HUSH_TABLE = LegibilityTable({"hush": PlaceTable("tips", "mouth", 0.05)}, {}, ())


def legibility(table, places):
    results = legibility_metrics("naturalness", STROKE_POINTS, places, table)
    return {metric.name.removeprefix("naturalness."): metric for metric in results}


def test_gestures_that_look_alike_are_counted_and_named():
    results = legibility(HUSH_TABLE, {})
    assert (results["alike"].value, results["alike"].ok, results["alike"].why) == (1.0, False, "hush and nose 30")
    assert (results["nearest_pair"].value, results["nearest_pair"].ok) == (pytest.approx(30), False)


def test_gestures_with_the_same_meaning_may_look_alike():
    table = LegibilityTable({}, {}, (AlikeTable(("hush", "nose"), "the face"), AlikeTable(("nose", "come"), "none")))
    assert different_pairs(STROKE_POINTS, table) == []
    assert legibility(table, {})["alike"].ok
    assert not table.may_be_alike("hush", "come")


def test_gestures_with_misplaced_hands_are_counted_and_named():
    assert legibility(HUSH_TABLE, {"hush": 0.04})["misplaced"].ok
    distant = legibility(HUSH_TABLE, {"hush": 0.06})
    assert (distant["misplaced"].value, distant["misplaced"].why, distant["farthest_place"].value) == (
        1.0,
        "hush",
        pytest.approx(60),
    )


def test_metric_of_similar_gestures_at_the_head_counts_only_gestures_with_required_head_positions():
    assert legibility(HUSH_TABLE, {})["alike_at_head"].value == 0.0, "nose has no required position here"
    both = {name: PlaceTable("tips", "mouth", 0.05) for name in ("hush", "nose")}
    results = legibility(LegibilityTable(both, {}, ()), {})["alike_at_head"]
    assert (results.value, results.why) == (1.0, "hush and nose 30")


def test_legibility_check_names_a_gesture_with_too_little_shoulder_rise():
    table = LegibilityTable({}, {"shrug": 12.0, "lift": 12.0}, ())
    results = shoulder_metric("naturalness", {"shrug": radians(13), "lift": radians(11), "other": 0.0}, table)
    assert (results.value, results.ok, results.why) == (1.0, False, "lift")


def test_legibility_table_contains_only_gestures_of_the_lexicon():
    table, forms = legibility_table(), Lexicon.load().forms_by_id
    named = {*table.places, *table.shoulders, *(gesture for group in table.alike for gesture in group.gestures)}
    assert named <= forms.keys()
    assert all(len(group.gestures) > 1 and group.why for group in table.alike)
