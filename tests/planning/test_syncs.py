from dataclasses import replace

import numpy as np
import pytest

from kinesic.bml.block import TimedBehaviour
from kinesic.bml.parse import parse
from kinesic.bml.schedule import schedule
from kinesic.controller.perform import plan, set_up
from kinesic.controller.performance import Performance
from kinesic.motion.infeasibility import Bottleneck
from kinesic.motion.keys import Bond, KeyPosture
from kinesic.planning.syncs import (
    SHIFT_TO_WARN,
    SMALLER_TO_WARN,
    SyncTime,
    _on_path,
    find_bonds,
    limit_met,
    path_notices,
    planned_spans,
    shift_notices,
)

BLOCK = """<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b">
  <gesture id="one" lexeme="BEAT" start="0" stroke="1" end="3"/>
  <gesture id="two" lexeme="BEAT" stroke="one:stroke+0.5"/>
  <gesture id="three" lexeme="BEAT" start="4"/>
  <constraint><after ref="one:end"><sync ref="three:start"/></after></constraint>
</bml>"""


def test_every_shift_is_warned_and_nothing_else(hurried: Performance, calm: Performance) -> None:
    for performance in (hurried, calm):
        plan = performance.plan
        robot = plan.setup.robot
        notices = shift_notices(plan.timeline.block, plan.syncs, plan.keyframes, plan.motion, robot)
        moved = [sync for sync in plan.syncs if abs(sync.planned - sync.asked) > SHIFT_TO_WARN]
        assert [notice.text.split()[0] for notice in notices] == [sync.sync for sync in moved]
        assert all(any(name in notice.text for name in robot.skeleton.names) for notice in notices)


def test_of_two_limits_as_near_that_of_the_own_hinge_counts(calm: Performance) -> None:
    plan = calm.plan
    robot = plan.setup.robot
    own, other = robot.joints("r_arm")[2], robot.joints("neck")[0]
    last = len(plan.motion.asked) - 1
    met = {(0, last): Bottleneck(other, "jerk", 2.0), (0, last - 1): Bottleneck(own, "duty", 1.5)}
    motion = replace(plan.motion, bottlenecks=met)
    sync = next(sync for sync in plan.syncs if sync.sync == "stroke")
    assert plan.motion.asked[0] <= sync.asked <= plan.motion.asked[last - 1]
    assert limit_met(sync, plan.keyframes, motion, robot) == met[0, last - 1]
    assert limit_met(sync, plan.keyframes, replace(motion, bottlenecks={}), robot) is None
    late = replace(sync, asked=float(np.max(plan.motion.asked)))
    assert limit_met(late, plan.keyframes, motion, robot) == met[0, last], "the nearer one comes first"


SETUP = set_up()
ROOT = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b">{}</bml>'


def planned(lexeme: str, seconds: float):
    gesture = f'<gesture id="g" lexeme="{lexeme}" strokeStart="1" stroke="{1 + seconds}"/>'
    return plan(ROOT.format(gesture), SETUP)


def said(made) -> list[str]:
    return [notice.text for notice in made.notices if " % smaller" in notice.text]


@pytest.mark.parametrize("lexeme", ["stir", "crazy"])
def test_a_hurried_circle_shrinks_before_its_stroke_is_late(lexeme):
    made = planned(lexeme, 0.15)
    assert all(abs(sync.planned - sync.asked) <= SHIFT_TO_WARN for sync in made.syncs)
    assert [notice.id for notice in made.notices if " % smaller" in notice.text] == ["b:g"]


def test_a_path_at_ease_is_followed():
    made = planned("stir", 2.0)
    assert not said(made)
    hand = SETUP.robot.skeleton.segment("r_wrist")
    asked, found = (
        SETUP.robot.skeleton.frames(angles).origins[:, hand]
        for angles in (
            np.array([posture.angles for posture in made.postures.postures]),
            made.trajectory.sample(made.motion.planned + made.trajectory.zero)[0],
        )
    )
    soft = [not posture.firm for posture in made.postures.postures]
    assert sum(soft) >= 8
    assert np.linalg.norm(asked - found, axis=1).max() <= 0.01


