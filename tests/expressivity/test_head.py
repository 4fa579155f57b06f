from math import degrees

import numpy as np
import pytest

from kinesic.bml.block import Head, HeadDirectionShift
from kinesic.expressivity.head import MAX_ADDED_STROKES, NOD_SWING_TIME, HeadForm, head_form, head_layer, swing_time
from kinesic.expressivity.style.passage import passage_of
from kinesic.expressivity.style.style import Expressivity
from kinesic.expressivity.turns import UPRIGHT_TURN, rotation_range, scale_turn, turn_at


def frame_at(frames, time):
    return next(frame for frame in frames.frames if frame.time == time)


@pytest.mark.parametrize("amount", [0.25, 0.5, 1.0])
def test_nod_peaks_at_the_stroke(robot, pace, nod_times, amount):
    layer = head_layer(head_form(Head("NOD", amount=amount), robot, Expressivity()), nod_times, pace, Expressivity())
    assert degrees(turn_at(layer, 0.5).tilt) == pytest.approx(20 * amount)
    assert max(key.turn.tilt for key in layer) == turn_at(layer, 0.5).tilt
    assert turn_at(layer, 0.2).tilt == turn_at(layer, 0.8).tilt == 0


def test_nod_beyond_the_neck_range_is_clipped_with_warning(perform, robot, nod_times):
    frames = perform(("h", Head("NOD", amount=5.0), nod_times))
    assert frame_at(frames, 0.5).head.tilt == rotation_range(robot, "neck")[1].tilt
    assert frames.outcomes["h"].kind == "realised"
    assert any(notice.id == "bml1:h" and "60.0 deg" in notice.text for notice in frames.notices)


def test_repeated_nods_peak_at_each_stroke(robot, pace, nod_times):
    times = {**nod_times, "stroke:2": 0.9, "stroke:3": 1.5, "strokeEnd": 2.0, "relax": 2.0, "end": 2.0}
    layer = head_layer(
        head_form(Head("NOD", repetition=3, amount=1.0), robot, Expressivity()), times, pace, Expressivity()
    )
    for time in (0.5, 0.9, 1.5):
        assert degrees(turn_at(layer, time).tilt) == pytest.approx(20)
    assert turn_at(layer, 0.7).tilt == turn_at(layer, 2.0).tilt == 0


def test_nod_without_time_after_its_stroke_still_returns(robot, pace, phases):
    layer = head_layer(head_form(Head("NOD"), robot, Expressivity()), phases(1, 1, 1, 1, 1, 1, 1), pace, Expressivity())
    assert layer[0].time < 1 < layer[-1].time
    assert layer[0].turn.tilt == layer[-1].turn.tilt == 0
    assert turn_at(layer, 1.0).tilt > 0


def test_head_shake_goes_to_both_sides(robot, pace, nod_times):
    layer = head_layer(head_form(Head("SHAKE", amount=0.4), robot, Expressivity()), nod_times, pace, Expressivity())
    turns = [round(degrees(key.turn.torsion), 6) for key in layer]
    assert max(turns) == 10
    assert min(turns) == -10
    assert degrees(turn_at(layer, 0.5).torsion) == pytest.approx(10)


@pytest.mark.parametrize(
    ("lexeme", "torsion", "tilt", "roll"),
    [
        ("Down_Aside_Right", 0, 15, 15),
        ("Aside_Left", 0, 0, -15),
        ("Up_Left", 15, -15, 0),
        ("Right", -15, 0, 0),
        ("DOWN", 0, 15, 0),
        ("Rightward", -15, 0, 0),
        ("TILT", 0, 0, 15),
        ("TURN_LEFT_SMALL", 7.5, 0, 0),
        ("TOSS", 0, -15, 0),
        ("Neutral", 0, 0, 0),
    ],
)
def test_words_of_a_head_lexeme_set_the_head_direction(robot, lexeme, torsion, tilt, roll):
    form = head_form(Head(lexeme), robot, Expressivity())
    assert form.substitute == ""
    peak = form.peak
    assert [degrees(angle) for angle in (peak.torsion, peak.tilt, peak.roll)] == pytest.approx([torsion, tilt, roll])


