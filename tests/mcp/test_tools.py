"""Tools of the MCP server, with stubbed robot line and performer."""

import json
from collections.abc import Callable
from dataclasses import dataclass
from types import SimpleNamespace

import pytest

mcp = pytest.importorskip("mcp", reason="pip install 'kinesic[mcp]'")

from kinesic.mcp import server as module  # noqa: E402 - as above
from kinesic.mcp.document_schema import BML_SCHEMA  # noqa: E402 - as above
from kinesic.mcp.errors import RefusedError, RobotError  # noqa: E402 - as above
from kinesic.mcp.teaching import MODEL_INSTRUCTIONS  # noqa: E402 - as above

from .played_robot import Robot  # noqa: E402 - as above


@pytest.fixture
def robot(monkeypatch: pytest.MonkeyPatch) -> Robot:
    return Robot(monkeypatch)


@pytest.mark.parametrize(
    ("resumes", "answer"), [(True, "stopped"), (False, "stopped; only a person at the robot can resume")]
)
def test_stop_tool_discards_pending_calls_before_it_stops_the_robot(robot: Robot, resumes: bool, answer: str) -> None:
    assert robot.call("stop", resumes=resumes) == (answer, False)
    assert robot.calls == ["discard", "stop", "talk ended"]


def test_failed_stop_tool_reports_an_error_and_still_discards_pending_calls(robot: Robot) -> None:
    robot.fault = RobotError("the server is gone")
    text, is_error = robot.call("stop")
    assert is_error
    assert "the server is gone" in text
    assert robot.calls == ["discard"]


def test_resume_tool_exists_only_if_the_model_may_resume(robot: Robot) -> None:
    assert robot.call("resume") == ("resumed", False)
    assert robot.calls == ["resume"]
    robot.fault = RobotError("gone")
    assert robot.call("resume")[1]

    async def act(client) -> None:
        assert "resume" not in {tool.name for tool in (await client.list_tools()).tools}

    robot.run(act, resumes=False)


@pytest.mark.parametrize(
    ("document", "text"), [("<bml/>", "<bml/>"), ({"id": "ü", "behaviours": []}, '{"id": "ü", "behaviours": []}')]
)
def test_perform_tool_sends_the_document_as_text_and_answers_in_json(robot: Robot, document: object, text: str) -> None:
    assert robot.call("perform", document=document) == ('{"block": "ä"}', False)
    assert robot.calls == [("perform", text)]


@pytest.mark.parametrize("fault", [RefusedError("wrong"), RobotError("wrong")])
def test_perform_tool_reports_a_refused_document_as_an_error(robot: Robot, fault: Exception) -> None:
    robot.fault = fault
    text, is_error = robot.call("perform", document="<bml/>")
    assert is_error
    assert text.endswith("wrong")


def test_look_tool_shifts_the_gaze_to_the_audience_or_a_side(robot: Robot, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "_fresh_id", lambda: "fresh")
    for at in ("AUDIENCE", "LEFT"):
        robot.call("look", at=at)
    texts = [text for _, text in robot.calls]
    start = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="fresh"><gazeShift id="gaze" target="AUDIENCE" '
    assert texts == [
        f'{start}start="0"/></bml>',
        f'{start}start="0" offsetDirection="LEFT" offsetAngle="25"/></bml>',
    ]


