"""Tests of timing conflicts, of which one gesture is dropped."""

import pytest

from kinesic.bml.block import BmlError
from kinesic.bml.parse import parse
from kinesic.motion.keys import KeyPosture, Keys
from kinesic.planning import clashes
from kinesic.planning.clashes import NEGLIGIBLE_CLASH, VISIBLE_CLASH, Neighbours, compute_reversal_times, sum_chains
from kinesic.planning.plan import Plan, plan_block
from kinesic.planning.quick_plan import plan_quickly

# document whose {} is replaced by behaviours
BML_TEMPLATE = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b">{}</bml>'
OTHER_BEHAVIOURS = (  # behaviours that move no hand
    '<speech id="s"><text>Let me <sync id="m"/>ask you about it.</text></speech>'
    '<gaze id="z" target="left" start="1.0" end="2.6"/><torso id="t" lexeme="lean forward" ready="1.3" end="3.0"/>'
)
FIRST_GESTURE = '<gesture id="ask" lexeme="{}" {} stroke="1.8"/>'  # earlier gesture with a given lexeme and attributes
# later gesture with a given lexeme, attributes and stroke time [s]
SECOND_GESTURE = '<gesture id="next" lexeme="{}" {} stroke="{}"/>'


def document(first: str, second: str, later: float, mode: str) -> tuple[str, str, str]:
    """Return documents with both gestures, the first and the second alone.

    Each has speech, gaze and torso motion in addition.
    """
    one, two = FIRST_GESTURE.format(first, mode), SECOND_GESTURE.format(second, mode, 1.8 + later)
    a, b, c = (BML_TEMPLATE.format(OTHER_BEHAVIOURS + inside) for inside in (one + two, one, two))
    return a, b, c


@pytest.fixture
def planned(known):
    return lambda text: plan_block(parse(text), known)


def times(plan: Plan) -> dict[str, float]:
    return {sync.name: sync.planned for sync in plan.syncs}


def fates(plan: Plan) -> dict[str, str]:
    return {id: outcome.kind for id, outcome in plan.keyframes.outcomes.items() if id in ("ask", "next")}


BOTH_HANDS = 'mode="BOTH_HANDS"'  # attribute of a two-handed gesture
RIGHT_HAND = 'mode="RIGHT_HAND"'  # attribute of a gesture of the right hand


@pytest.mark.parametrize(
    ("first", "second", "later", "mode"),
    [
        ("love", "contrast_left_right", 0.55, BOTH_HANDS),
        ("air_quotes", "sorry", 0.4, BOTH_HANDS),
        ("usher", "victory", 0.33, RIGHT_HAND),
    ],
)
def test_later_of_two_gestures_in_timing_conflict_is_dropped(planned, first, second, later, mode):
    both, alone, _ = document(first, second, later, mode)
    result, without = planned(both), planned(alone)
    assert result.keyframes.outcomes["next"].kind == "dropped"
    assert "after the stroke of ask at 1.80 s" in result.keyframes.outcomes["next"].why
    assert any(notice.id == "b:next" and "ask" in notice.text for notice in result.notices)
    assert times(result) == pytest.approx(times(without), abs=1e-3)


def test_notice_of_a_timing_conflict_suggests_a_feasible_stroke_time(planned):
    both, _, _ = document("love", "contrast_left_right", 0.55, BOTH_HANDS)
    why = planned(both).keyframes.outcomes["next"].why
    at = float(why.split("with its stroke at ")[1].split(" s")[0])
    later = planned(document("love", "contrast_left_right", at - 1.8, BOTH_HANDS)[0])
    assert "dropped" not in fates(later).values()
    assert abs(times(later)["ask:stroke"] - 1.8) < VISIBLE_CLASH


def test_beat_is_dropped_for_a_later_more_important_gesture(planned):
    both, _, alone = document("beat_fist_palm", "large", 0.3, BOTH_HANDS)
    result = planned(both)
    assert fates(result)["ask"] == "dropped"
    assert "gives way to next, which is more important" in result.keyframes.outcomes["ask"].why
    assert times(result) == pytest.approx(times(planned(alone)), abs=1e-3)


def test_two_gestures_with_strokes_0_6_s_apart_are_both_performed(planned):
    for later in (0.6, 0.8):
        result = planned(document("offer", "large", later, BOTH_HANDS)[0])
        assert "dropped" not in fates(result).values()
        strokes = [times(result)[f"{id}:stroke"] for id in ("ask", "next")]
        assert strokes[1] - strokes[0] - later < VISIBLE_CLASH


def test_gesture_in_timing_conflict_moves_to_the_free_hand(planned):
    result = planned(document("usher", "no_wag", 0.33, "")[0])
    assert fates(result)["next"] == "substituted"
    assert result.keyframes.uses["next"] == {"l_hand"}


