"""Tests of plans with hand paths and overlapping gestures."""

from collections.abc import Callable
from dataclasses import replace
from itertools import count
from pathlib import Path

import numpy as np
import pytest

from kinesic.bml.parse import parse
from kinesic.body.config import ConfigError
from kinesic.expressivity.hands.poses import poses
from kinesic.expressivity.lexicon.lexicon import Lexicon
from kinesic.planning import plan as plan_module
from kinesic.planning.plan import Plan, plan_block
from kinesic.planning.setup import Setup
from kinesic.session.setup import set_up

HAND_DIRECTION = 'palm = "forward", pointing = "forward up"'  # palm and pointing direction of all keys
# gesture file with hand paths
GESTURE_FILE = f"""category = "iconic"
[[gesture]]
id = "circling"
keys = [
  {{ right = {{ at = [0.30, 0.45, 0.60], {HAND_DIRECTION} }} }},
  {{ right = {{ at = [0.30, 0.45, 0.60], {HAND_DIRECTION} }}, path = {{ kind = "circle" }} }},
]
[[gesture]]
id = "waving"
keys = [
  {{ right = {{ at = [0.46, 0.80, 0.46], {HAND_DIRECTION} }} }},
  {{ right = {{ at = [0.46, 0.80, 0.46], {HAND_DIRECTION} }}, path = {{ kind = "wave", frequency = 3 }} }},
]
[[gesture]]
id = "beating"
keys = [
  {{ right = {{ at = [0.34, 0.32, 0.50], palm = "in", pointing = "forward up" }} }},
  {{ right = {{ at = [0.30, 0.05, 0.56], palm = "in", pointing = "forward" }} }},
]
"""

Planner = Callable[..., Plan]
KINESIC_ATTRIBUTE = 'xmlns:kinesic="urn:kinesic"'  # declaration of the kinesic namespace


@pytest.fixture(scope="module")
def planned(known: Setup, tmp_path_factory: pytest.TempPathFactory) -> Planner:
    path: Path = tmp_path_factory.mktemp("own") / "own.toml"
    path.write_text(GESTURE_FILE)
    setup = replace(known, lexicon=Lexicon.load(path))

    def of(inside: str, *settings: str) -> Plan:
        block = parse(
            f'<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" {KINESIC_ATTRIBUTE} id="b">{inside}</bml>'
        )
        return plan_block(block, replace(setup, style=setup.style.changed(settings)))

    return of


def times_of(made: Plan, behaviour: str) -> dict[str, float]:
    return {sync.sync: sync.planned for sync in made.syncs if sync.behaviour == behaviour}


def hand_in_world(made: Plan, times: np.ndarray) -> np.ndarray:
    skeleton = made.setup.robot.skeleton
    wrist = skeleton.segment(made.setup.robot.chains["r_arm"][-1])
    angles = made.trajectory.sample(times + made.trajectory.zero)[0]
    return np.array([skeleton.frames(row).origins[wrist] for row in angles])


@pytest.mark.parametrize(("lexeme", "settings"), [("circling", ()), ("waving", ()), ("circling", ("spatial=-1",))])
def test_planned_hand_passes_all_points_of_its_requested_path_within_1_cm(planned, lexeme, settings):
    made = planned(f'<gesture id="g" lexeme="{lexeme}" mode="RIGHT_HAND" stroke="4"/>', *settings, "whole_body=0")
    syncs = times_of(made, "g")
    assert syncs["stroke"] == pytest.approx(4.0, abs=0.01)
    work = poses(made.setup.lexicon.find(lexeme).form, made.setup.robot, made.setup.style.gesture)
    start, end = (hand.reach.position for hand in work.hands["r"])
    asked = work.path("r", 1).at(start, end, np.linspace(0, 1, 400))
    hand = hand_in_world(made, np.linspace(syncs["strokeStart"], syncs["stroke"], 400))
    away = np.linalg.norm(hand[:, None] - asked[None], axis=2)
    assert away.min(axis=0).max() < 0.01  # every place of the path is passed
    assert away.min(axis=1).max() < 0.012  # and no other
    ways = [np.linalg.norm(np.diff(curve, axis=0), axis=1).sum() for curve in (hand, asked)]
    assert ways[0] == pytest.approx(ways[1], rel=0.06)