def test_how_much_smaller_is_the_share_of_the_length():
    made = planned("stir", 2.0)
    middle = np.mean([posture.angles for posture in made.postures.postures if not posture.firm], axis=0)

    def wider(share: float):
        postures = tuple(
            posture if posture.firm else replace(posture, angles=middle + (posture.angles - middle) * share)
            for posture in made.postures.postures
        )
        return path_notices(made.timeline.block, postures, made.keyframes, made.motion, SETUP.robot)

    assert not wider(1.0 + SMALLER_TO_WARN / 2)
    assert wider(2.0)


def test_ties_between_behaviours_bind_both_ways_and_orders_one_way():
    block = parse(BLOCK)
    natural = {name: {"ready": 0.3, "stroke": 0.2, "relax": 0.1, "end": 0.3} for name in ("one", "two", "three")}
    found = set(find_bonds(schedule(block, {}, natural)))
    one, two = ("one", "stroke"), ("two", "stroke")
    assert {bond for bond in found if {bond.earlier, bond.later} == {one, two}} == {
        Bond(two, one, -0.5),
        Bond(one, two, 0.5),
    }
    assert Bond(("one", "end"), ("three", "start"), 0.0) in found
    assert not [bond for bond in found if bond.earlier[0] == bond.later[0]]


def test_a_wrong_name_is_told_the_points_of_its_own_behaviour_alone(known) -> None:
    face = '<faceLexeme id="f" lexeme="smile" start="0" attackPeak="1" relax="2" end="3"/>'
    text = f'<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b"><head id="h" lexeme="NOD"/>{face}</bml>'
    syncs = plan(text, known).syncs
    assert syncs["h:stroke"].behaviour == "h"
    with pytest.raises(KeyError) as refused:
        syncs["h:xyzzy"]
    assert "stroke" in str(refused.value)
    assert "attackPeak" not in str(refused.value)


def test_points_of_one_behaviour_are_not_bound_to_one_another():
    block = parse(
        ROOT.format(
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


def test_span_of_a_behaviour_is_from_its_first_point_to_its_last():
    points = [("a", 1.0), ("b", 5.0), ("a", 3.0), ("a", -2.0), ("a", 0.5)]
    assert planned_spans(points) == {"a": (-2.0, 3.0), "b": (5.0, 5.0)}
    assert planned_spans([]) == {}


def test_keys_of_a_path_are_those_of_its_stroke_with_both_ends(known):
    rest, arm = known.robot.skeleton.rest, known.robot.arm("r").joints[0]
    keyed = tuple(hinge == arm for hinge in range(len(rest)))

    def postures(*firm: bool) -> list[KeyPosture]:
        return [KeyPosture(float(k), rest, keyed, (), (), each) for k, each in enumerate(firm)]

    action = parse(ROOT.format('<gesture id="g" lexeme="stir"/>')).behaviours[0]
    timed = TimedBehaviour(action, {"strokeStart": 1.0, "strokeEnd": 3.0})
    assert _on_path(postures(True, True, False, True, True), timed, known.robot, "r") == [1, 2, 3]
    assert _on_path(postures(False, True, True, True, False), timed, known.robot, "r") == []
    assert _on_path(postures(True, True, False, True, True), timed, known.robot, "l") == []


@pytest.mark.parametrize(
    ("point", "is_stroke"),
    [("stroke", True), ("stroke:2", True), ("strokeStart", False), ("strokeEnd", False), ("ready", False)],
)
def test_strokes_are_the_first_and_its_repetitions(point: str, is_stroke: bool):
    assert SyncTime("g", point, 1.0, 1.0).is_stroke is is_stroke
