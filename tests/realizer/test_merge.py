"""Blocks merged with a running motion or replacing it."""

from dataclasses import replace

import numpy as np
import pytest

from kinesic.bench.bml import merging
from kinesic.bml.block import NoticeType
from kinesic.bml.parse import parse
from kinesic.motion.limit_check import check_limits
from kinesic.motion.trajectory import stay
from kinesic.motion.transition import extend_controls, knot_at
from kinesic.planning.clearance import LAG_RESERVE, scan_clearance
from kinesic.planning.quick_plan import plan_quickly
from kinesic.realizer.merge import merge, replace_motion
from kinesic.realizer.occupancy import arm_hinges, occupancy_of

from ..passage import passage_text

ROOT = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b">{}</bml>'
NOD = '<head id="n" lexeme="NOD"/>'
SPOKEN = '<speech id="s"><text>Yes, <sync id="m"/>indeed.</text></speech>'


@pytest.fixture(scope="module")
def planned(known):
    plans = {}

    def made(text: str):
        return plans.setdefault(text, plan_quickly(parse(text if "<bml" in text else ROOT.format(text)), known))

    return made


@pytest.fixture(scope="module")
def rest(known):
    return stay(known.robot.skeleton.rest)


@pytest.fixture(scope="module")
def running(planned, rest):
    """Return the test passage, starting at rest half a second later."""
    return merge(rest, 0.0, planned(passage_text(0)), begin=0.5)


def gesture(hand: str, stroke: float = 0.9, id: str = "g", lexeme: str = "beat") -> str:
    return f'<gesture id="{id}" lexeme="{lexeme}" mode="{hand}_HAND" stroke="{stroke}"/>'


def certified(motion, known, before=None, time: float = 0.0) -> None:
    for name, peak in check_limits(motion, known.limits).by_quantity.items():
        assert peak.ratios.max() <= 1.001, name
    assert scan_clearance(motion, known.distances)[1].distances.min() >= known.robot.min_clearance + LAG_RESERVE - 1e-4
    np.testing.assert_allclose(motion.controls[-3:], motion.controls[[-1] * 3], atol=1e-9)
    if before is not None:
        count = knot_at(time) + 3
        same = (extend_controls(item.controls, count)[:count] for item in (motion, before))
        np.testing.assert_allclose(*same, atol=1e-8)


def strokes(plan, found, hinges) -> None:
    """Assert position and time of each performed stroke."""
    for sync in found.syncs:
        if sync.sync == "stroke":
            reached = found.trajectory.at(found.zero + sync.planned).angles[hinges]
            wanted = plan.trajectory.at(plan.trajectory.zero + sync.planned).angles[hinges]
            np.testing.assert_allclose(reached, wanted, atol=1e-6)


def test_block_merged_at_rest_equals_its_plan(planned, running):
    plan = planned(passage_text(0))
    times = np.linspace(0.0, plan.trajectory.duration, 200)
    moved = running.trajectory.sample(times + running.zero - plan.trajectory.zero)[0]
    np.testing.assert_allclose(moved, plan.trajectory.sample(times)[0], atol=1e-9)
    assert running.zero == pytest.approx(0.5 + plan.trajectory.zero)
    assert (running.dropped, running.notices, running.syncs) == ((), (), plan.syncs)


@pytest.mark.parametrize("time", [3.7, 4.3, 5.2, 9.0])
def test_nod_is_added_to_running_gestures(planned, running, known, time):
    merged = merge(running.trajectory, time, planned(NOD), begin=time, occupied=running.occupancy)
    certified(merged.trajectory, known, running.trajectory, time)
    assert merged.dropped == ()
    arms = [*arm_hinges("l_hand", known.robot), *arm_hinges("r_hand", known.robot)]
    times = np.linspace(0.0, 7.0, 300)
    before, after = (item.trajectory.sample(times)[0][:, arms] for item in (running, merged))
    np.testing.assert_allclose(after, before, atol=1e-12)
    neck = list(known.robot.joints("neck"))
    assert np.ptp(merged.layer.controls[:, neck], axis=0).max() > 0.05


def test_nod_is_added_to_a_gaze(planned, rest, known):
    gaze = merge(rest, 0.0, planned('<gaze id="z" target="left" start="0" end="4"/>'), begin=0.0)
    merged = merge(gaze.trajectory, 1.2, planned(NOD), begin=1.2, occupied=gaze.occupancy)
    certified(merged.trajectory, known, gaze.trajectory, 1.2)
    torsion, tilt, _ = known.robot.joints("neck")
    times = np.linspace(0.0, 5.0, 200)
    before, after = (item.trajectory.sample(times)[0] for item in (gaze, merged))
    np.testing.assert_allclose(after[:, torsion], before[:, torsion], atol=0.02)
    assert (after[:, tilt] - before[:, tilt]).max() > 0.1


