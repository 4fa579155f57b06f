"""Gazes beside one another, and the parts that take part."""

import pytest

from kinesic.bml.block import GAZE_SYNCS, Gaze, HeadDirectionShift, NoticeType
from kinesic.expressivity.gaze import TRUNK_LAG, Aim, hold_gaze
from kinesic.expressivity.keyframes import Turn


def gaze_times(*times):
    return dict(zip(GAZE_SYNCS, times, strict=True))


def test_of_two_gazes_from_the_same_moment_one_is_left_out(perform):
    frames = perform(
        ("one", Gaze("0.5 -1 1"), gaze_times(1, 2, 9, 10)), ("two", Gaze("0.5 1 1"), gaze_times(1, 2, 9, 10))
    )
    assert {id: outcome.kind for id, outcome in frames.outcomes.items()} == {"one": "dropped", "two": "realised"}
    (notice,) = frames.notices
    assert (notice.id, notice.type) == ("bml1:one", NoticeType.IMPOSSIBLE_TO_SCHEDULE)
    assert "two" in notice.text


def test_a_shift_and_a_gaze_from_the_same_moment_are_both_performed(perform):
    frames = perform(
        ("stays", HeadDirectionShift("0.5 -1 1"), gaze_times(0, 1, 2, 3)),
        ("goes", Gaze("0.5 1 1"), gaze_times(0, 1, 2, 3)),
    )
    assert {outcome.kind for outcome in frames.outcomes.values()} == {"realised"}


@pytest.mark.parametrize(("influence", "share"), [("SHOULDER", 0.25), ("WAIST", 0.4)])
def test_the_trunk_sets_out_after_the_head_and_arrives_with_it(perform, influence, share):
    frames = perform(("g", Gaze("0.9 0.4 1.1", influence=influence), gaze_times(0, 2, 3, 5)))
    turned = {frame.time: (frame.head.torsion, frame.torso.torsion) for frame in frames.frames}
    lagging = [time for time, (head, torso) in turned.items() if head > 0 and torso == 0 and time < 2]
    assert len(lagging) == 1
    assert turned[2][1] == pytest.approx(share * turned[2][0])


@pytest.mark.parametrize(("influence", "still"), [("EYES", {"head", "torso"}), ("NECK", {"torso"})])
def test_parts_that_are_not_asked_stay_where_they_look_for_good(perform, influence, still):
    frames = perform(
        ("for_good", Gaze("0.9 0.4 1.1", influence="WAIST", shift=True), {"start": 0.0, "end": 2.0}),
        ("glance", Gaze(offset_direction="RIGHT", offset_angle=8.0, influence=influence), gaze_times(3, 4, 5, 6)),
    )
    later = [frame for frame in frames.frames if frame.time >= 2]
    assert later[0].torso.torsion > 0.05
    for part in ("head", "torso"):
        torsions = {round(getattr(frame, part).torsion, 9) for frame in later}
        assert (len(torsions) == 1) is (part in still)


@pytest.mark.parametrize(
    ("spare", "lag"), [(-0.3, 0.0), (0.0, 0.0), (0.05, 0.05), (TRUNK_LAG, TRUNK_LAG), (1.0, TRUNK_LAG)]
)
def test_the_trunk_lags_behind_the_head_only_as_far_as_its_way_has_time(pace, spare, lag):
    look = Aim(head=Turn(torsion=0.9), torso=Turn(torsion=0.3))
    needed = pace.turn_time("torso", look.torso)
    times = {"start": 1.0, "ready": 1.0 + needed + spare, "relax": 9.0, "end": 11.0}
    trunk = hold_gaze(look, times, part="torso", stays=False, pace=pace)
    assert trunk.start == pytest.approx(1.0 + lag)
    assert trunk.arrive >= times["ready"] - 1e-9
    assert hold_gaze(look, times, part="head", stays=False, pace=pace).start == 1.0
