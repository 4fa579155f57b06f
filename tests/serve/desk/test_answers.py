"""Dispatch of queries and answers of the helper functions, without processes."""

import json
from types import SimpleNamespace

import numpy as np
import pytest
from msgspec import ValidationError
from msgspec.json import decode

from kinesic.expressivity.lexicon.search import find_gestures
from kinesic.planning.setup import Setup
from kinesic.serve.desk import desk as module
from kinesic.serve.desk import drafter
from kinesic.serve.desk.desk import Desk
from kinesic.serve.desk.drafter import NO_FAULT, FileQuestion, answer_draft, draft_failure
from kinesic.serve.desk.dragging import answer_reach, reach_failure
from kinesic.serve.desk.helper import Unanswered
from kinesic.serve.desk.requester import Requester
from kinesic.serve.messages import ServoPlace
from kinesic.serve.wire.questions import (
    AlternativesQuestion,
    AuthorQuestion,
    ExportQuestion,
    FindQuestion,
    GestureQuestion,
    OpenRequest,
    PlanQuestion,
    ReachQuestion,
    SaveRequest,
    ServosQuestion,
    WatchRequest,
)
from kinesic.serve.wire.quotas import Quotas

NOD = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b"><head id="n" lexeme="NOD" start="0"/></bml>'
GESTURE = 'category = "beat"\n\n[[gesture]]\nid = "mine"\nkeys = [{ right = { at = [0.5, 0.3, 0.5] } }]\n'
RULES = Quotas(duration=5.0, planning=3.0)
SHARED_MODULES = ("tables",)  # modules that helper processes preload


class Helper:
    def __init__(self, make_setup: object, answer: object, rules: Quotas, *, name: str) -> None:
        self.name, self.asked, self.warmed, self.closed = name, list[tuple](), 0, 0

    def __class_getitem__(cls, _: object) -> type:
        return cls

    def ask(self, client: int, question: object, reply: object, *, kind: str = "") -> None:
        self.asked.append((client, question, kind))
        self.reply = reply

    def warm_up(self) -> None:
        self.warmed += 1

    def close(self) -> None:
        self.closed += 1


class Room:
    """Stub of subscriptions or document keeper that records its calls."""

    def __init__(self, *_: object) -> None:
        self.taken, self.closed = list[tuple](), 0

    def set(self, requester: Requester, rate: float) -> None:
        self.taken.append((requester.number, rate))

    def take(self, requester: Requester, request: object) -> None:
        self.taken.append((requester.number, request))

    def close(self) -> None:
        self.closed += 1


@pytest.fixture
def rooms(monkeypatch: pytest.MonkeyPatch) -> dict[str, Room | Helper]:
    made: dict[str, Room | Helper] = {}

    def helper(*given: object, name: str, tables: tuple[str, ...]) -> Helper:
        assert tables == SHARED_MODULES
        made[name] = Helper(*given, name=name)
        return made[name]

    def room(name: str):
        return lambda *given: made.setdefault(name, Room(*given))

    maker = type("Maker", (), {"__class_getitem__": classmethod(lambda cls, _: helper)})
    monkeypatch.setattr(module, "Helper", maker)
    monkeypatch.setattr(module, "Watches", room("watches"))
    monkeypatch.setattr(module, "DocumentKeeper", room("keeper"))
    return made


@pytest.fixture
def told() -> list[str]:
    return []


def opened(servos: object = None) -> Desk:
    return Desk(lambda: None, SimpleNamespace(report_body=None, servos=servos), RULES, tables=SHARED_MODULES)


def test_each_client_query_is_passed_to_the_handler_for_its_kind(rooms: dict, told: list[str]):
    desk, requester = opened(), Requester(4, told.append, lambda: True)
    drafts = (
        (PlanQuestion("x"), ""),
        (GestureQuestion(toml="x"), ""),
        (GestureQuestion(lexeme="beat"), "file"),
        (ExportQuestion("x", "csv"), "export"),
        (FindQuestion("x"), "find"),
        (AuthorQuestion("x"), "author"),
        (AlternativesQuestion("x", 0), "alternatives"),
    )
    for question, _ in drafts:
        desk.answer(requester, question)
    assert rooms["drafter"].asked == [(4, question, kind) for question, kind in drafts]
    assert rooms["reacher"].warmed == 2, "whoever writes may drag a hand soon"
    assert not rooms["reacher"].asked
    reach = ReachQuestion((0.0, 0.0, 1.0))
    desk.answer(requester, reach)
    assert rooms["reacher"].asked == [(4, reach, "")]
    desk.answer(requester, WatchRequest(20.0))
    assert rooms["watches"].taken == [(4, 20.0)]
    save, open_ = SaveRequest("a.bml", ""), OpenRequest()
    desk.answer(requester, save)
    desk.answer(requester, open_)
    assert rooms["keeper"].taken == [(4, save), (4, open_)]
    assert not told


