"""Steps of the trunk from one sum of held values to another, behaviour by behaviour."""

import numpy as np
import pytest

from kinesic.motion.trajectory import STEP
from kinesic.planning.quick_plan import quintic_duration
from kinesic.realizer.held import (
    END_TOLERANCE,
    GIVING_WAY,
    HeldRamp,
    end_warnings,
    held_posture,
    held_ramps,
    lacking_change,
    last_held,
    lead_to_held,
    taking_over,
    trunk_hinges,
)
from kinesic.realizer.occupancy import STILL, Occupancy, Overlay, arm_hinges

KNOTS = 100  # of the motions here


@pytest.fixture
def hinges(known):
    return trunk_hinges(known.robot)


@pytest.fixture
def offset(known, hinges):
    """The neck turned by some radians, and both arms somewhere."""
    neck = known.robot.joints("neck")[0]

    def of(turn: float) -> np.ndarray:
        found = np.where(hinges, 0.0, 9.0)
        found[neck] = turn
        return found

    return of


@pytest.fixture
def need(known, offset):
    """A look, or another role, that holds a turn of the neck [rad] or goes back."""

    def of(turn=None, *, id="a", role="look", begin=1.0, ready=2.0, relax=None, end=2.0, moved=()) -> Occupancy:
        moving = np.zeros(len(known.robot.skeleton.hinges), dtype=bool)
        moving[list(moved)] = True
        relax = end if relax is None else relax
        held = None if turn is None else offset(turn)
        return Occupancy(id, frozenset({role}), moving, begin, ready, relax, end, held)

    return of


@pytest.fixture
def steps(known):
    """Steps of the neck: (change [rad], begin [s], end [s])."""

    def of(running=(), performed=(), dropped=(), *, ends: float) -> list[tuple[float, float, float]]:
        neck = known.robot.joints("neck")[0]
        base = np.tile(known.robot.skeleton.rest, (KNOTS, 1))
        base[:, neck] += ends
        work = Overlay(base, base, known.robot.skeleton.rest, 0, running, performed, dropped)
        found = held_ramps(work, known, known.limits)
        for ramp in found:
            assert not np.delete(ramp.change, neck).any()
        return [(round(float(ramp.change[neck]), 9), ramp.begin, ramp.end) for ramp in found]

    return of


@pytest.fixture
def least(known):
    """Shortest time [s] in which a turn of the neck gives way."""
    return lambda turn: GIVING_WAY * quintic_duration(turn, known.limits, known.robot.joints("neck")[0])


def motion(known, turn: float = 0.0) -> np.ndarray:
    controls = np.tile(known.robot.skeleton.rest, (KNOTS, 1))
    controls[:, known.robot.joints("neck")[0]] += turn
    return controls


def test_trunk_is_all_but_the_arms(known, hinges):
    arms = {hinge for role in ("l_hand", "r_hand") for hinge in arm_hinges(role, known.robot)}
    assert {*np.flatnonzero(~hinges)} == arms
    assert hinges[[*known.robot.joints("torso"), *known.robot.joints("neck")]].all()


def test_of_each_role_the_last_to_end_is_held_and_the_trunk_alone_counts(known, hinges, need):
    neck = known.robot.joints("neck")[0]
    looks = [need(0.3, end=4.0), need(0.1, end=2.0), need(None, end=9.0), need(0.2, role="trunk", end=6.0)]
    assert last_held("look", looks, hinges)[neck] == 0.3
    assert last_held("trunk", looks, hinges)[neck] == 0.2
    assert not last_held("sign", looks, hinges).any()
    posture = held_posture(looks, known.robot) - known.robot.skeleton.rest
    assert posture[neck] == pytest.approx(0.5)
    assert not np.delete(posture, neck).any()
    far = held_posture([need(50.0)], known.robot)
    assert far[neck] == known.robot.skeleton.upper[neck]
    assert held_posture([need(-50.0)], known.robot)[neck] == known.robot.skeleton.lower[neck]


