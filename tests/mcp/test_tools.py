"""Tools of the MCP server over a robot line and a performer that only record their calls."""

import json
from collections.abc import Callable
from dataclasses import dataclass
from types import SimpleNamespace

import pytest

mcp = pytest.importorskip("mcp", reason="pip install 'kinesic[mcp]'")

from kinesic.body.config import names_of  # noqa: E402 - needs the extra
from kinesic.mcp import server as module  # noqa: E402 - as above
from kinesic.mcp.document_schema import BML_SCHEMA  # noqa: E402 - as above
from kinesic.mcp.errors import RefusedError, RobotError  # noqa: E402 - as above
from kinesic.mcp.parameters import check_choice  # noqa: E402 - as above
from kinesic.mcp.teaching import MODEL_INSTRUCTIONS  # noqa: E402 - as above
from kinesic.mcp.tool_server import describe_errors  # noqa: E402 - as above

from .played_robot import Robot  # noqa: E402 - as above


@pytest.fixture
def robot(monkeypatch: pytest.MonkeyPatch) -> Robot:
    return Robot(monkeypatch)


@pytest.mark.parametrize(
    ("resumes", "answer"), [(True, "stopped"), (False, "stopped; only a person at the robot can resume")]
)
def test_stop_discards_pending_calls_before_it_stops_the_robot(robot: Robot, resumes: bool, answer: str) -> None:
    assert robot.call("stop", resumes=resumes) == (answer, False)
    assert robot.calls == ["discard", "stop", "talk ended"]


def test_stop_that_does_not_reach_the_robot_is_an_error_and_still_discards(robot: Robot) -> None:
    robot.fault = RobotError("the server is gone")
    text, is_error = robot.call("stop")
    assert is_error
    assert "the server is gone" in text
    assert robot.calls == ["discard"]


def test_resume_exists_only_where_a_model_may_resume(robot: Robot) -> None:
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
def test_document_is_performed_as_text_and_its_answer_is_json(robot: Robot, document: object, text: str) -> None:
    assert robot.call("perform", document=document) == ('{"block": "ä"}', False)
    assert robot.calls == [("perform", text)]


@pytest.mark.parametrize("fault", [RefusedError("wrong"), RobotError("wrong")])
def test_refused_document_is_an_error_of_the_tool(robot: Robot, fault: Exception) -> None:
    robot.fault = fault
    text, is_error = robot.call("perform", document="<bml/>")
    assert is_error
    assert text.endswith("wrong")


def test_look_shifts_the_gaze_to_the_audience_or_a_side(robot: Robot, monkeypatch: pytest.MonkeyPatch) -> None:
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


def test_texts_are_performed_with_the_gestures_of_earlier_texts_in_memory(robot: Robot, author: Author) -> None:
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
def test_long_text_and_any_text_during_a_talk_are_streamed(
    robot: Robot, author: Author, length: int, talking: bool
) -> None:
    robot.talking = talking
    text = "a" * length
    assert robot.call("say", text=text) == ('{"block": "ä"}', False)
    is_streamed = talking or length > module.LONG_TEXT
    assert robot.calls == [("speak", text, "") if is_streamed else ("perform", "<aaaaaaaaa>")]


@pytest.mark.parametrize("length", [5, module.LONG_TEXT + 1])
def test_answer_lists_the_parts_of_a_text_that_are_not_spoken(robot: Robot, author: Author, length: int) -> None:
    author.warnings = ("juggles",)
    assert json.loads(robot.call("say", text="a" * length)[0]) == {"block": "ä", "not_spoken": ["juggles"]}


def test_status_is_summarised_with_the_blocks_accepted_before_it(robot: Robot, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "summarise", lambda *arguments: {"summary": arguments})
    assert json.loads(robot.call("status")[0]) == {"summary": ["status", ["warned"], ["first"]]}
    robot.fault = RobotError("gone")
    assert robot.call("status")[1]


def test_wait_passes_its_block_and_time_on(robot: Robot, monkeypatch: pytest.MonkeyPatch) -> None:
    async def wait_for_end(*arguments: object) -> dict[str, object]:
        assert arguments[0] is robot.gate
        return {"waited": arguments[1:]}

    monkeypatch.setattr(module, "wait_for_end", wait_for_end)
    assert json.loads(robot.call("wait", block="b", seconds=3)[0]) == {"waited": ["b", 3]}


