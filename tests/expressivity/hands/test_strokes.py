import re
from dataclasses import replace

import numpy as np
import pytest

from kinesic.body.arrays import sealed
from kinesic.expressivity.hands import strokes
from kinesic.expressivity.hands.phases import arrange_hands
from kinesic.expressivity.hands.poses import pose_distance, poses
from kinesic.expressivity.hands.strokes import Stroke, natural_times, stroke_key_times, stroke_keys, time_stroke
from kinesic.expressivity.lexicon.form import GestureForm, HandPose, StrokeKey
from kinesic.expressivity.lexicon.lexicon import mirror_form
from kinesic.expressivity.lexicon.paths import shape_path
from kinesic.expressivity.style.effort import Effort
from kinesic.expressivity.style.style import Expressivity

NEUTRAL = Expressivity()
FIRST_POSITION, SECOND_POSITION = sealed([0.55, 0.3, 0.5]), sealed([0.55, 0.5, 0.4])


def form(*positions, path=None):
    """Return a right-handed form with a path to its last key."""
    keys = [StrokeKey({"r": HandPose(position, palm=sealed([1.0, 0, 0]))}) for position in positions]
    keys[-1] = StrokeKey({"r": replace(keys[-1].hands["r"], path=path)})
    return GestureForm("own", "iconic", tuple(keys))


CIRCLE_FORM = form(FIRST_POSITION, FIRST_POSITION, path=shape_path("circle"))
WAVE_FORM = form(FIRST_POSITION, FIRST_POSITION, path=shape_path("wave", frequency=4.0))
TWO_KEY_FORM = form(FIRST_POSITION, SECOND_POSITION)
REPEATED_FORM = form(FIRST_POSITION, SECOND_POSITION, FIRST_POSITION, SECOND_POSITION)  # Duplicate entry


@pytest.fixture
def done(robot, pace, phases):
    """Return a form's timed stroke and its keys.

    The arguments are strokeStart, stroke and strokeEnd.
    """

    def run(form, *times, manner=NEUTRAL):
        start, stroke, end = times
        asked = phases(start - 1, start, start, stroke, end, end, end + 1)
        work = time_stroke(
            Stroke("g", asked, (poses(form, robot, manner),), manner=manner), poses(form, robot, manner), pace
        )
        return work, stroke_keys(work, "r", pace)

    return run


def test_hand_path_is_sampled_as_keys_between_the_stroke_keys(robot, done):
    _, keys = done(CIRCLE_FORM, 1.0, 2.0, 2.0)
    assert keys[0].time == 1.0
    assert keys[-1].time == 2.0
    places = np.array([key.hand.reach.position for key in keys])
    np.testing.assert_array_equal(places[0], places[-1])
    centre = places[0] - [0, 0, 0.12 * robot.arm_length]
    np.testing.assert_allclose(np.linalg.norm(places - centre, axis=1), 0.12 * robot.arm_length, atol=1e-9)
    assert [key.hand.passing for key in keys] == [False, *[True] * (len(keys) - 2), False]
    assert len(keys) >= 9


def test_palm_direction_changes_steadily_along_a_hand_path(robot, done):
    turned = form(FIRST_POSITION, SECOND_POSITION, path=shape_path("arc"))
    last = turned.keys[1].hands["r"]
    turned = replace(turned, keys=(turned.keys[0], StrokeKey({"r": replace(last, palm=sealed([0, 0, -1.0]))})))
    _, keys = done(turned, 1.0, 2.0, 2.0)
    palms = np.array([key.hand.reach.palm for key in keys])
    np.testing.assert_allclose(np.linalg.norm(palms, axis=1), 1.0)
    assert np.all(np.diff(palms[:, 2]) < 0)


def test_number_of_path_keys_depends_on_path_size_and_not_on_duration(done):
    small, large = (
        form(FIRST_POSITION, FIRST_POSITION, path=shape_path("circle", amplitude=size)) for size in (0.03, 0.3)
    )
    counts = [len(done(one, 1.0, end, end)[1]) for one in (small, large) for end in (2.0, 4.0)]
    assert counts[0] == counts[1] < counts[2] == counts[3]


