from dataclasses import replace

import numpy as np
import pytest

from kinesic.bml.block import TimedBehaviour
from kinesic.bml.parse import parse
from kinesic.bml.schedule import schedule
from kinesic.expressivity.keyframes import Outcome
from kinesic.metrics.dry_run import DryRun
from kinesic.motion.infeasibility import Bottleneck
from kinesic.motion.keys import Bond, KeyPosture
from kinesic.planning.syncs import (
    MIN_REPORTED_SHORTENING,
    SHIFT_TO_WARN,
    SyncTime,
    _on_path,
    describe_path_changes,
    describe_shifts,
    find_bonds,
    find_limit_met,
    find_planned_spans,
    list_sync_times,
)
from kinesic.session.plan import plan
from kinesic.session.setup import set_up

# three beats with an offset and a precedence constraint
ORDERED_DOCUMENT = """<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b">
  <gesture id="one" lexeme="BEAT" start="0" stroke="1" end="3"/>
  <gesture id="two" lexeme="BEAT" stroke="one:stroke+0.5"/>
  <gesture id="three" lexeme="BEAT" start="4"/>
  <constraint><after ref="one:end"><sync ref="three:start"/></after></constraint>
</bml>"""


def test_notices_name_exactly_the_sync_points_shifted_beyond_the_warning_threshold(
    hurried: DryRun, calm: DryRun
) -> None:
    for performance in (hurried, calm):
        plan = performance.plan
        robot = plan.setup.robot
        notices = describe_shifts(plan.timeline.block, plan.syncs, plan.keyframes, plan.motion, robot)
        moved = [sync for sync in plan.syncs if abs(sync.planned - sync.requested) > SHIFT_TO_WARN]
        named = [name for notice in notices for name in notice.text.partition(" requested at ")[0].split(" and ")]
        assert sorted(named) == sorted(sync.sync for sync in moved)
        assert all(any(name in notice.text for name in robot.skeleton.names) for notice in notices)


def test_equal_shifts_of_one_behaviour_share_a_warning(calm: DryRun) -> None:
    plan = calm.plan
    pose = [SyncTime("g", sync, 1.0, 1.2) for sync in ("stroke", "strokeEnd")]
    others = [SyncTime("g", "relax", 1.3, 1.5), SyncTime("h", "stroke", 1.0, 1.2), SyncTime("h", "end", 1.0, 1.3)]
    notices = describe_shifts(
        plan.timeline.block, (*pose, *others), plan.keyframes, replace(plan.motion, bottlenecks={}), plan.setup.robot
    )
    assert [(notice.id.rpartition(":")[2], notice.text) for notice in notices] == [
        ("g", "stroke and strokeEnd requested at 1.000 s are planned at 1.200 s"),
        ("g", "relax requested at 1.300 s is planned at 1.500 s"),
        ("h", "stroke requested at 1.000 s is planned at 1.200 s"),
        ("h", "end requested at 1.000 s is planned at 1.300 s"),
    ]


def test_explanation_of_a_delay_prefers_limits_of_joints_that_the_behaviour_moves(calm: DryRun) -> None:
    plan = calm.plan
    robot = plan.setup.robot
    own, other = robot.joints("r_arm")[2], robot.joints("neck")[0]
    last = len(plan.motion.requested_times) - 1
    met = {(0, last): Bottleneck(other, "jerk", 2.0), (0, last - 1): Bottleneck(own, "duty", 1.5)}
    motion = replace(plan.motion, bottlenecks=met)
    sync = next(sync for sync in plan.syncs if sync.sync == "stroke")
    assert plan.motion.requested_times[0] <= sync.requested <= plan.motion.requested_times[last - 1]
    assert find_limit_met(sync, plan.keyframes, motion, robot) == met[0, last - 1]
    assert find_limit_met(sync, plan.keyframes, replace(motion, bottlenecks={}), robot) is None
    late = replace(sync, requested=float(np.max(plan.motion.requested_times)))
    assert find_limit_met(late, plan.keyframes, motion, robot) == met[0, last], "the nearer one comes first"


DEFAULT_SETUP = set_up()  # setup with default options
# document whose {} is replaced by behaviours
BML_TEMPLATE = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b">{}</bml>'


def planned(lexeme: str, seconds: float):
    gesture = f'<gesture id="g" lexeme="{lexeme}" strokeStart="1" stroke="{1 + seconds}"/>'
    return plan(BML_TEMPLATE.format(gesture), DEFAULT_SETUP)


def said(made) -> list[str]:
    return [notice.text for notice in made.notices if " % smaller" in notice.text]


@pytest.mark.parametrize("lexeme", ["stir", "crazy"])
def test_rushed_circular_gesture_shrinks_instead_of_delaying_its_stroke(lexeme):
    made = planned(lexeme, 0.15)
    assert all(abs(sync.planned - sync.requested) <= SHIFT_TO_WARN for sync in made.syncs)
    assert [notice.id for notice in made.notices if " % smaller" in notice.text] == ["b:g"]


def test_slow_hand_path_of_a_gesture_is_followed_within_1_cm():
    made = planned("stir", 2.0)
    assert not said(made)
    hand = DEFAULT_SETUP.robot.skeleton.segment("r_wrist")
    asked, result = (
        DEFAULT_SETUP.robot.skeleton.frames(angles).origins[:, hand]
        for angles in (
            np.array([posture.angles for posture in made.postures.postures]),
            made.trajectory.sample(made.motion.planned + made.trajectory.zero)[0],
        )
    )
    soft = [not posture.is_exact for posture in made.postures.postures]
    assert sum(soft) >= 8
    assert np.linalg.norm(asked - result, axis=1).max() <= 0.01