class Author:
    """Writer of speeches that records its arguments and counts texts in its memory."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.requests: list[tuple] = []
        self.warnings: tuple[str, ...] = ()
        monkeypatch.setattr(module, "write_speech", self._write)
        monkeypatch.setattr(module, "list_omissions", lambda text: self.warnings)

    def _write(self, text: str, style: str, setup: object, memory: int | None) -> SimpleNamespace:
        self.requests.append((text, style, setup, memory))
        return SimpleNamespace(bml=f"<{text[:9]}>", warnings=self.warnings, memory=(memory or 0) + 1)


@pytest.fixture
def author(monkeypatch: pytest.MonkeyPatch) -> Author:
    return Author(monkeypatch)


def test_say_tool_remembers_the_gestures_of_earlier_texts(robot: Robot, author: Author) -> None:
    async def act(client) -> None:
        for text in ("one", "two", "three"):
            robot.fault = RefusedError("no") if text == "two" else None
            answer = await client.call_tool("say", {"text": text, "style": "joyful"})
            assert answer.content[0].text == ("no" if text == "two" else '{"block": "ä"}')

    robot.run(act)
    assert robot.calls == [("perform", "<one>"), ("perform", "<two>"), ("perform", "<three>")]
    assert author.requests == [
        ("one", "joyful", "setup", None),
        ("two", "joyful", "setup", 1),
        ("three", "joyful", "setup", 1),  # the refused text is forgotten
    ]


@pytest.mark.parametrize(("length", "talking"), [(module.LONG_TEXT, False), (module.LONG_TEXT + 1, False), (5, True)])
def test_say_tool_streams_long_texts_and_any_text_during_streamed_speech(
    robot: Robot, author: Author, length: int, talking: bool
) -> None:
    robot.talking = talking
    text = "a" * length
    assert robot.call("say", text=text) == ('{"block": "ä"}', False)
    is_streamed = talking or length > module.LONG_TEXT
    assert robot.calls == [("speak", text, "") if is_streamed else ("perform", "<aaaaaaaaa>")]


@pytest.mark.parametrize("length", [5, module.LONG_TEXT + 1])
def test_say_tool_lists_the_parts_of_a_text_that_are_not_spoken(robot: Robot, author: Author, length: int) -> None:
    author.warnings = ("juggles",)
    assert json.loads(robot.call("say", text="a" * length)[0]) == {"block": "ä", "not_spoken": ["juggles"]}


def test_status_tool_summarises_the_robot_status_with_the_accepted_blocks(
    robot: Robot, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(module, "summarise", lambda *arguments, conversation: {"summary": [*arguments, conversation]})
    assert json.loads(robot.call("status")[0]) == {"summary": ["status", ["warned"], ["first"], "off"]}
    robot.fault = RobotError("gone")
    assert robot.call("status")[1]


def test_wait_tool_passes_on_the_requested_block_and_time_limit(robot: Robot, monkeypatch: pytest.MonkeyPatch) -> None:
    async def wait_for_end(*arguments: object) -> dict[str, object]:
        assert arguments[0] is robot.gate
        return {"waited": arguments[1:]}

    monkeypatch.setattr(module, "wait_for_end", wait_for_end)
    assert json.loads(robot.call("wait", block="b", seconds=3)[0]) == {"waited": ["b", 3]}


def test_find_gesture_tool_searches_the_lexicon(robot: Robot, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "list_gesture_hits", lambda *arguments: [{"ä": arguments}])
    assert robot.call("find_gesture", query="large", category="beat", count=2) == (
        '[{"ä": ["lexicon", "large", "beat", 2]}]',
        False,
    )
    assert robot.call("find_gesture", query="large", category="nonesuch")[1]


def test_preview_tool_returns_its_answer_and_a_picture_if_available(
    robot: Robot, monkeypatch: pytest.MonkeyPatch
) -> None:
    pictures: list[bytes | None] = [b"png", None]
    faults: list[Exception | None] = [None, None, RefusedError("wrong")]

    class Previewer:
        def __init__(self, gate: object) -> None:
            assert gate is robot.gate

        async def preview(self, write: Callable[[], str]) -> SimpleNamespace:
            if (fault := faults.pop(0)) is not None:
                raise fault
            return SimpleNamespace(answer={"ä": write()}, picture=pictures.pop(0))

    monkeypatch.setattr(module, "Previewer", Previewer)

    async def act(client) -> None:
        drawn, plain, refused = [await client.call_tool("preview", {"document": "<bml/>"}) for _ in range(3)]
        assert [item.type for item in drawn.content] == ["text", "image"]
        assert drawn.content[1].mime_type == "image/png"
        assert [item.text for item in plain.content] == ['{"ä": "<bml/>"}']
        assert refused.is_error
        assert refused.content[0].text == "wrong"

    robot.run(act)


def test_mcp_resources_and_prompt_contain_gesture_names_and_the_document_schema(
    robot: Robot, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(module, "common_gestures", lambda lexicon: f"common of {lexicon}")
    monkeypatch.setattr(module, "all_names", lambda lexicon: f"all of {lexicon}")

    async def act(client) -> None:
        texts = {}
        for name in ("usual", "gestures", "schema"):
            texts[name] = (await client.read_resource(f"kinesic://{name}")).contents[0].text
        assert texts == {"usual": "common of lexicon", "gestures": "all of lexicon", "schema": json.dumps(BML_SCHEMA)}
        prompt = await client.get_prompt("perform_story", {"story": "Once"})
        text = prompt.messages[0].content.text
        assert text.startswith(MODEL_INSTRUCTIONS)
        assert "common of lexicon" in text
        assert text.endswith("Once")

    robot.run(act)


@dataclass(frozen=True)
class Kit:
    """Setup that only has a style and a lexicon."""

    style: object = "own"
    lexicon: str = "lexicon"


@dataclass(frozen=True)
class Written:
    """Text with its document."""

    bml: str
    setup: Kit
    memory: object


def test_bml_of_the_say_tool_is_appended_with_a_unique_id_and_the_requested_style(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    document = '<bml id="said"><speech id="said"/></bml>'
    monkeypatch.setattr(
        "kinesic.session.documents.write_text", lambda text, setup, memory: Written(document, setup, memory)
    )
    monkeypatch.setattr(module, "token_hex", lambda count: "x" * count)
    plain = module.write_speech("text", "", Kit())
    assert plain.bml == '<bml id="mcp-xxxxxx" composition="APPEND"><speech id="said"/></bml>'
    assert plain.setup == Kit()
    styled = module.write_speech("text", "joyful", Kit(), "memory")
    assert styled.bml.startswith('<bml id="mcp-xxxxxx" composition="APPEND" kinesic:style="joyful">')
    assert (styled.setup.style.name, styled.memory) == ("joyful", "memory")
    assert plain.memory is not None


def test_warm_up_of_the_mcp_server_imports_the_picture_module_searches_and_plans_once(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    calls: list[object] = []
    monkeypatch.setattr(module, "import_at_once", calls.append)
    monkeypatch.setattr(module, "list_gesture_hits", lambda lexicon, *_: calls.append(lexicon))
    monkeypatch.setattr(module, "check_document", lambda write: calls.append(write()))
    monkeypatch.setattr(module, "write_speech", lambda text, style, setup: SimpleNamespace(bml=setup.style))
    kit = Kit()
    assert module.warm_up_tools(kit) is kit
    assert calls == ["kinesic.mcp.stroke_picture", "lexicon", "own"]


def test_warm_up_of_the_mcp_server_searches_a_gesture_and_writes_a_speech(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[object] = []
    monkeypatch.setattr(module, "import_at_once", lambda name: None)
    monkeypatch.setattr(module, "list_gesture_hits", lambda *arguments: asked.append(arguments))
    monkeypatch.setattr(module, "check_document", lambda write: write())
    monkeypatch.setattr(module, "write_speech", lambda *arguments: asked.append(arguments) or SimpleNamespace(bml=""))
    module.warm_up_tools(Kit())
    assert asked == [("lexicon", "large", "", 8), ("Hello.", "", Kit())]