def test_gestures_of_both_hands_in_two_blocks_overlap_without_drops(planned, rest, known):
    left = merge(rest, 0.0, planned(gesture("LEFT", id="l", lexeme="offer")), begin=0.0)
    plan = planned(gesture("RIGHT"))
    merged = merge(left.trajectory, 0.4, plan, begin=0.4, occupied=left.occupancy)
    certified(merged.trajectory, known, left.trajectory, 0.4)
    assert merged.dropped == ()
    strokes(plan, merged, list(arm_hinges("r_hand", known.robot)))


def test_far_pointing_with_both_hands_keeps_limits_and_drops_no_behaviour(planned, rest, known):
    far = {**known.targets, "far_left": np.array([0.9, 0.5, 0.3]), "far_right": np.array([0.9, -0.5, 0.3])}
    reaching = replace(known, targets=far)
    plans = [
        plan_quickly(
            parse(ROOT.format(f'<pointing id="{side[0]}" target="far_{side}" mode="{side.upper()}_HAND"/>')), reaching
        )
        for side in ("left", "right")
    ]
    first = merge(rest, 0.0, plans[0], begin=0.0)
    merged = merge(first.trajectory, 0.3, plans[1], begin=0.3, occupied=first.occupancy)
    certified(merged.trajectory, known, first.trajectory, 0.3)
    assert merged.dropped == ()


def test_gesture_of_a_busy_hand_is_dropped_with_a_notice(planned, rest, known):
    first = merge(rest, 0.0, planned(gesture("RIGHT", 1.5, lexeme="offer")), begin=0.0)
    plan = planned(SPOKEN + gesture("RIGHT", 1.2, id="beat") + '<head id="n" lexeme="NOD" start="0.4"/>')
    merged = merge(first.trajectory, 0.2, plan, begin=0.2, occupied=first.occupancy)
    certified(merged.trajectory, known, first.trajectory, 0.2)
    assert merged.dropped == ("beat",)
    (notice,) = merged.notices
    assert (notice.type, notice.id) == (NoticeType.IMPOSSIBLE_TO_SCHEDULE, "b:beat")
    assert "r_hand busy with g for" in notice.text
    assert {sync.behaviour for sync in merged.syncs} == {"s", "n"}
    assert {item.behaviour for item in merged.occupancy} == {"n"}
    hinges = list(arm_hinges("r_hand", known.robot))
    times = np.linspace(0.0, 4.0, 100)
    before, after = (item.trajectory.sample(times)[0][:, hinges] for item in (first, merged))
    np.testing.assert_allclose(after, before, atol=1e-12)


def test_hand_returns_to_rest_if_its_next_gesture_is_dropped(planned, rest, known):
    first = merge(rest, 0.0, planned(gesture("LEFT", 2.5, lexeme="offer")), begin=0.0)
    plan = planned(SPOKEN + gesture("RIGHT") + gesture("BOTH", 2.0, id="k"))
    merged = merge(first.trajectory, 0.1, plan, begin=0.1, occupied=first.occupancy)
    certified(merged.trajectory, known, first.trajectory, 0.1)
    assert list(merged.dropped) == ["k"]
    hand = list(arm_hinges("r_hand", known.robot))
    strokes(plan, merged, hand)
    alone = planned(SPOKEN + gesture("RIGHT"))
    times = np.linspace(-alone.trajectory.zero, alone.duration, 100)
    same = (
        each.trajectory.sample(times + zero)[0][:, hand]
        for each, zero in ((alone, alone.trajectory.zero), (merged, merged.zero))
    )
    np.testing.assert_allclose(*same, atol=1e-6)
    resting = known.robot.skeleton.rest[hand]
    np.testing.assert_allclose(merged.trajectory.at(merged.zero + 3.0).angles[hand], resting, atol=1e-3)
    np.testing.assert_allclose(merged.trajectory.controls[-1, hand], resting, atol=1e-9)


def test_pointing_that_would_collide_with_the_other_arm_is_dropped(planned, rest, known):
    point = '<pointing id="{}" target="{}" mode="{}_HAND"/>'
    first = merge(rest, 0.0, planned(point.format("r", "left", "RIGHT")), begin=0.0)
    merged = merge(
        first.trajectory, 0.3, planned(point.format("l", "right", "LEFT")), begin=0.3, occupied=first.occupancy
    )
    assert merged.dropped == ("l",)
    assert "mm of" in merged.notices[0].text
    assert merged.trajectory is first.trajectory