def test_gestures_are_searched_in_the_lexicon(robot: Robot, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "search_gestures", lambda *arguments: [{"ä": arguments}])
    assert robot.call("find_gesture", query="large", category="beat", count=2) == (
        '[{"ä": ["lexicon", "large", "beat", 2]}]',
        False,
    )
    assert robot.call("find_gesture", query="large", category="nonesuch")[1]


def test_preview_shows_the_answer_and_a_picture_if_there_is_one(robot: Robot, monkeypatch: pytest.MonkeyPatch) -> None:
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


def test_resources_and_prompt_name_gestures_and_the_schema(robot: Robot, monkeypatch: pytest.MonkeyPatch) -> None:
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


def test_speech_is_appended_with_a_fresh_id_in_its_style(monkeypatch: pytest.MonkeyPatch) -> None:
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


def test_warm_up_runs_the_slow_parts_once(monkeypatch: pytest.MonkeyPatch) -> None:
    calls: list[object] = []
    monkeypatch.setattr(module, "import_at_once", calls.append)
    monkeypatch.setattr(module, "search_gestures", lambda lexicon, *_: calls.append(lexicon))
    monkeypatch.setattr(module, "check_document", lambda write: calls.append(write()))
    monkeypatch.setattr(module, "write_speech", lambda text, style, setup: SimpleNamespace(bml=setup.style))
    kit = Kit()
    assert module.warm_up(kit) is kit
    assert calls == ["kinesic.mcp.stroke_picture", "lexicon", "own"]


