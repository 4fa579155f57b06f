from dataclasses import replace

import numpy as np
import pytest

from kinesic.body.arrays import sealed
from kinesic.expressivity.style.effort import (
    ACCENT_MARGIN,
    CATEGORY_PROFILES,
    LOOSENESS_REDUCTION,
    MIN_TIME_RATIO,
    PATH_START_VELOCITY,
    STROKE_ACCENT,
    TEMPO_FACTORS,
    Effort,
    GestureTraits,
)
from kinesic.expressivity.style.pace import TEMPORAL_FACTOR, Pace
from kinesic.expressivity.style.passage import MIN_LATE_ACCENT, passage_of
from kinesic.expressivity.style.style import NEUTRAL_EXPRESSIVITY, Expressivity
from kinesic.motion.keys import (
    ACCENT_EASING,
    LATE_ACCENT_EASING,
    LINEAR_STEEPNESS,
    MAX_STEEPNESS,
    MIN_STEEPNESS,
    KeyPassage,
)

DISTANCES = np.linspace(0.02, 0.8, 27)
EXTENT_VALUES = np.linspace(-1.0, 1.0, 9)
PHASE_METHODS = ("preparation_time", "joining_time", "stroke_time", "return_time")
POSE_TRAITS = GestureTraits("emblem", dynamic=False)


@pytest.fixture(scope="module")
def sluggish(pace):
    """Return the robot with a quarter of the velocity, acceleration and jerk limits."""
    slow = {name: sealed(getattr(pace.limits, name) / 4) for name in ("speed", "acceleration", "jerk")}
    return Pace(pace.robot, replace(pace.limits, **slow))


@pytest.fixture
def efforts(pace, sluggish):
    """Return efforts of all categories and tempos on two robots."""
    all_traits = [
        GestureTraits(category, tempo, dynamic)
        for category in (*CATEGORY_PROFILES, "own")
        for tempo in TEMPO_FACTORS
        for dynamic in (True, False)
    ]
    return [Effort(robot, traits) for robot in (pace, sluggish) for traits in all_traits]


@pytest.mark.parametrize("phase", PHASE_METHODS)
def test_longer_hand_movement_takes_longer_and_has_a_higher_velocity(efforts, phase):
    for effort in efforts:
        times = np.array([getattr(effort, phase)(distance) for distance in DISTANCES])
        assert np.all(np.diff(times) > 0.0)
        assert np.all(np.diff(DISTANCES / times) > 0.0)


@pytest.mark.parametrize("phase", PHASE_METHODS)
@pytest.mark.parametrize(
    "manner", [Expressivity(temporal=1.0), Expressivity(power=1.0), Expressivity(1.0, 1.0, 1.0, 1.0)]
)
def test_extreme_expressivity_keeps_the_minimum_times_of_the_servos(efforts, phase, manner):
    for effort in efforts:
        hurried = replace(effort, manner=manner)
        assert all(getattr(hurried, phase)(distance) >= effort.pace.least_hand_time(distance) for distance in DISTANCES)


@pytest.mark.parametrize("phase", PHASE_METHODS)
def test_temporal_extent_shortens_every_movement_phase(efforts, phase):
    for effort in efforts:
        for distance in DISTANCES[::9]:
            manners = (replace(effort, manner=Expressivity(temporal=extent)) for extent in EXTENT_VALUES)
            times = [getattr(manner, phase)(distance) for manner in manners]
            assert np.all(np.diff(times) < 0.0)
            assert times[0] == pytest.approx(TEMPORAL_FACTOR * times[4])


def test_zero_effort_weight_gives_durations_by_fitts_law(efforts):
    for effort in efforts:
        none, half = (replace(effort, traits=replace(effort.traits, weight=weight)) for weight in (0.0, 0.5))
        for distance in DISTANCES[::5]:
            fitts, minimum = 0.1 + 0.15 * np.log2(distance / 0.05 + 1.0), effort.pace.least_hand_time(distance)
            assert none.stroke_time(distance) == pytest.approx(max(fitts, 2.4 * minimum))
            for name in ("preparation_time", "joining_time", "return_time"):
                assert getattr(none, name)(distance) == pytest.approx(max(fitts, 1.3 * minimum)), name
            for name in PHASE_METHODS:
                both = [getattr(item, name)(distance) for item in (none, half, effort)]
                assert both[1] == pytest.approx((both[0] + both[2]) / 2)
        assert none.hold_time(0.8) == pytest.approx(0.4)
        for phase in ("preparation", "stroke", "hold", "retraction"):
            assert (
                none.passage(phase)
                == replace(none, spoken=True).passage(phase)
                == passage_of(NEUTRAL_EXPRESSIVITY, phase)
            )