def test_answers_and_failures_of_queries_are_sent_to_the_requesting_client(rooms: dict, told: list[str]):
    desk, requester = opened(), Requester(4, told.append, lambda: True)
    for question, helper in ((PlanQuestion("x", id=3), "drafter"), (ReachQuestion((0, 0, 1), id=4), "reacher")):
        desk.answer(requester, question)
        for item in ("an answer", Unanswered.OUTDATED, Unanswered.FAILED):
            rooms[helper].reply(item)
    assert [told[0], told[3]] == ["an answer"] * 2
    assert json.loads(told[1]) == {"told": "plan", "id": 3, "outdated": True}
    assert "took longer than 3 s" in json.loads(told[2])["error"]["text"]
    assert json.loads(told[4]) == {"told": "reach", "id": 4, "outdated": True}
    assert json.loads(told[5])["told"] == "refused"


def test_servo_query_lists_servos_or_returns_an_empty_list(rooms: dict, told: list[str]):
    place = ServoPlace("body", 1, "hinge", "xm430_w210", 80)
    opened(SimpleNamespace(members=(place,))).answer(Requester(4, told.append, bool), ServosQuestion(5))
    opened().answer(Requester(4, told.append, bool), ServosQuestion(6))
    some, none = map(json.loads, told)
    assert some["servos"] == [{"bus": "body", "id": 1, "hinge": "hinge", "model": "xm430_w210", "hottest": 80}]
    assert none == {"told": "servos", "id": 6, "servos": []}


def test_closing_the_query_service_closes_each_of_its_parts_once(rooms: dict):
    opened().close()
    assert {name: room.closed for name, room in rooms.items()} == dict.fromkeys(
        ("drafter", "reacher", "watches", "keeper"), 1
    )


def answered(question: object, setup: Setup) -> dict:
    return json.loads(answer_draft(question, setup, RULES))


def test_answer_to_a_plan_query_repeats_the_query_id(upper22_setup: Setup):
    answer = answered(PlanQuestion(NOD, id=3), upper22_setup)
    assert (answer["told"], answer["id"], answer["block"]) == ("plan", 3, "b")
    assert [item["type"] for item in answer["behaviours"]] == ["head"]
    assert answer["behaviours"][0]["outcome"] == "realised"


def test_plan_query_beyond_a_quota_or_with_an_unknown_setting_returns_an_error(upper22_setup: Setup):
    long = NOD.replace('start="0"', 'start="9"')
    assert "at most 5 s" in answered(PlanQuestion(long), upper22_setup)["error"]["text"]
    deep = "<bml>" + "<a>" * 99 + "</a>" * 99 + "</bml>"
    assert "error" in answered(PlanQuestion(deep), upper22_setup)
    assert "powr" in answered(PlanQuestion(NOD, ("powr=1",)), upper22_setup)["error"]["text"]


def test_gesture_query_plans_a_toml_gesture_or_returns_a_built_in_one_as_toml(upper22_setup: Setup):
    answer = answered(GestureQuestion(toml=GESTURE, id=3), upper22_setup)
    assert (answer["told"], answer["id"], answer["gesture"]) == ("gesture", 3, "mine")
    ours = answered(GestureQuestion(lexeme="beat"), upper22_setup)
    assert 'id = "beat"' in ours["toml"]
    gone = answered(GestureQuestion(lexeme="nobody"), upper22_setup)
    assert gone["error"] == {"line": 1, "column": 1, "text": gone["error"]["text"]}
    assert "nobody" in gone["error"]["text"]


def test_gesture_search_query_lists_gestures_in_the_order_of_the_ranked_search(upper22_setup: Setup):
    answer = answered(FindQuestion("weigh two things", id=5), upper22_setup)
    assert (answer["told"], answer["id"]) == ("find", 5)
    hits = find_gestures(upper22_setup.lexicon, "weigh two things", count=50)
    assert [gesture["id"] for gesture in answer["gestures"]] == [hit.id for hit in hits]
    assert answer["gestures"][0] == {"id": "balance", "category": "metaphoric", "says": hits[0].says, "near": False}
    assert answer["gestures"][1]["near"]
    assert not answered(FindQuestion("versus"), upper22_setup)["gestures"][0]["near"]
    with pytest.raises(ValidationError):
        decode(b'{"do": "find", "words": "' + b"x" * 201 + b'"}', type=FindQuestion)


@pytest.mark.parametrize("question", [GestureQuestion(), GestureQuestion(toml=GESTURE, lexeme="beat")])
def test_gesture_query_needs_exactly_one_of_toml_and_lexeme(upper22_setup: Setup, question: GestureQuestion):
    assert answered(question, upper22_setup)["error"]["text"] == "give either toml or lexeme"


def test_gesture_file_query_returns_no_fault_or_the_reason_for_refusal(upper22_setup: Setup):
    assert answer_draft(FileQuestion("a.toml", GESTURE, None), upper22_setup, RULES) == NO_FAULT
    assert answer_draft(FileQuestion("a.toml", GESTURE, GESTURE), upper22_setup, RULES) == NO_FAULT
    assert "other data than gestures" in answer_draft(FileQuestion("a.toml", GESTURE, "[robot]"), upper22_setup, RULES)
    assert "robot" in answer_draft(FileQuestion("a.toml", "[robot]", None), upper22_setup, RULES)