def test_first_search_and_speech_of_the_warm_up_are_like_those_of_a_model(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[object] = []
    monkeypatch.setattr(module, "import_at_once", lambda name: None)
    monkeypatch.setattr(module, "search_gestures", lambda *arguments: asked.append(arguments))
    monkeypatch.setattr(module, "check_document", lambda write: write())
    monkeypatch.setattr(module, "write_speech", lambda *arguments: asked.append(arguments) or SimpleNamespace(bml=""))
    module.warm_up(Kit())
    assert asked == [("lexicon", "large", "", 8), ("Hello.", "", Kit())]


def test_hints_of_the_tools_tell_which_move_the_robot(robot: Robot) -> None:
    moving = (False, False, None)  # read only, destructive, idempotent
    expected = dict.fromkeys(("perform", "say", "look", "resume"), moving)
    expected |= dict.fromkeys(("find_gesture", "preview", "status", "wait"), (True, None, None))
    expected["stop"] = (False, None, True)

    async def act(client) -> None:
        hints = {tool.name: tool.annotations for tool in (await client.list_tools()).tools}
        assert {
            name: (hint.read_only_hint, hint.destructive_hint, hint.idempotent_hint) for name, hint in hints.items()
        } == expected

    robot.run(act)


def test_schemas_of_the_parameters_state_limits_choices_and_defaults(robot: Robot) -> None:
    schemas: dict[str, dict[str, dict[str, object]]] = {}

    async def act(client) -> None:
        for tool in (await client.list_tools()).tools:
            schemas[tool.name] = tool.input_schema.get("properties", {})

    robot.run(act)
    assert schemas["say"]["text"]["maxLength"] == 20_000
    assert schemas["say"]["style"]["enum"] == [*names_of("style")]
    assert (schemas["say"]["style"]["type"], schemas["say"]["style"]["default"]) == ("string", "")
    assert schemas["find_gesture"]["query"]["maxLength"] == 200
    count = schemas["find_gesture"]["count"]
    assert (count["minimum"], count["maximum"], count["default"]) == (1, 25, 8)
    assert schemas["find_gesture"]["category"]["enum"] == ["beat"]
    seconds = schemas["wait"]["seconds"]
    assert (seconds["minimum"], seconds["maximum"], seconds["default"]) == (0.0, 50.0, 30.0)
    assert schemas["wait"]["block"]["maxLength"] == 64
    assert schemas["perform"]["document"]["anyOf"][1] == {"type": "string"}
    assert schemas["preview"]["document"]["type"] == ["object", "string"]


def test_longest_document_has_900_000_characters(robot: Robot) -> None:
    assert not robot.call("perform", document="a" * 900_000)[1]
    text, is_error = robot.call("perform", document="a" * 900_001)
    assert is_error
    assert text.startswith("document has 900001 characters, at most 900000 are accepted")


def test_texts_up_to_1500_characters_are_performed_as_one_block() -> None:
    assert module.LONG_TEXT == 1500


def test_empty_choice_is_accepted_and_another_names_all() -> None:
    check = check_choice(["calm", "shy"])
    assert [check(name) for name in ("", "shy")] == ["", "shy"]
    with pytest.raises(ValueError, match=r"^calm, shy$"):
        check("loud")


@pytest.mark.parametrize(
    ("error", "sentence"),
    [
        ({"type": "string_type", "loc": (), "input": "ü"}, 'arguments: "ü" is not a text'),
        ({"type": "int_parsing", "loc": ("n",), "input": "x" * 58}, f'n: "{"x" * 58}" is not a whole number'),
        ({"type": "value_error", "loc": ("n",), "input": "q"}, 'n: "q" is not one of '),
        ({"type": "bool_type", "loc": ("n",), "input": "x" * 59}, f'n: "{"x" * 59}... is not a bool'),
        (
            {"type": "literal_error", "loc": ("n",), "input": "q", "ctx": {"expected": "'a' or 'b'"}},
            'n: "q" is not one of a, b',
        ),
        (
            {"type": "value_error", "loc": ("n",), "input": "calme", "ctx": {"error": "calm, shy"}},
            'n: "calme" is not one of calm, shy; did you mean calm?',
        ),
    ],
)
def test_error_of_a_parameter_shows_the_value_and_what_is_expected(error: dict[str, object], sentence: str) -> None:
    assert describe_errors("say", [error]) == sentence


def test_alternatives_of_one_parameter_share_a_sentence_and_are_named_once() -> None:
    errors = [
        {"type": kind, "loc": (name,), "input": 7}
        for name, kind in (("a", "string_type"), ("b", "float_type"), ("a", "dict_type"), ("a", "string_type"))
    ]
    assert describe_errors("say", errors) == "a: 7 is not a text or an object\nb: 7 is not a number"


def test_omissions_of_a_text_are_the_warnings_of_its_reading() -> None:
    assert module.list_omissions("Hello.") == ()
    assert module.list_omissions("See https://example.com now") == ("an address is not spoken: https://example.com",)


@pytest.mark.parametrize(
    ("tool", "arguments", "message"),
    [
        ("say", {}, "say needs the parameter text; nothing was done"),
        ("say", {"text": 5}, "text: 5 is not a text"),
        ("say", {"text": "a", "style": "joyfull"}, 'style: "joyfull" is not one of '),
        ("look", {"at": "BACK"}, 'at: "BACK" is not one of AUDIENCE, LEFT, RIGHT'),
        ("find_gesture", {"query": "a", "count": 0}, "count: 0 is out of range; input should be greater than"),
        ("find_gesture", {"query": "a", "count": 1.5}, "count: 1.5 is not a whole number"),
        ("find_gesture", {"query": "a" * 5000}, "query has 5000 characters, at most "),
        ("wait", {"seconds": "x" * 100}, f'seconds: "{"x" * 59}... is not a number'),
        ("perform", {"document": 7}, "document: 7 is not a text or an object"),
    ],
)
def test_invalid_argument_is_explained_in_a_sentence(robot: Robot, tool: str, arguments: dict, message: str) -> None:
    text, is_error = robot.call(tool, **arguments)
    assert is_error
    assert text.startswith(message)
    assert robot.calls == []


def test_several_invalid_arguments_get_a_line_each_and_a_near_name_is_suggested(robot: Robot) -> None:
    text, _ = robot.call("say", style="joyfull")
    assert [line.partition(" ")[0] for line in text.splitlines()] == ["say", "style:"]
    assert text.endswith("did you mean 'joyful'?") or "did you mean" in text