def test_waving_in_a_short_time_has_fewer_swings_and_a_punctual_stroke(planned):
    made = planned('<gesture id="g" lexeme="waving" mode="RIGHT_HAND" strokeStart="3" stroke="4"/>')
    assert times_of(made, "g")["stroke"] == pytest.approx(4.0, abs=0.01)
    assert any("of its 3 turns" in notice.text for notice in made.notices)


def test_sync_points_of_repeated_strokes_are_numbered(planned):
    asked = '<gesture id="g" lexeme="beating" stroke="2"/><head id="h" lexeme="NOD" stroke="g:stroke:2"/>'
    once, thrice = (planned(asked, f"repetition={r}") for r in (0, 1))
    assert times_of(once, "g")["stroke"] == pytest.approx(times_of(thrice, "g")["stroke"], abs=0.01)
    assert once.keyframes.outcomes["h"].kind == "dropped"
    assert times_of(thrice, "g")["stroke:2"] == pytest.approx(times_of(thrice, "h")["stroke"], abs=1e-6)
    assert times_of(thrice, "g")["stroke:3"] > times_of(thrice, "g")["stroke:2"] > 2.2


def test_two_overlapping_gestures_of_one_hand_are_both_performed_in_time(planned):
    made = planned(
        '<gesture id="a" lexeme="beating" mode="RIGHT_HAND" stroke="2"/>'
        '<gesture id="b" lexeme="circling" mode="RIGHT_HAND" stroke="4"/>',
        "repetition=1",
    )
    assert {id: outcome.kind for id, outcome in made.keyframes.outcomes.items()} == {"a": "realised", "b": "realised"}
    assert times_of(made, "a")["stroke"] == pytest.approx(2.0, abs=0.01)
    assert times_of(made, "b")["stroke"] == pytest.approx(4.0, abs=0.01)
    assert times_of(made, "a")["strokeEnd"] <= times_of(made, "b")["strokeStart"]


def test_simultaneous_gestures_of_both_hands_are_both_performed(planned):
    made = planned(
        '<gesture id="a" lexeme="beating" mode="RIGHT_HAND" stroke="2"/>'
        '<gesture id="b" lexeme="circling" mode="LEFT_HAND" stroke="2.2"/>'
    )
    assert {outcome.kind for outcome in made.keyframes.outcomes.values()} == {"realised"}
    assert made.keyframes.uses == {"a": {"r_hand"}, "b": {"l_hand"}}


def test_held_posture_moves_slightly_by_breath_and_drift():
    """Plan a hold with idle motion."""
    pose = '<pose part="ARMS" lexeme="ARMS_CROSSED"/>'
    text = f'<bml id="b"><posture id="p" start="0" ready="1" relax="11" end="12">{pose}</posture></bml>'
    block_plan = plan_block(parse(text), set_up(idle=1.0))
    times = np.linspace(3.0, 9.0, 61) + block_plan.trajectory.zero
    angles, speeds, _ = block_plan.trajectory.sample(times)
    assert np.ptp(angles, axis=0).max() > 1e-3
    assert np.abs(speeds).max() < 0.3


def test_plan_returns_state_at_time_or_sync_point(planned):
    made = planned('<head id="h" lexeme="NOD" stroke="1"/>')
    np.testing.assert_array_equal(made.at(0.7).angles, made.trajectory.at(0.7).angles)
    at = made.trajectory.zero + made.syncs["h:stroke"].planned
    np.testing.assert_array_equal(made.at("h:stroke").angles, made.trajectory.at(at).angles)


@pytest.mark.parametrize(("work", "repairs"), [(-1, 0), (300_000, None)])
def test_collisions_are_repaired_only_within_the_planning_budget(planned, monkeypatch, work, repairs):
    usual, asked = plan_module.keep_clear, []

    def spied(*given, **named):
        asked.append(named["repairs"])
        return usual(*given, **named)

    monkeypatch.setattr(plan_module, "keep_clear", spied)
    monkeypatch.setattr(plan_module, "WORK_BUDGET", work)
    planned('<head id="h" lexeme="NOD" stroke="1"/>')
    assert asked == [repairs]