def test_motion_with_a_dropped_gaze_equals_that_of_the_block_without_it(planned, rest, known):
    looks = '<gaze id="{}" target="{}" start="0" ready="0.8" relax="{}" end="{}"/>'
    first = merge(rest, 0.0, planned(looks.format("z", "left", 6, 7)), begin=0.0)
    plan = planned(SPOKEN + gesture("RIGHT") + looks.format("y", "right", 2, 3))
    merged, alone = (
        merge(first.trajectory, 1.0, coming, begin=1.0, occupied=first.occupancy)
        for coming in (plan, planned(SPOKEN + gesture("RIGHT")))
    )
    assert (merged.dropped, alone.dropped) == (("y",), ())
    times = np.linspace(0.0, 8.0, 80)
    expected, result = (item.trajectory.sample(times)[0] for item in (alone, merged))
    np.testing.assert_allclose(result, expected, atol=1e-6)


@pytest.mark.parametrize("id", ["y", "g"])
def test_block_with_a_dropped_gaze_or_gesture_nods_as_if_planned_without_it(planned, rest, known, id):
    """Gaze and gesture move the neck like the nod does."""
    nod = '<head id="n" lexeme="NOD" start="0.5" end="3.5" repetition="4"/>'
    look = '<gaze id="y" target="right" start="0" ready="0.8" relax="3" end="4"/>'
    whole = {"y": look, "g": gesture("RIGHT", 1.5, lexeme="offer"), "n": nod}
    first = planned(look if id == "y" else whole["g"])
    others = [replace(entry, behaviour="other").shifted(1.0) for entry in occupancy_of(first)]
    merged = merge(rest, 0.0, planned(SPOKEN + "".join(whole.values())), begin=1.0, occupied=others)
    alone = planned(SPOKEN + "".join(text for name, text in whole.items() if name != id))
    assert merged.dropped == (id,)
    trunk = [*known.robot.joints("torso"), *known.robot.joints("neck")]
    times = np.linspace(-0.5, 6.0, 130)
    expected, result = (
        motion.sample(times + zero)[0][:, trunk]
        for motion, zero in ((alone.trajectory, alone.trajectory.zero), (merged.trajectory, merged.zero))
    )
    np.testing.assert_allclose(result, expected, atol=1e-6)


def test_gesture_of_a_new_block_replaces_the_retraction_of_the_previous_gesture(planned, rest, known):
    plan = planned(gesture("RIGHT"))
    first = merge(rest, 0.0, planned(gesture("RIGHT", 1.0, lexeme="offer")), begin=0.0)
    relax, end = first.occupancy[0].relax, first.occupancy[0].end
    time = relax + 0.2 * (end - relax)
    merged = merge(first.trajectory, time, plan, begin=time, occupied=first.occupancy)
    certified(merged.trajectory, known, first.trajectory, time)
    assert merged.dropped == ()
    hinges = list(arm_hinges("r_hand", known.robot))
    strokes(plan, merged, hinges)
    times = np.linspace(time, merged.occupancy[0].ready, 50)
    away = np.abs(merged.trajectory.sample(times)[0][:, hinges] - known.robot.skeleton.rest[hinges]).max(axis=1)
    assert away.min() > 0.05  # it does not return in between


def test_gaze_reaches_its_target_from_a_held_gaze(planned, rest, known):
    torsion = known.robot.joints("neck")[0]
    left = merge(rest, 0.0, planned('<gazeShift id="l" target="left" start="0" end="1"/>'), begin=0.0)
    right = planned('<gaze id="r" target="right" start="0" end="3"/>')
    merged = merge(left.trajectory, 2.0, right, begin=2.0, occupied=left.occupancy)
    certified(merged.trajectory, known, left.trajectory, 2.0)
    wanted = right.trajectory.at(1.6 + right.trajectory.zero).angles[torsion]
    assert merged.trajectory.at(merged.zero + 1.6).angles[torsion] == pytest.approx(wanted, abs=0.02)
    back = merged.trajectory.controls[-1]
    np.testing.assert_allclose(back, left.trajectory.controls[-1], atol=1e-6)
    stays = merge(
        left.trajectory, 2.0, planned('<gazeShift id="r" target="right"/>'), begin=2.0, occupied=left.occupancy
    )
    assert stays.trajectory.controls[-1][torsion] == pytest.approx(-left.trajectory.controls[-1][torsion], abs=0.02)