def test_overshoot_and_velocity_accent_of_a_stroke_grow_with_the_effort_weight(pace):
    passages = [Effort(pace, GestureTraits(weight=weight)).passage("stroke") for weight in (0.0, 0.5, 1.0)]
    assert passages[0].swing == 0.0 < passages[1].swing < passages[2].swing
    assert passages[1].steepness < passages[2].steepness == MIN_STEEPNESS + STROKE_ACCENT
    homes = [Effort(pace, GestureTraits(weight=weight)).passage("retraction").steepness for weight in (0.5, 1.0)]
    assert LINEAR_STEEPNESS < homes[0] < homes[1]


def test_high_power_shortens_only_the_stroke_of_a_gesture_and_low_power_slows_all_phases(pace):
    plain, strong, weak = (Effort(pace, GestureTraits("beat"), Expressivity(power=power)) for power in (0.0, 1.0, -1.0))
    assert strong.stroke_time(0.1) < plain.stroke_time(0.1) < weak.stroke_time(0.1)
    for phase in ("preparation_time", "return_time"):
        times = [getattr(item, phase)(0.3) for item in (strong, plain, weak)]
        assert times[0] == times[1] < times[2]
    assert len({item.hold_time(0.5) for item in (strong, plain, weak)}) == 1


def test_sudden_tempo_of_a_gesture_shortens_preparation_and_stroke_but_not_retraction(pace):
    sudden, plain, sustained = (Effort(pace, GestureTraits("iconic", tempo)) for tempo in TEMPO_FACTORS)
    for phase in ("preparation_time", "stroke_time"):
        times = [getattr(item, phase)(0.1) for item in (sudden, plain, sustained)]
        assert times[0] < times[1] < times[2]
    assert sudden.return_time(0.3) == plain.return_time(0.3) < sustained.return_time(0.3)


def test_hand_retraction_takes_longer_than_a_transition_between_gestures(efforts, pace):
    own = [effort for effort in efforts if effort.pace is pace]
    assert all(
        effort.return_time(distance) > effort.joining_time(distance) for effort in own for distance in (0.2, 0.4, 0.6)
    )


def test_slow_gesture_tempo_does_not_slow_the_transition_between_gestures(pace):
    slow, plain = Effort(pace, GestureTraits("adaptor", "sustained")), Effort(pace)
    assert slow.joining_time(0.3) == plain.joining_time(0.3) < slow.preparation_time(0.3)


def test_hold_time_of_a_gesture_is_proportional_to_its_stroke_time_but_constant_for_poses(pace):
    stroke, pose = Effort(pace, GestureTraits("emblem")), Effort(pace, POSE_TRAITS)
    assert stroke.hold_time(1.2) == pytest.approx(2 * stroke.hold_time(0.6))
    assert pose.hold_time(0.1) == pose.hold_time(2.0) > stroke.hold_time(0.6)


def test_keys_of_moving_strokes_keep_more_velocity_than_those_of_static_poses(pace):
    stroke, pose = Effort(pace), Effort(pace, POSE_TRAITS)
    assert stroke.passage("preparation").flow > 1.0
    assert stroke.passage("stroke").flow > 1.0
    assert pose.passage("preparation").flow == 1.0
    assert pose.passage("preparation", time_ratio=0.0) == pose.passage("stroke") == passage_of(Expressivity(), "stroke")
    assert pose.passage("preparation").swing == 0.0
    assert stroke.passage("hold") == pose.passage("hold") == passage_of(Expressivity(), "hold")


def test_full_tension_stops_the_hand_at_the_preparation_key(pace):
    assert Effort(pace, manner=Expressivity(tension=1.0)).passage("preparation").flow == 0.0