@pytest.mark.parametrize(("work", "gone"), [(300_000, {"b"}), (-1, {"b", "c"})])
def test_colliding_behaviour_is_dropped_and_the_block_is_planned_again(planned, monkeypatch, work, gone):
    """Repeat with a spent budget, which also drops overlapping behaviours."""
    monkeypatch.setattr(plan_module, "WORK_BUDGET", work)
    monkeypatch.setattr(
        plan_module,
        "find_colliding_behaviours",
        lambda frames, *_: {"b": "it is in the way"} if frames.uses.get("b") else {},
    )
    nods = (f'<head id="{id}" lexeme="NOD" start="{k}" end="{k + 2}"/>' for k, id in enumerate("abc"))
    outcomes = planned("".join(nods) + '<head id="z" lexeme="NOD" start="9"/>').keyframes.outcomes
    assert {id for id, outcome in outcomes.items() if outcome.kind == "dropped"} == gone
    assert outcomes["b"].why == "it is in the way"


SPOKEN_BEHAVIOURS = (  # speech that may pause for its two gestures
    '<speech id="s" kinesic:pause="true"><text>See <sync id="a"/>this, <sync id="b"/>this and that one.</text></speech>'
    '<gesture id="g1" lexeme="offer" mode="RIGHT_HAND" stroke="s:a"/>'
    '<gesture id="g2" lexeme="large" mode="BOTH_HANDS" stroke="s:b"/>'
)


@pytest.fixture
def rounds(monkeypatch) -> list[bool]:
    """Record whether each planning round resolves clashes."""
    once, results = plan_module._plan_once, []

    def spied(*given, resolve_clashes=True, **options):
        results.append(resolve_clashes)
        return once(*given, resolve_clashes=resolve_clashes, **options)

    monkeypatch.setattr(plan_module, "_plan_once", spied)
    return results


def test_speech_pauses_are_inserted_before_timing_conflicts_are_resolved(planned, rounds):
    made = planned(SPOKEN_BEHAVIOURS)
    assert any(notice.text.startswith("a pause of") for notice in made.notices)
    assert len(rounds) >= 3
    assert rounds == [False] * (len(rounds) - 1) + [True]


def test_speech_pauses_are_adapted_in_at_most_three_rounds(planned, rounds, monkeypatch):
    find_pauses, errors = plan_module.find_required_pauses, count()

    def find_longer_pauses(timeline, syncs, max_pauses, pauses):
        found = pauses or find_pauses(timeline, syncs, max_pauses, pauses)
        return tuple(replace(pause, until=pause.until + 0.1) for pause in found)

    monkeypatch.setattr(plan_module, "find_required_pauses", find_longer_pauses)
    monkeypatch.setattr(plan_module, "_max_sync_error", lambda plan: next(errors))  # the new plan is asked first
    planned(SPOKEN_BEHAVIOURS)
    assert rounds == [False] * (1 + 3) + [True]


def test_speech_pause_is_not_inserted_after_the_planning_budget_is_spent(planned, rounds, monkeypatch):
    monkeypatch.setattr(plan_module, "WORK_BUDGET", -1)
    made = planned(SPOKEN_BEHAVIOURS)
    assert not any(notice.text.startswith("a pause of") for notice in made.notices)
    assert rounds == [False, True]


def test_block_with_allowed_speech_pauses_is_planned_without_and_then_with_conflict_resolution(planned, rounds):
    planned('<speech id="s" kinesic:pause="true"><text>See <sync id="a"/>this.</text></speech>')
    assert rounds == [False, True]