def test_keys_of_a_hand_path_keep_the_minimum_spacing(done):
    _, keys = done(CIRCLE_FORM, 1.0, 1.1, 1.1)
    assert np.diff([key.time for key in keys]).min() >= 0.02 - 1e-9


def test_too_fast_wave_gets_fewer_turns_and_a_remark(done):
    fast, _ = done(WAVE_FORM, 1.0, 1.6, 1.6)
    slow, _ = done(WAVE_FORM, 1.0, 6.0, 6.0)
    assert slow.remarks == ()
    assert fast.poses.path("r", 1).turns < 4
    assert "of its 4 turns: in 0.60 s" in fast.remarks[0]


def test_slowed_wave_keeps_its_amplitude_and_lateral_end_positions(done):
    work, keys = done(WAVE_FORM, 1.0, 1.8, 1.8)
    out = [key.hand.reach.position[1] for key in keys]
    assert out[0] == out[-1]
    np.testing.assert_array_equal(
        work.poses.path("r", 1).amplitude, done(WAVE_FORM, 1, 9, 9)[0].poses.path("r", 1).amplitude
    )


def test_path_amplitude_follows_spatial_extent_except_on_fixed_axes(robot):
    sizes = [poses(CIRCLE_FORM, robot, Expressivity(spatial=s)).path("r", 1).amplitude for s in (-1.0, 0.0, 1.0)]
    assert abs(sizes[0][1]) < abs(sizes[1][1]) < abs(sizes[2][1])
    hand = replace(CIRCLE_FORM.keys[1].hands["r"], fixed=(False, True, True))
    fixed = replace(CIRCLE_FORM, keys=(CIRCLE_FORM.keys[0], StrokeKey({"r": hand})))
    np.testing.assert_allclose(poses(fixed, robot, Expressivity(spatial=1.0)).path("r", 1).amplitude, sizes[1])


def test_left_and_right_hand_paths_are_mirrored(robot, pace, done):
    kinds = [
        shape_path("spiral"),
        shape_path("points", points=(sealed([0.5, 0.4, 0.2]),)),
        shape_path("wave", shift=0.1),
    ]
    for path in kinds:
        one = form(FIRST_POSITION, SECOND_POSITION, path=path)
        work, keys = done(one, 1.0, 3.0, 3.0)
        other = time_stroke(work.stroke, poses(mirror_form(one), robot, NEUTRAL), pace)
        for a, b in zip(keys, stroke_keys(other, "l", pace), strict=True):
            assert a.time == pytest.approx(b.time, abs=1e-12)
            np.testing.assert_allclose(a.hand.reach.position * [1, -1, 1], b.hand.reach.position, atol=1e-12)


def test_hand_motion_along_a_path_takes_longer_than_a_straight_one(robot, pace):
    arc, straight = (
        poses(one, robot, NEUTRAL)
        for one in (form(FIRST_POSITION, SECOND_POSITION, path=shape_path("arc")), TWO_KEY_FORM)
    )
    assert natural_times(arc, Effort(pace))[0] > natural_times(straight, Effort(pace))[0]
    once, twice = (
        natural_times(
            poses(form(FIRST_POSITION, FIRST_POSITION, path=shape_path("wave", frequency=f)), robot, NEUTRAL),
            Effort(pace),
        )[0]
        for f in (1.0, 2.0)
    )
    assert twice == pytest.approx(2 * once, rel=0.01)