def test_quick_and_full_plans_drop_the_same_conflicting_gestures(known):
    for case in (("love", "contrast_left_right", 0.55, BOTH_HANDS), ("offer", "large", 0.6, BOTH_HANDS)):
        block = parse(document(*case)[0])
        assert fates(plan_quickly(block, known)) == fates(plan_block(block, known))


@pytest.mark.soak
def test_eight_gestures_0_6_s_apart_drop_one_to_three_so_that_delays_do_not_add_up(planned):
    names = ("offer", "large", "love", "contrast_left_right", "air_quotes", "sorry", "ask_open", "run")
    row = "".join(
        f'<gesture id="g{k}" lexeme="{name}" mode="BOTH_HANDS" stroke="{1 + 0.6 * k:.1f}"/>'
        for k, name in enumerate(names)
    )
    result = planned(BML_TEMPLATE.format(row))
    kinds = [outcome.kind for outcome in result.keyframes.outcomes.values()]
    assert 1 <= kinds.count("dropped") <= 3
    drift = max(abs(sync.planned - sync.requested) for sync in result.syncs if sync.sync == "stroke")
    assert drift <= 1.25 * VISIBLE_CLASH  # no pair lacks more than `VISIBLE_CLASH`, and a row no more than a pair


def test_delays_add_up_over_the_longest_unbroken_chain_of_gestures():
    def near(first: str, second: str) -> Neighbours:
        return Neighbours((first, second), (0, 1), ())

    pairs = [near("a", "b"), near("b", "c"), near("a", "d"), near("c", "e"), near("e", "f")]
    result = sum_chains(pairs, [0.1, 0.15, 0.12, NEGLIGIBLE_CLASH / 2, 0.3])
    assert result == pytest.approx([0.25, 0.25, 0.12, 0.25 + NEGLIGIBLE_CLASH / 2 + 0.3, 0.3])


def test_conflicting_rest_pose_is_deferred_to_the_gesture_retraction(planned):
    pose = '<gesture id="next" lexeme="hands_low" start="1.95" end="2.2"/>'
    ask = FIRST_GESTURE.format("offer", 'relax="2.6"')
    result, alone = (
        planned(BML_TEMPLATE.format(OTHER_BEHAVIOURS + ask + pose)),
        planned(BML_TEMPLATE.format(OTHER_BEHAVIOURS + ask)),
    )
    assert set(fates(result).values()) == {"realised"}
    assert any("as the hands go back from ask" in notice.text for notice in result.notices)
    for sync in ("ask:stroke", "ask:relax", "z:start", "t:ready"):
        assert times(result)[sync] == pytest.approx(times(alone)[sync], abs=1e-3)


def test_timing_conflict_drops_no_required_gesture_and_refuses_two_required_ones(planned):
    one, two = FIRST_GESTURE.format("love", BOTH_HANDS), SECOND_GESTURE.format("contrast_left_right", BOTH_HANDS, 2.35)
    assert fates(planned(BML_TEMPLATE.format(f"{one}<required>{two}</required>"))) == {
        "ask": "dropped",
        "next": "realised",
    }
    with pytest.raises(BmlError, match="next is required"):
        planned(BML_TEMPLATE.format(f"<required>{one}{two}</required>"))


def test_minimum_time_of_a_hinge_is_computed_between_its_reversals(known):
    rest, hinge = known.robot.skeleton.rest, known.robot.arm("r").joints[0]
    rows = []
    for k, angle in enumerate((0.0, 0.1, 0.3, 0.3, 0.2)):
        angles = rest.copy()
        angles[hinge] += angle
        rows.append(KeyPosture.whole(float(k), angles))
    reversal_times = compute_reversal_times(Keys.of(rows, known.limits))
    own = {pair: least for (joint, pair), least in reversal_times.items() if joint == hinge}
    assert own.keys() == {(0, 2), (2, 3), (3, 4)}
    assert own[0, 2] > own[3, 4] > own[2, 3] == 0.0


def test_gesture_whose_stroke_has_no_hand_motion_is_not_dropped(planned):
    lexemes = {"own_mouth": 7.78, "hands_ready": 8.09, "crossed_fingers": 8.61}
    lines = [f'<gesture id="{name}" lexeme="{name}" stroke="{stroke}"/>' for name, stroke in lexemes.items()]
    outcomes = planned(BML_TEMPLATE.format("".join(lines))).keyframes.outcomes.values()
    assert all(outcome.kind != "dropped" for outcome in outcomes)