def test_initial_path_velocity_falls_with_tension_and_is_zero_for_strokes_on_words(pace):
    efforts = [Effort(pace, manner=Expressivity(tension=tension)) for tension in (0.0, 0.25, 0.5)]
    velocities = [effort.path_start_velocity(effort.passage("preparation", led=True)) for effort in efforts]
    assert PATH_START_VELOCITY == velocities[0] > velocities[1] > velocities[2] == 0.0
    spoken = Effort(pace, spoken=True)
    assert spoken.path_start_velocity(spoken.passage("preparation", led=True)) == 0.0


def test_overshoot_and_velocity_accent_of_a_stroke_fade_if_time_is_short(pace):
    passages = [Effort(pace).passage("stroke", time_ratio=share) for share in (0.0, MIN_TIME_RATIO, 0.8, 0.9, 1.0, 2.0)]
    swings, accents = [item.swing for item in passages], [item.steepness for item in passages[2:]]
    assert swings[0] == swings[1] == 0.0 < swings[2] < swings[3] < swings[4] == swings[5]
    assert accents[0] < accents[1] < accents[2] == accents[3] == MIN_STEEPNESS + STROKE_ACCENT
    assert passages[0] == passages[1] == passage_of(Expressivity(), "stroke")


def test_preparation_of_a_gesture_and_motion_along_a_hand_path_have_no_velocity_accent(pace):
    effort = Effort(pace)
    assert effort.passage("preparation").easing == "minimum_jerk"
    assert effort.passage("stroke", led=True).easing == "minimum_jerk"
    assert 0.0 < effort.passage("stroke", led=True).swing < effort.passage("stroke").swing


def test_stroke_tied_to_a_word_has_a_late_velocity_peak_and_less_initial_overshoot(pace):
    plain, spoken = Effort(pace), Effort(pace, spoken=True)
    assert (plain.passage("stroke").easing, spoken.passage("stroke").easing) == (ACCENT_EASING, LATE_ACCENT_EASING)
    assert spoken.passage("stroke").steepness > plain.passage("stroke").steepness
    assert 0.0 < spoken.passage("preparation").swing < plain.passage("preparation").swing
    assert spoken.passage("hold") == plain.passage("hold")
    pose = Effort(pace, POSE_TRAITS, spoken=True)
    assert (pose.passage("stroke").easing, pose.passage("stroke").swing) == (LATE_ACCENT_EASING, 0.0)
    for manner in ({"power": 1.0, "tension": 1.0}, {"fluidity": -1.0}):  # Beyond the range of an easing
        assert Effort(pace, manner=Expressivity(**manner), spoken=True).passage("stroke").steepness == MAX_STEEPNESS
    for manner in ({"fluidity": 1.0}, {"tension": -1.0}, {"power": 0.8}, {"tension": 0.8}, {"power": -1.0}):
        assert Effort(pace, manner=Expressivity(**manner), spoken=True).passage("stroke").easing == LATE_ACCENT_EASING


def test_velocity_accent_of_a_stroke_on_a_word_remains_at_low_power_and_tension(pace):
    for manner in (
        {"power": -1.0},
        {"power": -1.0, "fluidity": 1.0, "tension": -1.0},
        {"power": -0.5, "fluidity": 1.0},
    ):
        spoken = Effort(pace, manner=Expressivity(**manner), spoken=True)
        assert spoken.passage("stroke").steepness >= MIN_STEEPNESS + MIN_LATE_ACCENT
        assert spoken.passage("stroke", time_ratio=MIN_TIME_RATIO).easing != LATE_ACCENT_EASING
        assert spoken.passage("stroke", stroke=False).easing != LATE_ACCENT_EASING


def test_only_the_stroke_movement_that_ends_at_a_word_has_a_velocity_accent(pace):
    spoken = Effort(pace, spoken=True)
    assert spoken.passage("stroke", stroke=False) == replace(
        Effort(pace).passage("stroke"), easing="minimum_jerk", steepness=KeyPassage().steepness
    )
    fluid = Expressivity(fluidity=1.0)
    assert spoken.passage("preparation") == replace(spoken, manner=fluid).passage("preparation")
    assert Effort(pace, manner=fluid).passage("preparation").flow > Effort(pace).passage("preparation").flow


def test_full_power_removes_the_overshoot_of_the_preparation_and_changes_nothing_else_in_it(pace):
    strong, plain = Effort(pace, manner=Expressivity(power=1.0)), Effort(pace)
    assert strong.passage("preparation") == replace(plain.passage("preparation"), swing=0.0)
    assert strong.passage("stroke").steepness > plain.passage("stroke").steepness