def test_later_of_two_simultaneous_gazes_is_dropped(planned, rest):
    looks = '<gaze id="{}" target="{}" start="0" ready="0.8" relax="{}" end="9"/>'
    first = merge(rest, 0.0, planned(looks.format("z", "left", 6)), begin=0.0)
    merged = merge(first.trajectory, 0.3, planned(looks.format("y", "right", 3)), begin=0.3, occupied=first.occupancy)
    assert merged.dropped == ("y",)
    assert "look busy with z" in merged.notices[0].text


def test_merge_result_does_not_depend_on_truncation_of_past_motion(planned, running, known):
    later = running.since(2.0)
    times = np.linspace(2.0, 7.0, 100)
    one, other = later.trajectory.sample(times)[0], running.trajectory.sample(times)[0]
    np.testing.assert_allclose(one, other, atol=1e-12)
    plan = planned(NOD)
    one = merge(running.trajectory, 3.7, plan, begin=3.7, occupied=running.occupancy)
    other = merge(later.trajectory, 3.7, plan, begin=3.7, occupied=later.occupancy)
    assert other.zero == pytest.approx(one.zero)
    np.testing.assert_allclose(other.trajectory.controls, one.trajectory.controls[200:], atol=1e-9)


@pytest.mark.parametrize("coming", [NOD, gesture("RIGHT", 0.5)], ids=["free", "busy"])
def test_merged_motion_does_not_depend_on_the_clock_time(planned, known, coming):
    first, second = planned(gesture("RIGHT", 1.0)), planned(coming)
    results = []
    for start in (0.0, 1e4):
        one = merge(stay(known.robot.skeleton.rest, start=start), start, first, begin=start)
        results.append(merge(one.trajectory, start + 0.5, second, begin=start + 0.5, occupied=one.occupancy))
    soon, late = results
    assert [notice.text for notice in late.notices] == [notice.text for notice in soon.notices]
    assert late.zero - soon.zero == pytest.approx(1e4)
    assert [
        each.begin - soon_.begin for each, soon_ in zip(late.occupancy, soon.occupancy, strict=True)
    ] == pytest.approx([1e4])
    np.testing.assert_allclose(late.trajectory.controls, soon.trajectory.controls, atol=1e-9)
    assert late.layer.start == late.trajectory.start == 1e4


@pytest.mark.parametrize("time", [0.9, 1.45, 3.1, 6.5, 8.0])
def test_block_that_replaces_others_starts_immediately(planned, running, known, time):
    plan = planned(gesture("RIGHT", 1.0, lexeme="offer"))
    replaced = replace_motion(running.trajectory, time, plan)
    certified(replaced.trajectory, known, running.trajectory, time)
    strokes(plan, replaced, list(arm_hinges("r_hand", known.robot)))
    assert 0.0 <= replaced.zero - plan.trajectory.zero - time <= 0.01
    left = list(arm_hinges("l_hand", known.robot))
    np.testing.assert_allclose(replaced.trajectory.controls[-1][left], known.robot.skeleton.rest[left], atol=1e-9)


def test_replacing_a_motion_at_random_times_keeps_limits_and_clearance(known):
    for cut in merging.replace_at_random(known, 10, seed=4):
        assert cut.ratio <= 1.001, cut
        assert cut.step <= 1e-8, cut
        assert cut.clearance >= 0.0, cut
        assert cut.delay <= 0.6, cut


def test_merge_benchmark_meets_its_goals_except_possibly_that_of_the_merge_time(monkeypatch):
    monkeypatch.setattr(merging, "REPLACEMENT_COUNT", 10)
    assert {metric.name for metric in merging.bench() if metric.ok is False} <= {"bml.live.merged"}


@pytest.mark.parametrize("time", [0.004, 1.0, 2.5])
def test_block_requested_in_the_past_begins_at_the_earliest_change_time(planned, rest, known, time):
    first = merge(rest, 0.0, planned(NOD), begin=0.0)
    plan = planned(gesture("RIGHT"))
    merged = merge(first.trajectory, time, plan, begin=-5.0, occupied=first.occupancy)
    certified(merged.trajectory, known, first.trajectory, time)
    assert 0.0 <= merged.zero - plan.trajectory.zero - time < 0.01
    assert merged.occupancy[0].begin >= time
    strokes(plan, merged, list(arm_hinges("r_hand", known.robot)))


def test_block_requested_long_after_the_end_of_the_running_motion_begins_on_time(planned, rest, known):
    plan = planned(NOD)
    merged = merge(rest, 30.0, plan, begin=30.0)
    certified(merged.trajectory, known, rest, 30.0)
    assert merged.zero == pytest.approx(30.0 + plan.trajectory.zero)
    np.testing.assert_allclose(merged.trajectory.at(29.9).angles, known.robot.skeleton.rest, atol=1e-9)
