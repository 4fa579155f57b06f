from dataclasses import replace

import numpy as np
import pytest

from kinesic.body.arrays import sealed
from kinesic.expressivity.style.effort import ACCENT, CHARACTERS, CROWDED, LOOSE, PACES, ROOM_FOR_ACCENT, Effort, Nature
from kinesic.expressivity.style.pace import HASTE, Pace
from kinesic.expressivity.style.style import LEAST_LATE, NEUTRAL, Expressivity, passage_of
from kinesic.motion.keys import ACCENT as ACCENT_EASING
from kinesic.motion.keys import EVEN, LATE_ACCENT, SOFTEST, STEEPEST, KeyPassage

WAYS = np.linspace(0.02, 0.8, 27)
EXTENTS = np.linspace(-1.0, 1.0, 9)
PHASES = ("preparation_time", "joining_time", "stroke_time", "return_time")
POSE = Nature("emblem", dynamic=False)


@pytest.fixture(scope="module")
def sluggish(pace):
    """The same robot with servos that give a quarter of the speed, acceleration and jerk."""
    slow = {name: sealed(getattr(pace.limits, name) / 4) for name in ("speed", "acceleration", "jerk")}
    return Pace(pace.robot, replace(pace.limits, **slow))


@pytest.fixture
def efforts(pace, sluggish):
    """Efforts of all kinds, on two robots."""
    natures = [
        Nature(category, tempo, dynamic)
        for category in (*CHARACTERS, "own")
        for tempo in PACES
        for dynamic in (True, False)
    ]
    return [Effort(robot, nature) for robot in (pace, sluggish) for nature in natures]


@pytest.mark.parametrize("phase", PHASES)
def test_a_longer_way_takes_longer_but_is_faster(efforts, phase):
    for effort in efforts:
        times = np.array([getattr(effort, phase)(way) for way in WAYS])
        assert np.all(np.diff(times) > 0.0)
        assert np.all(np.diff(WAYS / times) > 0.0)


@pytest.mark.parametrize("phase", PHASES)
@pytest.mark.parametrize(
    "manner", [Expressivity(temporal=1.0), Expressivity(power=1.0), Expressivity(1.0, 1.0, 1.0, 1.0)]
)
def test_no_manner_asks_for_more_than_the_servos_can_do(efforts, phase, manner):
    for effort in efforts:
        hurried = replace(effort, manner=manner)
        assert all(getattr(hurried, phase)(way) >= effort.pace.least_hand_time(way) for way in WAYS)


@pytest.mark.parametrize("phase", PHASES)
def test_temporal_extent_hurries_every_phase(efforts, phase):
    for effort in efforts:
        for way in WAYS[::9]:
            manners = (replace(effort, manner=Expressivity(temporal=extent)) for extent in EXTENTS)
            times = [getattr(each, phase)(way) for each in manners]
            assert np.all(np.diff(times) < 0.0)
            assert times[0] == pytest.approx(HASTE * times[4])


def test_without_weight_phases_have_what_the_servos_do_at_ease(efforts):
    for effort in efforts:
        none, half = (replace(effort, nature=replace(effort.nature, weight=weight)) for weight in (0.0, 0.5))
        for way in WAYS[::5]:
            fitts, least = 0.1 + 0.15 * np.log2(way / 0.05 + 1.0), effort.pace.least_hand_time(way)
            assert none.stroke_time(way) == pytest.approx(max(fitts, 2.4 * least))
            for name in ("preparation_time", "joining_time", "return_time"):
                assert getattr(none, name)(way) == pytest.approx(max(fitts, 1.3 * least)), name
            for name in PHASES:
                both = [getattr(each, name)(way) for each in (none, half, effort)]
                assert both[1] == pytest.approx((both[0] + both[2]) / 2)
        assert none.hold_time(0.8) == pytest.approx(0.4)
        for phase in ("preparation", "stroke", "hold", "retraction"):
            assert none.passage(phase) == replace(none, spoken=True).passage(phase) == passage_of(NEUTRAL, phase)


def test_swing_and_accent_grow_with_the_weight(pace):
    found = [Effort(pace, Nature(weight=weight)).passage("stroke") for weight in (0.0, 0.5, 1.0)]
    assert found[0].swing == 0.0 < found[1].swing < found[2].swing
    assert found[1].steepness < found[2].steepness == SOFTEST + ACCENT
    homes = [Effort(pace, Nature(weight=weight)).passage("retraction").steepness for weight in (0.5, 1.0)]
    assert EVEN < homes[0] < homes[1]