def test_head_direction_is_held_until_relax(robot, pace, nod_times):
    layer = head_layer(head_form(Head("Left"), robot, Expressivity()), nod_times, pace, Expressivity())
    assert turn_at(layer, 0.5) == turn_at(layer, 0.9) == head_form(Head("Left"), robot, Expressivity()).peak
    assert 0 < turn_at(layer, 0.1).torsion < turn_at(layer, 0.5).torsion
    assert turn_at(layer, 1.0).torsion == 0


@pytest.mark.parametrize(
    ("lexeme", "kind"), [("SPIN", "shake"), ("", "nod"), ("ROTATION", "nod"), ("nod_merrily", "nod")]
)
def test_inexact_or_empty_head_lexeme_is_substituted_by_a_nod_or_shake_with_a_notice(
    perform, nod_times, lexeme, kind, robot
):
    assert head_form(Head(lexeme), robot, Expressivity()).kind == kind
    frames = perform(("h", Head(lexeme), nod_times))
    assert frames.outcomes["h"].kind == "substituted"
    assert kind in frames.outcomes["h"].why
    assert [notice.id for notice in frames.notices] == ["bml1:h"]


@pytest.mark.parametrize("lexeme", ["upset", "uproar", "downtown", "leftover", "handshake", "JOY_SIGNAL", "Y"])
def test_unknown_head_lexeme_is_dropped_and_named(perform, nod_times, lexeme):
    frames = perform(("h", Head(lexeme), nod_times))
    assert frames.outcomes["h"].kind == "dropped"
    assert lexeme in frames.outcomes["h"].why
    assert frames.uses["h"] == frozenset()


@pytest.mark.parametrize("lexeme", ["UP", "TILT", "LEFT"])
def test_repeated_head_direction_peaks_at_each_stroke_sync_point(robot, pace, nod_times, lexeme):
    times = {**nod_times, "stroke:2": 0.9, "stroke:3": 1.5, "strokeEnd": 2.0, "relax": 2.0, "end": 2.0}
    form = head_form(Head(lexeme, repetition=3), robot, Expressivity())
    layer = head_layer(form, times, pace, Expressivity())
    assert form.peak == head_form(Head(lexeme), robot, Expressivity()).peak
    assert {turn_at(layer, time) for time in (0.5, 0.9, 1.5)} == {form.peak}
    assert {turn_at(layer, time) for time in (0.7, 1.2, 2.0)} == {UPRIGHT_TURN}


@pytest.mark.parametrize("head", [Head("NEUTRAL", repetition=3), Head("NOD", repetition=3, amount=0.0)])
def test_head_movement_of_zero_amplitude_has_no_repeated_stroke_sync_points(perform, nod_times, head):
    times = {**nod_times, "stroke:2": 0.9, "stroke:3": 1.5, "strokeEnd": 2.0, "relax": 2.0, "end": 2.0}
    frames = perform(("h", head, times))
    assert frames.outcomes["h"].kind == "substituted"
    assert "upright" in frames.outcomes["h"].why
    syncs = {sync for frame in frames.frames for _, sync in frame.syncs}
    assert {"start", "stroke", "end"} <= syncs
    assert not {"stroke:2", "stroke:3"} & syncs


def test_repeated_nod_has_a_sync_point_for_each_stroke(perform, nod_times):
    times = {**nod_times, "stroke:2": 0.9, "stroke:3": 1.5, "strokeEnd": 2.0, "relax": 2.0, "end": 2.0}
    frames = perform(("h", Head("NOD", repetition=3), times))
    assert frames.outcomes["h"].kind == "realised"
    assert {"stroke:2", "stroke:3"} <= {sync for frame in frames.frames for _, sync in frame.syncs}


def test_big_nod_has_1_5_times_the_amplitude_of_a_middle_nod(robot):
    big, middle = (head_form(Head(lexeme), robot, Expressivity()).peak.tilt for lexeme in ("Nod_Big", "Nod_Middle"))
    assert big == pytest.approx(1.5 * middle)


def test_spatial_extent_increases_the_nod_amplitude(robot):
    peaks = [head_form(Head("NOD"), robot, Expressivity(spatial=spatial)).peak.tilt for spatial in (-1.0, 0.0, 1.0)]
    assert peaks == sorted(peaks)
    assert peaks[0] > 0