@pytest.mark.parametrize(
    ("constant", "cost"),
    [
        ("REPLAN_COST_PER_BEHAVIOUR", 10**9),
        ("REPLAN_COST_PER_KEYFRAME", 10**9),
        ("SAMPLE_COST", plan_module.WORK_BUDGET / 100),
    ],
)
def test_block_is_replanned_without_repairs_if_replanning_costs_exceed_the_budget(planned, monkeypatch, constant, cost):
    """Raise the cost of discarded motions above the budget."""
    usual, asked = plan_module.keep_clear, []

    def spied(*given, **named):
        asked.append(named["repairs"])
        return usual(*given, **named)

    monkeypatch.setattr(plan_module, "keep_clear", spied)
    for name in ("REPLAN_COST_PER_BEHAVIOUR", "REPLAN_COST_PER_KEYFRAME", "SAMPLE_COST"):
        monkeypatch.setattr(plan_module, name, cost if name == constant else 0)
    monkeypatch.setattr(
        plan_module,
        "find_colliding_behaviours",
        lambda frames, *_: {"b": "it is in the way"} if frames.uses.get("b") else {},
    )
    planned('<head id="a" lexeme="NOD" start="0"/><head id="b" lexeme="NOD" start="4"/>')
    assert asked == [None, 0]


def test_empty_block_is_planned_as_rest(planned):
    motion = planned("").desired
    assert motion.duration == pytest.approx(plan_module.EMPTY_PLAN_DURATION)
    np.testing.assert_allclose(motion.angles(np.array([0.0]))[0], planned("").setup.robot.skeleton.rest, atol=1e-12)


def test_summary_of_a_plan_names_its_file_or_its_block(planned):
    made = planned("")
    block = made.timeline.block
    for source, name in (("wave.bml", "wave.bml"), ("<text>", f"block {block.id}")):
        summary = str(plan_block(replace(block, source=source), made.setup))
        assert summary.startswith(f"plan of {name} on upper22")


def test_summary_of_a_plan_counts_behaviours_and_notices_above_zero(planned):
    gone = '<gesture id="g" lexeme="xyzzy"/>'
    assert str(planned('<head id="h" lexeme="NOD"/>')).endswith(" s, 1 behaviour")
    summary = str(planned(f'<head id="h" lexeme="NOD"/>{gone}'))
    assert summary.endswith(" s, 2 behaviours, 1 dropped behaviour, 1 notice")


def test_planned_duration_covers_both_motion_and_speech(planned):
    nod, speech = (
        '<head id="h" lexeme="NOD" start="{}"/>',
        '<speech id="s"><text>One, two, three and four.</text></speech>',
    )
    spoken, nodded = planned(speech + nod.format(0)), planned(speech + nod.format(5))
    assert spoken.duration == spoken.trajectory.zero + spoken.utterances["s"].duration > spoken.trajectory.duration
    assert nodded.duration == nodded.trajectory.duration > nodded.trajectory.zero + nodded.utterances["s"].duration


def test_planning_budget_is_proportional_to_the_duration_of_a_long_speech(planned):
    words = "and so we went along the river " * 20
    utterances = planned(f'<speech id="s"><text>{words}</text></speech>').utterances
    seconds = utterances["s"].duration
    assert seconds > 2.0 * plan_module.BUDGETED_SPEECH
    expected = plan_module.WORK_BUDGET * seconds / plan_module.BUDGETED_SPEECH
    assert plan_module._allowed_work(utterances) == pytest.approx(expected)
    assert plan_module._allowed_work({}) == plan_module.WORK_BUDGET == 300_000


def test_style_parameters_are_resolved_for_each_behaviour_that_moves_the_body(planned):
    nod_and_words = '<head id="h" lexeme="NOD" start="0"/><speech id="s"><text>Yes</text></speech>'
    gesture = '<gesture id="g" lexeme="BEAT" start="0" kinesic:power="0.8" xmlns:kinesic="urn:kinesic"/>'
    made = planned(nod_and_words + gesture)
    assert set(made.numbers) == {"h", "g"}
    assert made.numbers["g"].expressivity.power == 0.8
    assert made.numbers["h"].expressivity == made.setup.style.of("head")


def test_saving_a_motion_requires_force_only_to_overwrite_a_file_of_other_content(planned, tmp_path):
    made, path = planned(""), tmp_path / "notes.csv"
    path.write_text("my notes")
    with pytest.raises(ConfigError):
        made.save(path)
    assert path.read_text() == "my notes"
    made.save(path, force=True)
    made.save(path)
    assert path.read_text().startswith("time")