def test_power_goes_into_the_stroke_alone_and_weakness_into_all(pace):
    plain, strong, weak = (Effort(pace, Nature("beat"), Expressivity(power=power)) for power in (0.0, 1.0, -1.0))
    assert strong.stroke_time(0.1) < plain.stroke_time(0.1) < weak.stroke_time(0.1)
    for phase in ("preparation_time", "return_time"):
        times = [getattr(each, phase)(0.3) for each in (strong, plain, weak)]
        assert times[0] == times[1] < times[2]
    assert len({each.hold_time(0.5) for each in (strong, plain, weak)}) == 1


def test_what_is_sudden_is_quick_and_still_goes_home_calmly(pace):
    sudden, plain, sustained = (Effort(pace, Nature("iconic", tempo)) for tempo in PACES)
    for phase in ("preparation_time", "stroke_time"):
        times = [getattr(each, phase)(0.1) for each in (sudden, plain, sustained)]
        assert times[0] < times[1] < times[2]
    assert sudden.return_time(0.3) == plain.return_time(0.3) < sustained.return_time(0.3)


def test_home_is_farther_in_time_than_the_way_from_another_gesture(efforts, pace):
    own = [effort for effort in efforts if effort.pace is pace]
    assert all(effort.return_time(way) > effort.joining_time(way) for effort in own for way in (0.2, 0.4, 0.6))


def test_nobody_comes_from_another_gesture_slowly(pace):
    slow, plain = Effort(pace, Nature("adaptor", "sustained")), Effort(pace)
    assert slow.joining_time(0.3) == plain.joining_time(0.3) < slow.preparation_time(0.3)


def test_a_stroke_is_held_by_its_length_a_pose_by_itself(pace):
    stroke, pose = Effort(pace, Nature("emblem")), Effort(pace, POSE)
    assert stroke.hold_time(1.2) == pytest.approx(2 * stroke.hold_time(0.6))
    assert pose.hold_time(0.1) == pose.hold_time(2.0) > stroke.hold_time(0.6)


def test_a_stroke_passes_its_keys_and_a_pose_arrives(pace):
    stroke, pose = Effort(pace), Effort(pace, POSE)
    assert stroke.passage("preparation").flow > 1.0
    assert stroke.passage("stroke").flow > 1.0
    assert pose.passage("preparation") == pose.passage("stroke") == passage_of(Expressivity(), "stroke")
    assert stroke.passage("hold") == pose.passage("hold") == passage_of(Expressivity(), "hold")


def test_tension_stops_even_a_hand_that_would_swing(pace):
    assert Effort(pace, manner=Expressivity(tension=1.0)).passage("preparation").flow == 0.0


def test_swing_and_accent_fade_where_there_is_no_leisure(pace):
    found = [Effort(pace).passage("stroke", leisure=share) for share in (0.0, CROWDED, 0.8, 0.9, 1.0, 2.0)]
    swings, accents = [each.swing for each in found], [each.steepness for each in found[2:]]
    assert swings[0] == swings[1] == 0.0 < swings[2] < swings[3] < swings[4] == swings[5]
    assert accents[0] < accents[1] < accents[2] == accents[3] == SOFTEST + ACCENT
    assert found[0] == found[1] == passage_of(Expressivity(), "stroke")


def test_the_way_there_has_no_accent_and_a_path_has_its_own_speed(pace):
    effort = Effort(pace)
    assert effort.passage("preparation").easing == "minimum_jerk"
    assert effort.passage("stroke", led=True).easing == "minimum_jerk"
    assert 0.0 < effort.passage("stroke", led=True).swing < effort.passage("stroke").swing


def test_a_stroke_that_meets_a_word_is_fastest_near_it_and_begins_with_less_swing(pace):
    plain, spoken = Effort(pace), Effort(pace, spoken=True)
    assert (plain.passage("stroke").easing, spoken.passage("stroke").easing) == (ACCENT_EASING, LATE_ACCENT)
    assert spoken.passage("stroke").steepness > plain.passage("stroke").steepness
    assert 0.0 < spoken.passage("preparation").swing < plain.passage("preparation").swing
    assert spoken.passage("hold") == plain.passage("hold")
    pose = Effort(pace, POSE, spoken=True)
    assert (pose.passage("stroke").easing, pose.passage("stroke").swing) == (LATE_ACCENT, 0.0)
    for manner in ({"power": 1.0, "tension": 1.0}, {"fluidity": -1.0}):  # more than an easing can be
        assert Effort(pace, manner=Expressivity(**manner), spoken=True).passage("stroke").steepness == STEEPEST
    for manner in ({"fluidity": 1.0}, {"tension": -1.0}, {"power": 0.8}, {"tension": 0.8}, {"power": -1.0}):
        assert Effort(pace, manner=Expressivity(**manner), spoken=True).passage("stroke").easing == LATE_ACCENT