def test_head_direction_shift_is_permanent(perform, phases):
    frames = perform(("s", HeadDirectionShift("Aside_Left"), phases(0, 0.5, 0.5, 0.5, 0.5, 0.5, 0.5)))
    assert degrees(frames.frames[-1].head.roll) == pytest.approx(-15)


def test_repetition_adds_only_nods_that_fit(robot, pace, phases):
    form = head_form(Head("NOD"), robot, Expressivity(repetition=1.0))
    assert (form.repetition, form.added_strokes) == (1, MAX_ADDED_STROKES)
    assert head_form(Head("Left"), robot, Expressivity(repetition=1.0)).added_strokes == 0
    assert head_form(Head("NOD", repetition=3), robot, Expressivity(repetition=-1.0)).added_strokes == 0

    def peaks(end):
        layer = head_layer(form, phases(0.0, 0.1, 0.2, 0.5, end, end, end), pace, Expressivity())
        assert turn_at(layer, 0.5).tilt == pytest.approx(form.peak.tilt)
        assert turn_at(layer, end).tilt == pytest.approx(0.0)
        return sum(key.turn == form.peak for key in layer)

    least = pace.least_turn_time("neck", form.peak)
    assert [peaks(0.5 + swings * least + 0.01) for swings in (1, 3, 5, 9)] == [1, 2, 3, 3]


def test_temporal_extent_and_power_shorten_a_head_swing(robot, pace):
    form = head_form(Head("NOD"), robot, Expressivity())
    usual = swing_time(form, pace, Expressivity())
    assert usual >= NOD_SWING_TIME
    for name in ("temporal", "power"):
        slow, quick = (swing_time(form, pace, Expressivity(**{name: extent})) for extent in (-1.0, 1.0))
        assert quick < usual < slow


def test_head_keys_have_spline_parameters_of_the_expressivity(robot, pace, nod_times):
    manner = Expressivity(tension=0.5, power=1.0)
    nod = head_layer(head_form(Head("NOD"), robot, manner), nod_times, pace, manner)
    peak = next(key for key in nod if key.turn.tilt > 0)
    assert peak.passage == passage_of(manner, "stroke")
    held = head_layer(head_form(Head("Left"), robot, manner), nod_times, pace, manner)
    assert [key.passage for key in held] == [
        passage_of(manner, phase) for phase in ("retraction", "preparation", "stroke", "hold", "retraction")
    ]


def test_head_direction_hold_takes_its_natural_time_if_sync_points_coincide(robot, pace, phases):
    form, manner = head_form(Head("Left"), robot, Expressivity()), Expressivity()
    natural = swing_time(form, pace, manner)
    hasty = head_layer(form, phases(1, 1, 1, 1, 1, 2, 2), pace, manner)
    assert [key.time for key in hasty] == pytest.approx([1 - natural, 1, 2, 2 + natural])
    brief = head_layer(form, phases(0, 0.5, 0.5, 1, 1, 1, 1), pace, manner)
    assert [key.time for key in brief] == pytest.approx([0, 0.5, 1, 1 + natural])
    early = head_layer(form, phases(0, 0.5, 0.5, 2, 2, 1, 3), pace, manner)  # Relaxes before its stroke
    assert [key.time for key in early] == pytest.approx([0, 0.5, 2, 3])


@pytest.mark.parametrize("ready", [0.001, 0.999])
def test_head_direction_has_no_key_at_a_ready_point_close_to_other_sync_points(robot, pace, phases, ready):
    layer = head_layer(
        head_form(Head("Left"), robot, Expressivity()), phases(0, ready, ready, 1, 1, 2, 3), pace, Expressivity()
    )
    assert [key.time for key in layer] == [0, 1, 2, 3]


@pytest.mark.parametrize(
    ("kind", "count", "swings"),
    [
        ("nod", 1, (1, 0)),
        ("nod", 2, (1, 0, 1, 0)),
        ("shake", 1, (1, -1, 1, 0)),
        ("shake", 2, (1, -1, 1, -1, 1, 0)),
        ("direction", 3, (1,)),
    ],
)
def test_nods_and_shakes_end_upright_and_head_directions_are_held(kind, count, swings):
    assert HeadForm(kind, UPRIGHT_TURN, count).swings == swings