def test_what_lacks_at_the_end_comes_with_the_last_behaviour_that_holds(known, need):
    neck = known.robot.joints("neck")[0]
    controls = motion(known, 0.1)
    holding = [need(0.1, begin=0.1, ready=0.2, end=0.2), need(0.3, role="trunk", begin=0.5, ready=1.0, end=1.0)]
    assert lacking_change(controls, holding, known.robot)[neck] == pytest.approx(0.3)
    led = lead_to_held(controls, [*holding, need(None, end=9.0)], known.robot)
    early = round(0.5 / STEP) + 3
    np.testing.assert_allclose(led[:early], controls[:early], atol=1e-12)
    late = round(1.0 / STEP) + 3
    np.testing.assert_allclose(led[late:, neck] - controls[late:, neck], 0.3)
    middle = round(0.75 / STEP) + 3
    assert led[middle, neck] - controls[middle, neck] == pytest.approx(0.15, abs=0.03)


def test_motion_that_ends_where_it_should_is_left_as_it_is(known, need):
    controls = motion(known, 0.3)
    assert lead_to_held(controls, [need(0.3)], known.robot) is controls
    controls[-1, known.robot.joints("neck")[0]] += STILL / 2
    assert lead_to_held(controls, [need(0.3)], known.robot) is controls


def test_where_nothing_holds_the_whole_motion_is_moved_to_rest(known, need):
    led = lead_to_held(motion(known, 0.3), [need(None)], known.robot)
    np.testing.assert_allclose(led, motion(known), atol=1e-12)


def test_arms_may_end_anywhere(known):
    controls = motion(known)
    controls[:, list(arm_hinges("l_hand", known.robot))] += 0.2
    assert not lacking_change(controls, (), known.robot).any()


def test_behaviour_takes_over_the_trunk_of_those_it_supersedes(known, need):
    (neck, tilt, *_), torso, arm = (
        known.robot.joints("neck"),
        known.robot.joints("torso")[0],
        known.robot.joints("l_arm")[0],
    )
    earlier = [need(0.1, moved=(neck, arm)), need(None, moved=(tilt,)), need(0.1, role="trunk", moved=(torso,))]
    look, nod = taking_over([need(0.2, moved=(tilt,)), need(role="sign", moved=(tilt,))], earlier, known.robot)
    assert {*np.flatnonzero(look.hinges)} == {neck, tilt}
    assert {*np.flatnonzero(nod.hinges)} == {tilt}
    (alone,) = taking_over([need(0.2, moved=(arm,))], (), known.robot)
    assert {*np.flatnonzero(alone.hinges)} == {arm}


@pytest.mark.parametrize(("share", "warned"), [(0.99, False), (1.01, True)])
def test_sender_of_the_last_behaviour_that_holds_is_warned_beyond_a_tolerance(known, need, share, warned):
    controls = motion(known, 0.5 - share * END_TOLERANCE)
    performed = [need(0.1, id="first", end=1.0), need(0.3, id="last", end=3.0), need(None, id="back", end=9.0)]
    other = [need(0.2, role="trunk", id="other", end=5.0)]
    found = end_warnings(controls, performed, other, known.robot)
    assert [id for id, _ in found] == ["last"] * warned
    for _, text in found:
        assert text.startswith("ends 1 deg from where it would end alone")
        assert f"{known.robot.skeleton.names[known.robot.joints('neck')[0]]} is beyond its range" in text


def test_nobody_is_warned_where_nothing_of_the_block_holds(known, need):
    assert end_warnings(motion(known, 0.5), [need(None)], [need(0.2)], known.robot) == []


def test_step_counts_its_time_from_the_knot_that_leads(known):
    ramp = HeldRamp(np.array([2.0, 0.0]), begin=2 * STEP, end=4 * STEP)
    np.testing.assert_allclose(ramp.at(8, lead=3)[:, 0], [0, 0, 0, 0, 0, 0, 1, 2], atol=1e-12)
    assert not ramp.at(8, lead=3)[:, 1].any()
    sudden = HeldRamp(np.ones(1), begin=STEP, end=STEP)
    np.testing.assert_allclose(sudden.at(4, lead=0)[:, 0], [0, 0, 1, 1], atol=1e-12)


def test_later_look_removes_the_value_of_the_earlier_one(steps, need, least):
    running, coming = need(0.3, begin=-3.0, ready=-2.0, end=-2.0), need(-0.2)
    assert steps([running], [coming], ends=0.3) == [(-0.3, 1.0, 2.0)]
    hasty = need(-0.2, begin=1.0, ready=1.001, end=1.001)
    assert steps([running], [hasty], ends=0.3) == [(-0.3, 1.0, pytest.approx(1.0 + least(0.3)))]