def test_neither_weakness_nor_looseness_takes_the_accent_from_a_word(pace):
    for manner in (
        {"power": -1.0},
        {"power": -1.0, "fluidity": 1.0, "tension": -1.0},
        {"power": -0.5, "fluidity": 1.0},
    ):
        spoken = Effort(pace, manner=Expressivity(**manner), spoken=True)
        assert spoken.passage("stroke").steepness >= SOFTEST + LEAST_LATE
        assert spoken.passage("stroke", leisure=CROWDED).easing != LATE_ACCENT
        assert spoken.passage("stroke", stroke=False).easing != LATE_ACCENT


def test_only_the_way_to_the_word_has_an_accent_and_nobody_rushes_to_where_it_begins(pace):
    spoken = Effort(pace, spoken=True)
    assert spoken.passage("stroke", stroke=False) == replace(
        Effort(pace).passage("stroke"), easing="minimum_jerk", steepness=KeyPassage().steepness
    )
    fluid = Expressivity(fluidity=1.0)
    assert spoken.passage("preparation") == replace(spoken, manner=fluid).passage("preparation")
    assert Effort(pace, manner=fluid).passage("preparation").flow > Effort(pace).passage("preparation").flow


def test_force_stays_out_of_the_way_to_a_stroke(pace):
    strong, plain = Effort(pace, manner=Expressivity(power=1.0)), Effort(pace)
    assert strong.passage("preparation") == replace(plain.passage("preparation"), swing=0.0)
    assert strong.passage("stroke").steepness > plain.passage("stroke").steepness


def stroke_passages(pace, name, values=(-1.0, -0.5, 0.0, 0.5, 1.0)):
    """How a stroke's key is passed in five manners."""
    return [Effort(pace, manner=Expressivity(**{name: value})).passage("stroke") for value in values]


@pytest.mark.parametrize("name", ["tension", "power"])
def test_the_firmer_a_hand_the_less_it_swings(pace, name):
    swings = [each.swing for each in stroke_passages(pace, name)]
    assert swings[2] > swings[3] >= swings[4] == 0.0


def test_a_stiff_hand_does_not_swing_a_fluid_one_does_and_a_loose_one_hangs_by_its_tension(pace):
    stiff, half, plain, *fluid = (each.swing for each in stroke_passages(pace, "fluidity"))
    assert stiff == half == 0.0 < plain == fluid[0] == fluid[1]
    assert stroke_passages(pace, "tension")[0].swing == pytest.approx((1.0 - LOOSE) * plain)


def test_jerky_strokes_begin_at_once_and_fluid_or_loose_ones_softly(pace):
    steepness = [each.steepness for each in stroke_passages(pace, "fluidity")[:4]]
    assert np.all(np.diff(steepness) < 0.0)
    assert steepness[2] == SOFTEST + ACCENT
    assert stroke_passages(pace, "fluidity")[4].easing == "minimum_jerk"
    assert stroke_passages(pace, "tension")[0].easing == "minimum_jerk"


def test_the_more_fluid_a_hand_the_softer_it_goes_home(pace):
    homes = [Effort(pace, manner=Expressivity(fluidity=f)).passage("retraction").steepness for f in (-1.0, 0.0, 1.0)]
    assert homes[0] > homes[1] > homes[2] == pytest.approx(EVEN)


def test_power_leaves_a_stroke_the_time_for_its_accent(pace):
    way = 0.2
    least = pace.least_hand_time(way)
    strong, fast, both = (
        Effort(pace, Nature("beat"), Expressivity(power=power, temporal=temporal)).stroke_time(way)
        for power, temporal in ((1.0, 0.0), (0.0, 1.0), (1.0, 1.0))
    )
    assert strong == pytest.approx(ROOM_FOR_ACCENT * least)
    assert both <= fast


def test_categories_are_ordered_from_quick_beats_to_calm_rest_poses(pace):
    order = ("beat", "deictic", "emblem", "iconic", "metaphoric", "adaptor", "rest")
    slowness = [Effort(pace, Nature(category)).slowness for category in order]
    assert slowness == sorted(slowness)
    assert len(set(slowness)) == len(slowness)
    assert 0.75 < slowness[0] < 1.0 < slowness[-1] < 2.0
    usual = Effort(pace, Nature("of my own")).slowness
    assert usual == Effort(pace, Nature("ICONIC")).slowness == 1.0
    holds = [Effort(pace, Nature(category)).hold_time(0.6) for category in ("beat", "iconic", "metaphoric", "deictic")]
    assert holds == sorted(holds)
    assert holds[-1] < 3 * holds[0]


def test_an_accent_that_meets_a_word_is_kept_by_the_most_fluid_manner(pace):
    fluid = [Effort(pace, manner=Expressivity(fluidity=fluidity), spoken=True) for fluidity in (0.95, 1.0)]
    steepness = [effort.passage("stroke").steepness for effort in fluid]
    assert steepness[0] >= steepness[1]
    assert steepness[1] == pytest.approx(SOFTEST + LEAST_LATE)
