"""Tests of clearance of plans: hover distance, detours and dropped behaviours."""

import re
from dataclasses import replace

import numpy as np
import pytest

from kinesic.bml.parse import parse
from kinesic.body.dynamics import Clearance
from kinesic.expressivity.lexicon.lexicon import mirror_form
from kinesic.expressivity.style.style import Expressivity, Style
from kinesic.motion.budget import UNLIMITED_BUDGET
from kinesic.planning.certify import certify
from kinesic.planning.clearance import LAG_RESERVE, find_colliding_behaviours
from kinesic.planning.plan import plan_block
from kinesic.session.setup import set_up

DEFAULT_SETUP = set_up()  # setup with default options
DEFAULT_ROBOT = DEFAULT_SETUP.robot
# [m] clearance of plans, with reserve for the tracking lag
PLANNED_CLEARANCE = DEFAULT_ROBOT.min_clearance + LAG_RESERVE
# document whose {} is replaced by behaviours
BML_TEMPLATE = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b">{}</bml>'
WILD_STYLE = Style.uniform(  # style with large, fast and loose movements
    Expressivity(spatial=1, temporal=1, fluidity=1, power=1, tension=-1, repetition=1, openness=1), "wild"
)
# style with small, slow and tense movements
TIGHT_STYLE = Style.uniform(
    Expressivity(spatial=-1, temporal=-1, fluidity=-1, power=-1, tension=1, repetition=-1), "tight"
)
TOUCHED_PAIRS = {  # lexeme -> segments that touch
    "hands_together": {("l_wrist", "r_wrist")},
    "hands_together_forward": {("l_wrist", "r_wrist")},
    "arms_crossed": {("l_wrist", "r_elbow"), ("l_shoulder", "r_wrist")},
    "chin": {("skullbase", "r_wrist")},
    "hands_low": {("humanoid_root", "l_wrist"), ("humanoid_root", "r_wrist")},
}


def planned(body, **changes):
    return plan_block(parse(BML_TEMPLATE.format(body)), replace(DEFAULT_SETUP, **changes))


def gaps(posture):
    return dict(zip(DEFAULT_ROBOT.counted_pairs, DEFAULT_SETUP.distances.gaps(posture[None])[0], strict=True))


def at_sync(made, sync):
    time = next(point.planned for point in made.syncs if point.behaviour == "g" and point.sync == sync)
    return made.trajectory.sample(np.array([time + made.trajectory.zero]))[0][0]


@pytest.mark.parametrize("style", [Style(), WILD_STYLE, TIGHT_STYLE], ids=lambda style: style.name)
@pytest.mark.parametrize("lexeme", TOUCHED_PAIRS)
def test_hand_that_touches_the_body_hovers_10_to_30_mm_away(lexeme, style):
    made = planned(f'<gesture id="g" lexeme="{lexeme}" start="0.5"/>', style=style)
    assert made.keyframes.outcomes["g"].kind == "realised"
    for sync in ("stroke", "relax"):
        posture = gaps(at_sync(made, sync))
        for pair in TOUCHED_PAIRS[lexeme]:
            assert 0.010 <= posture[pair] <= 0.030
    assert made.clearance.distances.min() >= PLANNED_CLEARANCE


@pytest.mark.parametrize("lexeme", TOUCHED_PAIRS)
def test_touching_arm_posture_is_held_until_relax(lexeme):
    body = (
        f'<gesture id="g" lexeme="{lexeme}" start="0" relax="4"/><head id="h" lexeme="NOD" start="2.5" amount="0.2"/>'
    )
    made = planned(body)
    arms = [*DEFAULT_ROBOT.joints("l_arm"), *DEFAULT_ROBOT.joints("r_arm")]
    strokeless = [made.trajectory.zero + time for time in np.linspace(2.4, 3.9, 30)]
    samples = made.trajectory.sample(np.array(strokeless))[0][:, arms]
    if lexeme != "chin":  # which gives way to the nodding head
        assert np.ptp(samples, axis=0).max() < np.radians(1.0)
    assert made.clearance.distances.min() >= PLANNED_CLEARANCE


@pytest.mark.parametrize("lexeme", TOUCHED_PAIRS)
def test_touching_postures_of_left_and_right_are_mirror_images(lexeme):
    turned = DEFAULT_SETUP.lexicon.changed(lambda form: mirror_form(form) if form.id == lexeme else form)
    body = f'<gesture id="g" lexeme="{lexeme}" start="0"/>'
    one = at_sync(planned(body), "stroke")
    other = at_sync(planned(body, lexicon=turned), "stroke")
    for side, across in (("l", "r"), ("r", "l")):
        np.testing.assert_allclose(
            one[list(DEFAULT_ROBOT.joints(f"{side}_arm"))],
            other[list(DEFAULT_ROBOT.joints(f"{across}_arm"))],
            atol=1e-6,
        )