def test_only_hand_path_shortenings_above_a_tenth_are_reported():
    made = planned("stir", 2.0)
    middle = np.mean([posture.angles for posture in made.postures.postures if not posture.is_exact], axis=0)

    def wider(share: float):
        postures = tuple(
            posture if posture.is_exact else replace(posture, angles=middle + (posture.angles - middle) * share)
            for posture in made.postures.postures
        )
        return describe_path_changes(made.timeline.block, postures, made.keyframes, made.motion, DEFAULT_SETUP.robot)

    assert not wider(1.0 + MIN_REPORTED_SHORTENING / 2)
    assert wider(2.0)


def test_synchronised_sync_points_have_precedences_in_both_directions():
    block = parse(ORDERED_DOCUMENT)
    natural = {name: {"ready": 0.3, "stroke": 0.2, "relax": 0.1, "end": 0.3} for name in ("one", "two", "three")}
    bonds = set(find_bonds(schedule(block, {}, natural)))
    one, two = ("one", "stroke"), ("two", "stroke")
    assert {bond for bond in bonds if {bond.earlier, bond.later} == {one, two}} == {
        Bond(two, one, -0.5),
        Bond(one, two, 0.5),
    }
    assert Bond(("one", "end"), ("three", "start"), 0.0) in bonds
    assert not [bond for bond in bonds if bond.earlier[0] == bond.later[0]]


def test_each_sync_point_of_a_performed_behaviour_is_listed_once_in_planned_order():
    speech = '<speech id="s" start="0.5"><text>Good morning.</text></speech>'
    made = plan(BML_TEMPLATE.format(f'{speech}<gesture id="g" lexeme="BEAT" start="0"/>'), DEFAULT_SETUP)
    syncs = list_sync_times(made.keyframes, made.motion)
    assert len({sync.name for sync in syncs}) == len(syncs)
    assert {sync.behaviour for sync in syncs} == {"s", "g"}
    assert [sync.planned for sync in syncs] == sorted(sync.planned for sync in syncs)
    assert all(sync.planned == sync.requested for sync in syncs if sync.behaviour == "s")
    silent = replace(made.keyframes, outcomes={**made.keyframes.outcomes, "s": Outcome("dropped")})
    assert {sync.behaviour for sync in list_sync_times(silent, made.motion)} == {"g"}


def test_unknown_sync_point_error_suggests_points_of_its_behaviour(known) -> None:
    face = '<faceLexeme id="f" lexeme="smile" start="0" attackPeak="1" relax="2" end="3"/>'
    text = f'<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b"><head id="h" lexeme="NOD"/>{face}</bml>'
    syncs = plan(text, known).syncs
    assert syncs["h:stroke"].behaviour == "h"
    with pytest.raises(KeyError) as refused:
        syncs["h:xyzzy"]
    assert "stroke" in str(refused.value)
    assert "attackPeak" not in str(refused.value)
    with pytest.raises(KeyError, match="no behaviour x has sync points"):
        syncs["x:stroke"]


def test_precedence_constraints_link_only_sync_points_of_different_behaviours():
    block = parse(
        BML_TEMPLATE.format(
            '<gesture id="one" lexeme="BEAT" start="0" relax="one:stroke+0.5"/><head id="h" lexeme="NOD" '
            'stroke="one:stroke"/>'
        )
    )
    natural = {name: {"ready": 0.3, "stroke": 0.2, "relax": 0.1, "end": 0.3} for name in ("one", "h")}
    bonds = find_bonds(schedule(block, {}, natural))
    assert {(bond.earlier, bond.later) for bond in bonds} == {
        (("one", "stroke"), ("h", "stroke")),
        (("h", "stroke"), ("one", "stroke")),
    }


def test_time_span_of_a_behaviour_covers_first_to_last_sync_point():
    points = [("a", 1.0), ("b", 5.0), ("a", 3.0), ("a", -2.0), ("a", 0.5)]
    assert find_planned_spans(points) == {"a": (-2.0, 3.0), "b": (5.0, 5.0)}
    assert find_planned_spans([]) == {}


def test_keys_of_a_hand_path_include_both_ends_of_the_stroke(known):
    rest, arm = known.robot.skeleton.rest, known.robot.arm("r").joints[0]
    keyed = tuple(hinge == arm for hinge in range(len(rest)))

    def postures(*is_exact: bool) -> list[KeyPosture]:
        return [KeyPosture(float(k), rest, keyed, (), (), each) for k, each in enumerate(is_exact)]

    action = parse(BML_TEMPLATE.format('<gesture id="g" lexeme="stir"/>')).behaviours[0]
    timed = TimedBehaviour(action, {"strokeStart": 1.0, "strokeEnd": 3.0})
    assert _on_path(postures(True, True, False, True, True), timed, known.robot, "r") == [1, 2, 3]
    assert _on_path(postures(False, True, True, True, False), timed, known.robot, "r") == []
    assert _on_path(postures(True, True, False, True, True), timed, known.robot, "l") == []


@pytest.mark.parametrize(
    ("point", "is_stroke"),
    [("stroke", True), ("stroke:2", True), ("strokeStart", False), ("strokeEnd", False), ("ready", False)],
)
def test_first_and_repeated_stroke_sync_points_are_recognised(point: str, is_stroke: bool):
    assert SyncTime("g", point, 1.0, 1.0).is_stroke is is_stroke