def test_nothing_is_removed_for_behaviours_of_other_roles(steps, need):
    running = need(0.3, begin=-3.0, ready=-2.0, end=-2.0)
    assert steps([running], [need(role="sign")], ends=0.3) == []
    assert steps([running], [need(0.1, role="trunk")], ends=0.3) == [(0.0, 1.0, 2.0)]


def test_what_limits_have_cut_goes_with_the_value_that_is_removed_once(steps, need):
    running = need(0.3, begin=-3.0, ready=-2.0, end=-2.0)
    assert steps([running], [need(-0.2)], ends=0.25) == [(-0.25, 1.0, 2.0)]
    both = [need(-0.2), need(0.1, role="trunk")]
    assert steps([running], both, ends=0.25) == [(-0.25, 1.0, 2.0), (0.0, 1.0, 2.0)]
    assert steps([], [need(-0.2)], ends=0.1) == [(-0.1, 1.0, 2.0)]


def test_look_that_goes_back_hides_what_is_held_and_shows_it_again(steps, need, least):
    running = need(0.3, begin=-3.0, ready=-2.0, end=-2.0)
    gaze = need(None, begin=1.0, ready=2.0, relax=4.0, end=6.0)
    assert steps([running], [gaze], ends=0.3) == [(-0.3, 1.0, 2.0), (0.3, 4.0, 6.0)]
    brief = need(None, begin=1.0, ready=2.0, relax=4.0, end=4.001)
    back = steps([running], [brief], ends=0.3)[1]
    assert back == (0.3, pytest.approx(4.001 - least(0.3)), 4.001)


def test_look_that_begins_before_another_is_back_takes_over_from_it(steps, need):
    running = need(0.3, begin=-3.0, ready=-2.0, end=-2.0)
    gaze = need(None, begin=1.0, ready=2.0, relax=4.0, end=6.0)
    soon, later = need(-0.2, begin=5.0, ready=7.0, end=7.0), need(-0.2, begin=6.0, ready=8.0, end=8.0)
    assert steps([running], [gaze, soon], ends=0.3) == [(-0.3, 1.0, 2.0), (0.0, 5.0, 7.0)]
    assert steps([running], [gaze, later], ends=0.3) == [(-0.3, 1.0, 2.0), (0.3, 4.0, 6.0), (-0.3, 6.0, 8.0)]


def test_look_that_is_left_out_shows_nothing(steps, need):
    running = need(0.3, begin=-3.0, ready=-2.0, end=-2.0)
    assert steps([running], [], [need(-0.2)], ends=0.3) == [(0.2, 1.0, 2.0)]
    assert steps([running], [], [need(None, relax=4.0, end=6.0)], ends=0.3) == []


def test_running_look_that_is_still_to_come_has_its_step_once_the_block_needs_the_role(steps, need):
    late = need(0.3, begin=0.5, ready=5.0, end=5.0)
    found = steps([late], [need(-0.2, begin=1.0, ready=2.0, end=2.0)], ends=0.3)
    assert found == [(0.0, 1.0, 2.0), (0.2, 1.0, 5.0)]
    late = need(0.3, begin=3.0, ready=5.0, end=5.0)
    found = steps([late], [need(-0.2, begin=1.0, ready=2.0, end=2.0)], ends=0.3)
    assert found == [(0.0, 1.0, 2.0), (0.2, 3.0, 5.0)]


def test_running_look_that_is_cut_by_limits_shows_what_is_left_of_it(steps, need):
    before, late = need(0.1, begin=-3.0, ready=-2.0, end=-2.0), need(0.3, begin=3.0, ready=5.0, end=5.0)
    found = steps([before, late], [need(-0.2, begin=1.0, ready=2.0, end=2.0)], ends=0.25)
    assert found == [(-0.1, 1.0, 2.0), (pytest.approx(0.3), 3.0, 5.0)]


def test_running_gaze_during_a_later_look_looks_where_it_should(steps, need):
    gaze = need(None, begin=3.0, ready=4.0, relax=5.0, end=7.0)
    found = steps([gaze], [need(-0.2, begin=1.0, ready=2.0, end=2.0)], ends=0.0)
    assert found == [(0.0, 1.0, 2.0), (0.2, 3.0, 4.0), (-0.2, 5.0, 7.0)]