@pytest.mark.parametrize(("first", "second"), [("arms_crossed", "hands_together"), ("chin", "hands_low")])
def test_hands_move_from_one_touching_pose_to_another_without_collision(first, second):
    body = '<gesture id="a" lexeme="{}" start="0" stroke="1.2"/><gesture id="g" lexeme="{}" stroke="3.0"/>'
    for names in ((first, second), (second, first)):
        made = planned(body.format(*names))
        assert {outcome.kind for outcome in made.keyframes.outcomes.values()} == {"realised"}
        assert made.clearance.distances.min() >= PLANNED_CLEARANCE


def test_hands_that_exchange_positions_avoid_each_other():
    body = (
        '<gesture id="a" lexeme="arms_crossed" stroke="1.6"/>'
        '<gesture id="g" lexeme="write" mode="LEFT_HAND" stroke="4"/>'
        '<pointing id="p" target="left" mode="RIGHT_HAND" stroke="6"/>'
    )
    made = planned(body)
    assert not [outcome.why for outcome in made.keyframes.outcomes.values() if outcome.kind == "dropped"]
    assert made.clearance.distances.min() >= PLANNED_CLEARANCE


def test_unavoidable_collision_drops_behaviour_with_reason():
    made = planned('<gesture id="g" lexeme="offer" start="0"/>', robot=replace(DEFAULT_ROBOT, min_clearance=0.2))
    why = made.keyframes.outcomes["g"].why
    assert re.fullmatch(r"brings \w+ within -?\d+ mm of \w+ at -?\d+\.\d\d s", why)


def test_behaviours_that_collide_at_distant_times_are_dropped_in_one_planning_round():
    """Require a clearance that no gesture can keep."""
    conditioned: list[int] = []

    def counted(keys, setup, bonds=(), /, *, limit_scale=1.0, budget=UNLIMITED_BUDGET, memory=None):
        conditioned.append(len(keys))
        return certify(keys, setup, bonds, limit_scale=limit_scale, budget=budget, memory=memory)

    body = "".join(f'<gesture id="g{k}" lexeme="offer" start="{10 * k}"/>' for k in range(4))
    tight = replace(DEFAULT_SETUP, robot=replace(DEFAULT_ROBOT, min_clearance=0.2))
    made = plan_block(parse(BML_TEMPLATE.format(body)), tight, conditioned=counted)
    assert {outcome.kind for outcome in made.keyframes.outcomes.values()} == {"dropped"}
    rounds = len([keys for before, keys in zip([0, *conditioned], conditioned, strict=False) if keys < before])
    assert rounds <= 1


def test_crossed_arms_in_a_calm_style_are_performed_with_the_required_clearance():
    """One detour leaves 1 mm too little clearance; the final plan has enough."""
    block_plan = plan_block(
        parse(BML_TEMPLATE.format('<gesture id="g" lexeme="arms_crossed" stroke="2"/>')),
        replace(DEFAULT_SETUP, style=Style.load("calm")),
    )
    assert block_plan.keyframes.outcomes["g"].kind == "realised"
    assert block_plan.clearance.distances.min() >= PLANNED_CLEARANCE


def named(pair, at, body):
    """Return the behaviours dropped for a collision at a block time [s]."""
    made = planned(body)
    times = np.array([at + made.trajectory.zero])
    close = Clearance(np.array([0.0]), [pair])
    return list(find_colliding_behaviours(made.keyframes, made.motion, times, close, DEFAULT_ROBOT))


BUSY_BEHAVIOURS = (  # behaviours of both hands and the head, 3 s apart
    '<gesture id="right" lexeme="beat" mode="RIGHT_HAND" stroke="1"/>'
    '<gesture id="left" lexeme="beat" mode="LEFT_HAND" stroke="4"/>'
    '<head id="nod" lexeme="NOD" stroke="7"/>'
    '<gesture id="again" lexeme="beat" mode="RIGHT_HAND" stroke="10"/>'
    '<gaze id="aim" target="left" start="7" end="9"/>'
)


@pytest.mark.parametrize(
    ("pair", "at", "name"),
    [
        (("humanoid_root", "r_wrist"), 4.0, "right"),  # though the left hand is the nearest in time
        (("humanoid_root", "l_wrist"), 1.0, "left"),
        (("l_wrist", "humanoid_root"), 10.0, "left"),
        (("humanoid_root", "r_wrist"), 9.0, "again"),  # of two of the right hand the nearer one
        (("humanoid_root", "r_wrist"), 2.5, "right"),
        (("skullbase", "humanoid_root"), 1.0, "nod"),
        (("l_wrist", "r_wrist"), 4.0, "left"),
        (("skullbase", "humanoid_root"), 7.1, "aim"),  # of two at that time the first by name
    ],
)
def test_nearest_behaviour_that_moves_the_colliding_segments_is_dropped(pair, at, name):
    assert named(pair, at, BUSY_BEHAVIOURS) == [name]


def test_nearest_behaviour_is_dropped_if_none_moves_the_colliding_segments():
    gestures = "".join(part + "/>" for part in BUSY_BEHAVIOURS.split("/>") if "gesture" in part)
    assert named(("skullbase", "humanoid_root"), 3.5, gestures) == ["left"]