def test_power_parameter_increases_hand_velocity_in_the_middle_of_a_path(done):
    shares = []
    for power in (-1.0, 0.0, 1.0):
        _, keys = done(CIRCLE_FORM, 1.0, 2.0, 2.0, manner=Expressivity(power=power))
        times = np.array([key.time for key in keys])
        shares.append(np.diff(times)[len(times) // 2])
    assert shares[0] > shares[1] > shares[2]


@pytest.mark.parametrize(("one", "written"), [(TWO_KEY_FORM, 1), (CIRCLE_FORM, 1), (REPEATED_FORM, 2)])
def test_number_of_strokes_grows_with_the_repetition_parameter(robot, one, written):
    times = [poses(one, robot, Expressivity(repetition=r)).stroke_count for r in (-1.0, -0.4, 0.0, 0.2, 0.5, 0.8, 1.0)]
    assert times == sorted(times)
    assert times[2] == written
    assert times[0] == max(1, written - 1)
    assert times[-1] == written + 2


def test_repeated_circular_gesture_continues_without_an_intermediate_key(robot):
    work = poses(CIRCLE_FORM, robot, Expressivity(repetition=1.0))
    assert work.count == 4
    assert work.again == (2, 3)
    assert [path and path.kind for path in work.paths["r"]] == [None, "circle", "circle", "circle"]


def test_repeated_strokes_follow_the_first_stroke_at_natural_intervals(robot, pace, phases):
    thrice = poses(TWO_KEY_FORM, robot, Expressivity(repetition=1.0))
    natural = natural_times(thrice, Effort(pace))
    times = phases(0, 0.6, 0.6, 1.0, 1.0, 1.0, 1.5) | {"strokeEnd": 1.0 + sum(natural[1:]), "relax": 9.0, "end": 10.0}
    numbered = times | {"stroke:2": 1.0 + sum(natural[1:3]), "stroke:3": 1.0 + sum(natural[1:5])}
    for asked in (times, numbered):
        key_times = stroke_key_times(thrice, asked, pace)
        assert key_times[1] == 1.0
        assert key_times[3] == pytest.approx(numbered["stroke:2"])
        assert key_times[5] == pytest.approx(numbered["stroke:3"])


def test_repeated_stroke_keys_are_at_their_numbered_sync_points(robot, pace, phases):
    thrice = poses(TWO_KEY_FORM, robot, Expressivity(repetition=1.0))
    times = phases(0, 0.6, 0.6, 1.0, 4.0, 4.0, 5.0) | {"stroke:2": 2.5, "stroke:3": 3.9}
    key_times = stroke_key_times(thrice, times, pace)
    assert (key_times[1], key_times[3], key_times[5]) == (1.0, 2.5, 3.9)


@pytest.mark.parametrize(("end", "times"), [(1.0, 1), (1.05, 1), (9.0, 3)])
def test_stroke_repetitions_that_do_not_fit_are_dropped(done, end, times):
    work, _ = done(TWO_KEY_FORM, 0.6, 1.0, end, manner=Expressivity(repetition=1.0))
    assert work.poses.stroke_count == times
    assert bool(work.remarks) == (times < 3)
    assert all("its stroke is done once, not 3" in remark for remark in work.remarks)


def test_remark_about_dropped_repetitions_names_the_shortest_time_that_suffices_for_all(done):
    manner = Expressivity(repetition=1.0)
    work, _ = done(TWO_KEY_FORM, 0.6, 1.0, 1.0, manner=manner)
    needed = float(re.search(r"of (\d+\.\d\d) s for all", work.remarks[0])[1])
    assert done(TWO_KEY_FORM, 0.6, 1.0, 1.0 + needed, manner=manner)[0].remarks == ()
    assert done(TWO_KEY_FORM, 0.6, 1.0, 1.0 + needed - 0.02, manner=manner)[0].remarks != ()


def test_gesture_without_a_hand_path_has_no_intermediate_keys(robot, pace, phases):
    stroke = Stroke("g", phases(0, 0.6, 0.6, 1.0, 1.0, 1.2, 1.8), (poses(TWO_KEY_FORM, robot, NEUTRAL),))
    assert [key.time for key in arrange_hands([stroke], pace).hands["r"]] == pytest.approx([0, 0.6, 1.0, 1.2, 1.8])


def test_natural_phase_durations_of_equal_gestures_are_computed_only_once(robot, pace, monkeypatch):
    measured = []
    monkeypatch.setattr(strokes, "pose_distance", lambda *way: measured.append(way) or pose_distance(*way))
    natural_times(poses(TWO_KEY_FORM, robot, Expressivity(spatial=0.123)), Effort(pace))
    assert measured
    first = len(measured)
    natural_times(poses(TWO_KEY_FORM, robot, Expressivity(spatial=0.123)), Effort(pace))
    assert len(measured) == first