def test_nod_without_a_requested_duration_takes_its_natural_time(robot, pace, phases):
    manner = Expressivity()
    form = head_form(Head("NOD", repetition=2), robot, manner)
    natural = swing_time(form, pace, manner)
    keys = head_layer(form, phases(1, 1, 1, 1, 1, 1, 1), pace, manner)
    assert [key.time for key in keys] == pytest.approx([1 - natural, 1, 1 + natural, 1 + 2 * natural, 1 + 3 * natural])
    assert [key.turn.tilt > 0 for key in keys] == [False, True, False, True, False]


def test_nod_ends_at_the_first_sync_point_after_the_stroke(robot, pace, phases):
    form = head_form(Head("NOD"), robot, Expressivity())
    for times, ends in (((0, 1, 1, 2, 3, 4, 5), 3), ((0, 1, 1, 2, 2, 4, 5), 4), ((0, 1, 1, 2, 2, 2, 5), 5)):
        keys = head_layer(form, phases(*times), pace, Expressivity())
        assert [key.time for key in keys if key.time >= 2][:2] == [2, ends]


def test_head_waits_upright_before_and_after_its_swings(robot, pace, phases):
    form = head_form(Head("NOD"), robot, Expressivity())
    keys = head_layer(form, phases(0, 1, 1, 1.5, 2, 3, 4), pace, Expressivity())
    assert [(key.time, key.turn == UPRIGHT_TURN) for key in keys] == [
        (0, True),
        (1, True),
        (1.5, False),
        (2, True),
        (4, True),
    ]


def test_nods_with_no_time_or_a_time_too_close_to_another_nod_are_spread_over_the_free_time(robot, pace, nod_times):
    form = head_form(Head("NOD", repetition=4), robot, Expressivity())
    times = {**nod_times, "stroke": 1.0, "stroke:2": 1.001, "stroke:3": 3.0, "strokeEnd": 6.0, "relax": 6.0, "end": 6.0}
    peaks = [key.time for key in head_layer(form, times, pace, Expressivity()) if key.turn == form.peak]
    assert peaks == pytest.approx([1.0, 2.0, 3.0, 5.0])


def test_nod_that_ends_too_early_returns_in_its_natural_time(robot, pace, nod_times):
    form = head_form(Head("NOD", repetition=2), robot, Expressivity())
    early = {**nod_times, "stroke": 1.0, "strokeEnd": 1.0, "relax": 1.0, "end": 1.0}
    times = [key.time for key in head_layer(form, early, pace, Expressivity())]
    natural = times[-1] - times[-2]
    assert np.diff(times[-4:]) == pytest.approx([natural] * 3)
    pinned = {**early, "stroke:2": 2.0, "strokeEnd": 2.0, "relax": 2.0, "end": 2.0}
    times = [key.time for key in head_layer(form, pinned, pace, Expressivity())]
    assert times[-4:] == pytest.approx([1.0, 1.5, 2.0, 2.0 + natural])


def test_nod_stroke_time_that_is_out_of_order_is_ignored(robot, pace, nod_times):
    form = head_form(Head("NOD", repetition=3), robot, Expressivity())
    times = {**nod_times, "stroke": 1.0, "stroke:2": 2.0, "stroke:3": 1.5, "strokeEnd": 5.0, "relax": 5.0, "end": 5.0}
    peaks = [key.time for key in head_layer(form, times, pace, Expressivity()) if key.turn == form.peak]
    assert peaks == pytest.approx([1.0, 2.0, 4.0])


def test_added_nods_are_proportional_to_repetition(robot):
    added = [
        head_form(Head("NOD"), robot, Expressivity(repetition=share)).added_strokes for share in (-1.0, 0.0, 0.5, 1.0)
    ]
    assert added == [0, 0, MAX_ADDED_STROKES // 2, MAX_ADDED_STROKES]


def test_head_direction_with_two_repetitions_peaks_twice(robot):
    assert head_form(Head("LEFT", repetition=2), robot, Expressivity()).swings == (1.0, 0.0, 1.0, 0.0)


def test_fastest_head_shake_takes_longer_than_the_minimum_time_of_the_neck(pace, robot):
    form = head_form(Head("SHAKE"), robot, Expressivity())
    quick = swing_time(form, pace, Expressivity(temporal=1.0, power=1.0))
    assert quick > pace.least_turn_time("neck", scale_turn(form.peak, 2.0))
    assert quick < swing_time(form, pace, Expressivity(temporal=-1.0))
