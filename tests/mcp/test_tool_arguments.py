"""Parameters of the MCP tools: limits, choices, and errors of invalid arguments."""

import pytest

mcp = pytest.importorskip("mcp", reason="pip install 'kinesic[mcp]'")

from kinesic.body.config import names_of  # noqa: E402 - needs the extra
from kinesic.mcp import server as module  # noqa: E402 - as above
from kinesic.mcp.parameters import check_choice  # noqa: E402 - as above
from kinesic.mcp.tool_server import describe_errors  # noqa: E402 - as above

from .played_robot import Robot  # noqa: E402 - as above


@pytest.fixture
def robot(monkeypatch: pytest.MonkeyPatch) -> Robot:
    return Robot(monkeypatch)


def test_tool_annotations_mark_the_tools_that_move_the_robot(robot: Robot) -> None:
    moving = (False, False, None)  # read only, destructive, idempotent
    expected = dict.fromkeys(("perform", "say", "look", "resume"), moving)
    expected |= dict.fromkeys(("find_gesture", "preview", "status", "wait"), (True, None, None))
    expected["stop"] = (False, None, True)
    expected |= dict.fromkeys(("converse", "think"), (False, False, True))

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
    assert schemas["say"]["text"]["maxLength"] == 200_000
    assert schemas["say"]["style"]["enum"] == [*names_of("style")]
    assert (schemas["say"]["style"]["type"], schemas["say"]["style"]["default"]) == ("string", "")
    assert schemas["find_gesture"]["query"]["maxLength"] == 200
    count = schemas["find_gesture"]["count"]
    assert (count["minimum"], count["maximum"], count["default"]) == (1, 25, 8)
    assert schemas["find_gesture"]["category"]["enum"] == ["beat"]
    seconds = schemas["wait"]["seconds"]
    assert (seconds["minimum"], seconds["maximum"], seconds["default"]) == (0.0, 50.0, 30.0)
    assert schemas["wait"]["block"]["maxLength"] == 64
    amount = schemas["converse"]["amount"]
    assert (amount["minimum"], amount["maximum"], amount["default"]) == (0.0, 1.0, 1.0)
    assert schemas["converse"]["fillers"]["default"] is False
    assert schemas["perform"]["document"]["anyOf"][1] == {"type": "string"}
    assert schemas["preview"]["document"]["type"] == ["object", "string"]


def test_perform_tool_accepts_documents_of_at_most_900_000_characters(robot: Robot) -> None:
    assert not robot.call("perform", document="a" * 900_000)[1]
    text, is_error = robot.call("perform", document="a" * 900_001)
    assert is_error
    assert text.startswith("document has 900001 characters, at most 900000 are accepted")


def test_say_tool_limit_of_texts_performed_as_one_block_is_1500_characters() -> None:
    assert module.LONG_TEXT == 1500


def test_tool_parameter_with_choices_may_be_empty_and_an_unknown_choice_error_lists_all() -> None:
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
def test_error_of_a_tool_parameter_shows_the_value_and_what_is_expected(
    error: dict[str, object], sentence: str
) -> None:
    assert describe_errors("say", [error]) == sentence


def test_alternative_types_of_one_parameter_are_named_once_in_one_error_line() -> None:
    errors = [
        {"type": kind, "loc": (name,), "input": 7}
        for name, kind in (("a", "string_type"), ("b", "float_type"), ("a", "dict_type"), ("a", "string_type"))
    ]
    assert describe_errors("say", errors) == "a: 7 is not a text or an object\nb: 7 is not a number"


def test_parts_of_a_text_that_are_not_spoken_are_listed_as_warnings() -> None:
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
def test_invalid_tool_argument_is_explained_in_a_sentence_without_a_call_to_the_robot(
    robot: Robot, tool: str, arguments: dict, message: str
) -> None:
    text, is_error = robot.call(tool, **arguments)
    assert is_error
    assert text.startswith(message)
    assert robot.calls == []


def test_several_invalid_tool_arguments_get_a_line_each_and_a_near_name_is_suggested(robot: Robot) -> None:
    text, _ = robot.call("say", style="joyfull")
    assert [line.partition(" ")[0] for line in text.splitlines()] == ["say", "style:"]
    assert text.endswith("did you mean joyful?")