def stroke_passages(pace, name, values=(-1.0, -0.5, 0.0, 0.5, 1.0)):
    """Return the passages of a stroke key for five parameter values."""
    return [Effort(pace, manner=Expressivity(**{name: value})).passage("stroke") for value in values]


@pytest.mark.parametrize("name", ["tension", "power"])
def test_power_and_tension_reduce_overshoot_at_keys(pace, name):
    swings = [stroke_passage.swing for stroke_passage in stroke_passages(pace, name)]
    assert swings[2] > swings[3] >= swings[4] == 0.0


def test_low_fluidity_removes_overshoot_and_negative_tension_reduces_it(pace):
    stiff, half, plain, *fluid = (stroke_passage.swing for stroke_passage in stroke_passages(pace, "fluidity"))
    assert stiff == half == 0.0 < plain == fluid[0] == fluid[1]
    assert stroke_passages(pace, "tension")[0].swing == pytest.approx((1.0 - LOOSENESS_REDUCTION) * plain)


def test_negative_power_reduces_overshoot_at_keys(pace):
    weak, half, plain = (stroke_passage.swing for stroke_passage in stroke_passages(pace, "power")[:3])
    assert 0.0 < weak < half < plain


def test_rebound_of_strokes_grows_with_every_step_of_tension(pace):
    tense = stroke_passages(pace, "tension", (0.25, 0.5, 0.75, 1.0))
    assert {stroke_passage.easing for stroke_passage in tense} == {"out_back"}
    assert np.all(np.diff([stroke_passage.steepness for stroke_passage in tense]) > 0.3)


def test_low_fluidity_sharpens_the_velocity_peak_of_strokes(pace):
    steepness = [stroke_passage.steepness for stroke_passage in stroke_passages(pace, "fluidity")[:4]]
    assert np.all(np.diff(steepness) < 0.0)
    assert steepness[2] == MIN_STEEPNESS + STROKE_ACCENT
    assert stroke_passages(pace, "fluidity")[4].easing == "minimum_jerk"
    assert stroke_passages(pace, "tension")[0].easing == "minimum_jerk"


def test_fluidity_softens_the_retraction_of_the_hand(pace):
    homes = [Effort(pace, manner=Expressivity(fluidity=f)).passage("retraction").steepness for f in (-1.0, 0.0, 1.0)]
    assert homes[0] > homes[1] > homes[2] == pytest.approx(LINEAR_STEEPNESS)


def test_high_power_keeps_the_stroke_time_required_by_its_accent(pace):
    distance = 0.2
    minimum = pace.least_hand_time(distance)
    strong, fast, both = (
        Effort(pace, GestureTraits("beat"), Expressivity(power=power, temporal=temporal)).stroke_time(distance)
        for power, temporal in ((1.0, 0.0), (0.0, 1.0), (1.0, 1.0))
    )
    assert strong == pytest.approx(ACCENT_MARGIN * minimum)
    assert both <= fast


def test_duration_factor_of_gesture_categories_grows_from_beats_to_rest_poses(pace):
    order = ("beat", "deictic", "emblem", "iconic", "metaphoric", "adaptor", "rest")
    slowness = [Effort(pace, GestureTraits(category)).slowness for category in order]
    assert slowness == sorted(slowness)
    assert len(set(slowness)) == len(slowness)
    assert 0.75 < slowness[0] < 1.0 < slowness[-1] < 2.0
    usual = Effort(pace, GestureTraits("of my own")).slowness
    assert usual == Effort(pace, GestureTraits("ICONIC")).slowness == 1.0
    holds = [
        Effort(pace, GestureTraits(category)).hold_time(0.6) for category in ("beat", "iconic", "metaphoric", "deictic")
    ]
    assert holds == sorted(holds)
    assert holds[-1] < 3 * holds[0]


def test_velocity_accent_of_a_stroke_on_a_word_remains_at_full_fluidity(pace):
    fluid = [Effort(pace, manner=Expressivity(fluidity=fluidity), spoken=True) for fluidity in (0.95, 1.0)]
    steepness = [effort.passage("stroke").steepness for effort in fluid]
    assert steepness[0] >= steepness[1]
    assert steepness[1] == pytest.approx(MIN_STEEPNESS + MIN_LATE_ACCENT)
