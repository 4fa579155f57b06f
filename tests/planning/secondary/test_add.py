from dataclasses import replace

import numpy as np
import pytest

from kinesic.expressivity.idle import Idling
from kinesic.expressivity.style.style import Style
from kinesic.motion.limit_check import check_limits
from kinesic.planning.certify import MAX_DUTY, compute_peak_duties
from kinesic.planning.secondary import add
from kinesic.session.plan import plan
from kinesic.session.setup import set_up

# document whose {} is replaced by behaviours
BML_TEMPLATE = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b">{}</bml>'
STORY_DOCUMENT = BML_TEMPLATE.format(  # two sentences with two gestures
    '<speech id="s" start="1"><text>Once there was a <sync id="h"/>large garden in the middle of a town, and '
    '<sync id="t"/>nobody thought of it at all, until one day the gate was open.</text></speech>'
    '<gesture id="large" lexeme="large" stroke="s:h" relax="s:h+1.5"/>'
    '<gesture id="think" lexeme="think" stroke="s:t" relax="s:t+1.4" mode="RIGHT_HAND"/>'
)
VELOCITY_RANGE = (0.1, 30.0)  # [deg/s] of a moving head or trunk, from noticeable to large


@pytest.fixture(scope="module")
def known():
    return set_up()


@pytest.fixture(scope="module")
def still(known):
    return plan(STORY_DOCUMENT, known)


@pytest.fixture(scope="module")
def alive(known):
    return plan(STORY_DOCUMENT, replace(known, idling=Idling(1.0, 2)))


def moving(planned, chain, span=None):
    """Return the fraction of speech time in which a chain moves."""
    begin, end = span or next(
        (t.times["start"], t.times["end"]) for t in planned.timeline.timed if t.behaviour.id == "s"
    )
    times = planned.trajectory.zero + np.arange(begin, end, 0.02)
    speeds = np.degrees(np.abs(planned.trajectory.sample(times)[1][:, list(planned.setup.robot.joints(chain))]))
    return float(np.mean(speeds.max(axis=1) > VELOCITY_RANGE[0]))


def test_idle_motion_moves_trunk_and_head_during_most_of_a_speech(still, alive):
    assert moving(still, "torso") < 0.6
    assert moving(alive, "torso") > 0.9
    assert moving(alive, "neck") > 0.9


def test_secondary_motion_moves_no_sync_point(still, alive):
    planned = {(sync.behaviour, sync.sync): sync.planned for sync in still.syncs}
    assert {(sync.behaviour, sync.sync): sync.planned for sync in alive.syncs} == pytest.approx(planned, abs=1e-9)


def test_held_hand_drifts_by_2_to_25_mm_with_idle_motion(still, alive):
    def swept(planned, span):
        times = planned.trajectory.zero + np.arange(*span, 0.02)
        origins = planned.setup.robot.skeleton.frames(planned.trajectory.sample(times)[0]).origins
        return 1000 * float(np.ptp(origins[:, planned.setup.robot.arm("r").wrist], axis=0).max())

    held = still.syncs["large:strokeEnd"].planned + 0.05, still.syncs["large:relax"].planned - 0.05
    assert held[1] - held[0] > 0.8
    assert swept(still, held) < 1.0
    assert 2.0 < swept(alive, held) < 25.0


def test_secondary_motion_keeps_limits_torques_and_distances(known, alive):
    peaks = check_limits(alive.trajectory, known.limits).by_quantity.values()
    assert all(peak.ratios.max() <= 1.0 + 1e-6 for peak in peaks)
    assert compute_peak_duties(alive.trajectory, known).max() <= MAX_DUTY
    assert alive.clearance.distances.min() >= known.robot.min_clearance
    again = known.distances.clearance(alive.trajectory.sample(alive.clearance_times)[0])
    np.testing.assert_allclose(alive.clearance.distances, again.distances, atol=1e-6)
    assert [*alive.clearance.pairs] == [*again.pairs]


def test_secondary_motion_is_repeatable_for_one_seed_and_differs_for_another(known, alive):
    again, other = (plan(STORY_DOCUMENT, replace(known, idling=Idling(1.0, seed))) for seed in (2, 3))
    np.testing.assert_array_equal(again.trajectory.controls, alive.trajectory.controls)
    assert np.abs(other.trajectory.controls[: len(alive.trajectory.controls)] - alive.trajectory.controls).max() > 1e-3


def test_secondary_motion_keeps_the_clearance_of_touching_hands(known):
    tight = BML_TEMPLATE.format('<gesture id="g" lexeme="hands_together" stroke="2" relax="9"/>')
    still, alive = (plan(tight, replace(known, idling=idling)) for idling in (Idling(), Idling(2.0, 1)))
    least = min(float(still.clearance.distances.min()), known.robot.min_clearance + 0.004)
    assert alive.clearance.distances.min() >= least - 1e-6


def test_body_has_no_secondary_motion_while_pointing(known):
    aimed = BML_TEMPLATE.format(
        '<pointing id="p" target="left" start="4" ready="5" relax="7" end="8"/><wait id="w" duration="14"/>'
    )
    still, alive = (plan(aimed, replace(known, idling=idling)) for idling in (Idling(), Idling(1.0, 1)))
    for time in np.linspace(4.1, 7.9, 9):
        np.testing.assert_allclose(
            alive.at(alive.trajectory.zero + time).angles, still.at(time + still.trajectory.zero).angles, atol=1e-6
        )
    assert moving(alive, "torso", (8.5, 13.0)) > 0.8


def test_style_with_whole_body_zero_still_moves_the_torso_but_turns_the_head_less(known):
    def turned(whole_body):
        style = replace(Style.load("neutral"), whole_body=whole_body)
        planned = plan(
            BML_TEMPLATE.format('<speech id="s" start="0"><text>' + "one or another " * 12 + "</text></speech>"),
            replace(known, idling=Idling(1.0, 2), style=style),
        )
        return moving(planned, "torso"), np.degrees(
            np.ptp(planned.trajectory.controls[:, planned.setup.robot.skeleton.names.index("skullbase_torsion")])
        )

    assert turned(0.0)[0] > 0.8
    assert turned(1.0)[1] > turned(0.0)[1]


def test_head_arcs_are_omitted_during_a_nod_but_not_during_a_gaze(known, monkeypatch):
    taken = []
    monkeypatch.setattr(add, "make_head_arcs", lambda motion, spans, *_: taken.append(spans) or iter(()))
    nod = '<head id="h" lexeme="NOD" start="1" end="2"/>'
    gaze = '<gaze id="g" target="left" start="3" ready="3.5" relax="4" end="4.5"/>'
    made = plan(BML_TEMPLATE.format(nod + gaze), replace(known, idling=Idling(1.0, 2)))
    ((span,),) = taken
    times = next(timed.times.values() for timed in made.timeline.timed if timed.behaviour.id == "h")
    assert span == pytest.approx((made.trajectory.zero + min(times), made.trajectory.zero + max(times)), abs=0.02)