@pytest.mark.parametrize("defect", [ZeroDivisionError, KeyError, RecursionError, MemoryError])
def test_internal_planning_error_is_returned_as_the_error_of_the_query(
    upper22_setup: Setup, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str], defect: type[Exception]
):
    def fail(*_: object, **__: object) -> None:
        raise defect("a defect")

    monkeypatch.setattr(drafter, "draft", fail)
    monkeypatch.setattr(drafter, "find_fault", fail)
    answer = answered(PlanQuestion(NOD, id=3), upper22_setup)
    assert (answer["told"], answer["id"]) == ("plan", 3)
    assert f"planning failed ({defect.__name__}); please report" in answer["error"]["text"]
    assert defect.__name__ in answer_draft(FileQuestion("a", "", None), upper22_setup, RULES)
    assert "a defect" in capfd.readouterr().err


@pytest.mark.parametrize(
    ("question", "kind"),
    [
        (PlanQuestion("x"), "plan"),
        (ExportQuestion("x", "csv"), "export"),
        (GestureQuestion(), "gesture"),
        (FindQuestion("x"), "find"),
        (AuthorQuestion("x"), "author"),
        (AlternativesQuestion("x", 0), "alternatives"),
    ],
)
def test_failed_or_outdated_query_is_reported_with_the_name_of_the_query(question: object, kind: str):
    outdated = json.loads(draft_failure(question, Unanswered.OUTDATED, RULES))
    failed = json.loads(draft_failure(question, Unanswered.FAILED, RULES))
    assert outdated == {"told": kind, "id": 0, "outdated": True}
    assert failed["told"] == kind
    assert "outdated" not in failed


def reached(setup: Setup, **question: object) -> dict:
    return json.loads(answer_reach(ReachQuestion(**question), setup, RULES))


def test_reach_query_starts_from_the_given_posture_or_the_rest_posture(upper22_setup: Setup):
    robot = upper22_setup.robot
    rest = robot.skeleton.rest
    hand = robot.skeleton.frames(rest).origins[robot.arm("r").wrist]
    result = reached(upper22_setup, target=tuple(hand), id=3)
    assert (result["told"], result["id"], result["reached"], result["residual"]) == ("reach", 3, True, 0.0)
    torso = list(robot.joints("torso"))
    assert np.allclose(np.array(result["angles"])[torso], rest[torso], atol=1e-3)
    bent = np.array(rest)
    bent[torso] += 0.1
    bowed = reached(upper22_setup, target=tuple(hand), posture=tuple(robot.skeleton.clamp(bent)))
    assert np.abs(np.array(bowed["angles"])[torso] - rest[torso]).max() == pytest.approx(0.1, abs=1e-3)


def test_reach_query_moves_the_requested_hand(upper22_setup: Setup):
    robot = upper22_setup.robot
    rest = robot.skeleton.rest
    for side, own, other in (("left", "l_arm", "r_arm"), ("right", "r_arm", "l_arm")):
        target = robot.skeleton.frames(rest).origins[robot.arm(side[0]).wrist] + [0.15, 0.0, 0.15]
        change = np.abs(np.array(reached(upper22_setup, target=tuple(target), side=side)["angles"]) - rest)
        assert change[list(robot.joints(own))].max() > 0.1
        assert change[list(robot.joints(other))].max() < 1e-3


@pytest.mark.parametrize("count", [0, 1, 21, 23])
def test_reach_query_with_a_wrong_number_of_joint_angles_is_refused(upper22_setup: Setup, count: int):
    result = reached(upper22_setup, target=(0, 0, 1), posture=(0.0,) * count, id=3)
    assert (result["told"], result["do"], result["id"]) == ("refused", "reach", 3)
    assert f"posture has {count} angles, upper22 has 22 hinges" in result["why"]


@pytest.mark.parametrize("part", ["trunk", "gaze"])
def test_reach_query_for_a_missing_body_part_returns_the_reason(
    upper22_setup: Setup, monkeypatch: pytest.MonkeyPatch, part: str
):
    assert "angles" in reached(upper22_setup, target=(1.0, 0.3, 1.0), part=part)

    class Without:
        name = "armful"
        skeleton = upper22_setup.robot.skeleton

        def joints(self, chain: str) -> tuple[int, ...]:
            return () if chain == "neck" else (0,)

    found = json.loads(
        answer_reach(ReachQuestion((1, 0, 1), part=part), SimpleNamespace(robot=Without(), distances=None), RULES)
    )
    assert found["why"] == "armful has no neck"


def test_failed_reach_query_reports_the_reason():
    question = ReachQuestion((0, 0, 1), id=3)
    assert json.loads(reach_failure(question, Unanswered.FAILED))["why"] == Unanswered.FAILED.value