def test_timing_conflicts_are_estimated_after_the_maximum_of_exact_searches(planned, monkeypatch):
    searched: list[Neighbours] = []
    exactly = clashes._search

    def search(pair, postures, setup, budget, memory):
        searched.append(pair)
        return exactly(pair, postures, setup, budget, memory)

    monkeypatch.setattr(clashes, "_search", search)
    crowd = BML_TEMPLATE.format(
        "".join(f'<gesture id="g{k}" lexeme="beat" {RIGHT_HAND} stroke="{1 + 0.25 * k}"/>' for k in range(3))
    )
    every = planned(crowd)
    assert len(searched) > 1
    searched.clear()
    monkeypatch.setattr(clashes, "MAX_EXACT_SEARCHES", 1)
    assert planned(crowd).duration <= every.duration + 0.5  # an estimate asks for more time, so that more give way
    assert len(searched) == 1


def test_block_of_too_many_gestures_drops_some_by_estimated_timing_conflicts(planned, monkeypatch):
    rounds = []
    look = clashes.ClashFinder.look

    def counted(finder, frames, postures):
        found = look(finder, frames, postures)
        rounds.append(len(found))
        return found

    def search(*_):
        raise AssertionError("nothing of a crowd is searched exactly")

    monkeypatch.setattr(clashes.ClashFinder, "look", counted)
    monkeypatch.setattr(clashes, "_search", search)
    monkeypatch.setattr(clashes, "MAX_EXACT_PAIRS", 3)
    lines = (f'<gesture id="g{k}" lexeme="large" {BOTH_HANDS} stroke="{1 + 0.3 * k}"/>' for k in range(12))
    outcomes = planned(BML_TEMPLATE.format("".join(lines))).keyframes.outcomes
    thinned = {id for id, found in outcomes.items() if found.why.startswith("12 behaviours overlap")}
    kept = {id for id, found in outcomes.items() if found.kind != "dropped"}
    assert thinned >= {f"g{k}" for k in range(6, 12)}
    assert kept
    assert kept <= {f"g{k}" for k in range(6)}
    assert len(rounds) <= 4


def counted(apart: float) -> str:
    numbers = enumerate(("one", "two", "three", "four", "five"))
    return BML_TEMPLATE.format(
        "".join(f'<gesture id="g{k}" lexeme="count_{n}" stroke="{1 + apart * k}"/>' for k, n in numbers)
    )


@pytest.mark.parametrize("apart", [0.24, *(pytest.param(apart, marks=pytest.mark.soak) for apart in (0.28, 0.3)), 0.31])
def test_finger_counts_at_least_0_24_s_apart_are_performed_on_time_without_drops(planned, apart):
    result = planned(counted(apart))
    assert "dropped" not in {outcome.kind for outcome in result.keyframes.outcomes.values()}
    strokes = [times(result)[f"g{k}:stroke"] for k in range(5)]
    assert strokes == pytest.approx([1 + apart * k for k in range(5)], abs=0.01)


def test_some_finger_counts_0_06_s_apart_are_dropped_with_a_reason(planned):
    outcomes = planned(counted(0.06)).keyframes.outcomes
    dropped = [outcome.why for outcome in outcomes.values() if outcome.kind == "dropped"]
    assert 0 < len(dropped) < 5
    assert all("s late" in why or "is busy" in why for why in dropped)


def test_timing_conflict_search_skips_the_linear_program_for_small_delays(known, monkeypatch):
    monkeypatch.setattr(clashes, "solve_key_times", lambda problem: pytest.fail("nothing can move so far apart"))
    block = parse(
        '<bml id="b"><gesture id="g" lexeme="beat" stroke="1.5"/><gesture id="h" lexeme="beat" stroke="3"/></bml>'
    )
    quick_plan = plan_quickly(block, known)
    assert {outcome.kind for outcome in quick_plan.keyframes.outcomes.values()} == {"realised"}


def test_timing_conflict_search_that_exceeds_its_budget_keeps_the_estimated_delay(planned, monkeypatch):
    def search(pair, postures, setup, budget, memory):
        budget.spend(10 * clashes.SEARCH_BUDGET)
        return 99.0

    monkeypatch.setattr(clashes, "_search", search)
    both, _, _ = document("love", "contrast_left_right", 0.55, BOTH_HANDS)
    result = planned(both)
    assert result.keyframes.outcomes["next"].kind == "dropped"
    assert float(result.keyframes.outcomes["next"].why.split(" s late")[0].rsplit(" ", 1)[1]) < 1.0


def test_each_round_resolves_at_most_one_timing_conflict_per_gesture(planned, monkeypatch):
    look, rounds = clashes.ClashFinder.look, []

    def spied(finder, frames, postures):
        before = set(finder.clashes)
        result = look(finder, frames, postures)
        rounds.append(set(finder.clashes) - before)
        return result

    monkeypatch.setattr(clashes.ClashFinder, "look", spied)
    lines = (f'<gesture id="g{k}" lexeme="large" {BOTH_HANDS} stroke="{1 + 0.35 * k:.2f}"/>' for k in range(4))
    planned(BML_TEMPLATE.format("".join(lines)))
    assert len(rounds) > 1
    for added in rounds:
        ids = [id for pair in added for id in pair]
        assert len(ids) == len(set(ids))
