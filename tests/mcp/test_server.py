"""Tools over the protocol: in-memory clients, valid and invalid calls."""

import asyncio
import json
from collections.abc import Awaitable, Callable, Iterator
from contextlib import closing
from functools import cache
from importlib import import_module
from importlib.util import find_spec
from time import monotonic

import pytest

from kinesic.expressivity.lexicon.lexicon import Lexicon
from kinesic.mcp.document_line import MAX_WAIT
from kinesic.mcp.document_schema import BML_SCHEMA
from kinesic.mcp.robot_gate import RobotGate
from kinesic.mcp.robot_line import RobotLine
from kinesic.mcp.teaching import MODEL_INSTRUCTIONS
from kinesic.planning.setup import Setup
from kinesic.serve.wire.quotas import Quotas
from kinesic.session.setup import set_up

from ..serve.conftest import Running, running
from .fake_server import line

pytestmark = [
    pytest.mark.realtime,
    pytest.mark.skipif(find_spec("mcp") is None, reason="pip install 'kinesic[mcp]'"),
]

STORY = {
    "id": "story1",
    "behaviours": [
        {"type": "speech", "id": "s", "text": ["It is ", {"sync": "m1"}, "large."]},
        {"type": "gesture", "id": "g", "lexeme": "large", "stroke": "s:m1"},
    ],
}
Act = Callable[[object], Awaitable[object]]  # needs an MCP client


@pytest.fixture(scope="module")
def server() -> Iterator[Running]:
    with running(Quotas(rate=1000.0, burst=1000)) as found:
        yield found


@cache
def warm_setup() -> Setup:
    return import_module("kinesic.mcp.server").warm_up_tools(set_up())


def within(server: Running, act: Act, *, resumes: bool = True) -> object:
    """Run an in-memory client with the tools of a server."""

    mcp, made = import_module("mcp"), import_module("kinesic.mcp.server")  # only if these tests run alone

    async def run() -> object:
        with closing(RobotLine("127.0.0.1", server.port)) as robot:
            setup = warm_setup()
            server_of_tools = made.make_server(RobotGate.of(robot, setup), lambda: setup.lexicon, resumes=resumes)
            async with mcp.Client(server_of_tools) as client:
                return await act(client)

    return asyncio.run(run())


def text(result: object) -> str:
    return "".join(each.text for each in result.content)


def test_mcp_client_lists_eleven_tools_and_calls_most_of_them(server: Running):
    async def act(client):
        tools = {tool.name for tool in (await client.list_tools()).tools}
        found = await client.call_tool("find_gesture", {"query": "weigh two things", "count": 3})
        performed = await client.call_tool("perform", {"document": STORY})
        said = await client.call_tool("say", {"text": "No, I did not! *juggles plates*", "style": "joyful"})
        looked = await client.call_tool("look", {"at": "LEFT"})
        status = await client.call_tool("status", {})
        previewed = await client.call_tool("preview", {"document": STORY})
        waited = await client.call_tool("wait", {"block": "story1"})
        return tools, found, performed, said, looked, status, previewed, waited

    tools, found, performed, said, looked, status, previewed, waited = within(server, act)
    quiet = {"find_gesture", "preview", "status", "wait"}
    assert tools == {"perform", "say", "look", "stop", "resume", "converse", "think"} | quiet
    results = json.loads(text(found))
    assert len(results) == 3
    assert [list(each) for each in results] == [["name", "category", "says", "score"]] * 3
    assert results[0]["name"] == "balance"
    assert results[0]["score"] >= results[1]["score"]
    assert json.loads(text(performed))["block"] == "story1"
    assert json.loads(text(performed))["seconds"] > 1.0
    assert not said.is_error, text(said)
    assert json.loads(text(said))["not_spoken"] == ["no gesture or expression shows the direction 'juggles plates'"]
    assert not looked.is_error, text(looked)
    assert json.loads(text(status))["state"] == "playing"
    assert "<" not in text(status)
    answer, picture = previewed.content
    assert [item["id"] for item in json.loads(answer.text)["behaviours"]] == ["s", "g"]
    assert (picture.type, picture.mime_type) == ("image", "image/png")
    assert json.loads(text(waited)) == {"block": "story1", "ended": True, "outcome": "finished"}


def test_conversation_tools_change_the_state_until_a_stop(server: Running):
    async def act(client):
        begun = await client.call_tool("converse", {"on": True})
        thinks = await client.call_tool("think", {"on": True})
        for _ in range(100):  # until a text of another test has ended, and the planner has reported the state
            during = await client.call_tool("status", {})
            if json.loads(text(during)).get("conversation") == "thinking":
                break
            await asyncio.sleep(0.1)
        await client.call_tool("stop", {})
        refused = await client.call_tool("converse", {"on": True})
        await client.call_tool("resume", {})
        await asyncio.sleep(0.1)
        after = await client.call_tool("status", {})
        return [text(answer) for answer in (begun, thinks, during, refused, after)]

    begun, thinks, during, refused, after = within(server, act)
    assert json.loads(begun)["state"] in {"idle", "attending"}
    assert json.loads(thinks) == {"thinking": True}
    assert json.loads(during)["conversation"] == "thinking"
    assert "resume first" in refused
    assert "conversation" not in json.loads(after)


def test_all_tools_and_tool_parameters_have_descriptions(server: Running):
    async def act(client):
        return (await client.list_tools()).tools

    for tool in within(server, act):
        assert len(tool.description) > 40, tool.name
        for name, schema in tool.input_schema["properties"].items():
            assert len(schema["description"]) > 20, f"{tool.name}.{name}"
    parameters = {tool.name: tool.input_schema["properties"] for tool in within(server, act)}
    assert "joyful" in parameters["say"]["style"]["enum"]
    assert "emblem" in parameters["find_gesture"]["category"]["enum"]
    assert "DOWNLEFT" in parameters["look"]["at"]["enum"]
    assert len(json.dumps(parameters)) < 12_000, "each call of a model pays for it"


@pytest.mark.parametrize(
    ("tool", "arguments", "told"),
    [
        ("perform", {"document": '<bml id="x"><gesture id="g" lexeme="beat" stroke="nowhere:end"/></bml>'}, "line 1"),
        ("perform", {"document": '{"do": "resume"}'}, "not a document"),
        ("perform", {"document": '{"do": "stop_line"}'}, "not a document"),
        ("perform", {"document": '<bml id="x"/>\0{"do": "resume"}'}, "NUL"),
        ("perform", {"document": {"behaviours": []}}, '"id"'),
        ("perform", {"document": "[" * 5000}, "line 1"),
        ("perform", {"document": "hello"}, "line 1, column 1"),
        ("perform", {"document": '<bml id="x">\n <gesture id="g"></bml>'}, "line 2, column"),
        ("perform", {"document": '<act><bml id="x"/>\n<bml id="y"/></act>'}, "line 2, column 1: a second <bml>"),
        ("perform", {"document": '<gesture id="g" lexeme="beat"/>'}, "<bml id="),
        ("perform", {"document": "<bml><gesture id='g' lexeme='beat'/></bml>"}, "<bml id="),
        ("perform", {"document": "ü" * 600_000}, "bytes"),
        ("perform", {"document": 7}, "document: 7 is not a text or an object"),
        ("perform", {}, "perform needs the parameter document"),
        ("perform", {"document": {"id": "b", "behaviours": [{"id": "g"}]}}, "behaviours[0]: a behaviour has no type"),
        (
            "perform",
            {"document": {"id": "b", "kinesic:style": "odd", "behaviours": []}},
            '["kinesic:style"]: kinesic:style',
        ),
        ("say", {"text": "hi", "style": "../../etc/passwd"}, "is not one of angry, calm, joyful"),
        ("say", {"text": "hi", "style": "joyfull"}, "did you mean joyful?"),
        ("say", {"text": "x" * 300_000}, "text has 300000 characters, at most 200000"),
        ("look", {"at": "LEF"}, "did you mean LEFT?"),
        ("find_gesture", {"query": "x" * 300}, "query has 300 characters, at most 200"),
        ("find_gesture", {"query": "x", "category": "emblems"}, "did you mean emblem?"),
        ("find_gesture", {"query": "x", "count": 0}, "count: 0 is out of range"),
        ("wait", {"block": "never"}, "no block 'never' was performed here"),
        ("wait", {"seconds": "long"}, 'seconds: "long" is not a number'),
        (
            "preview",
            {"document": {"id": "b", "behaviours": [{"type": "head", "id": "h", "amount": "x"}]}},
            "[0].amount:",
        ),
        ("arm_servos", {}, ""),
    ],
)
def test_invalid_tool_calls_are_answered_with_a_specific_error(server: Running, tool: str, arguments: dict, told: str):
    async def act(client):
        return await client.call_tool(tool, arguments)

    try:
        result = within(server, act)
        answer = text(result) if result.is_error else "nothing is wrong"
    except import_module("mcp").MCPError as error:  # answer of the protocol to an unknown tool
        answer = str(error)
    assert answer != "nothing is wrong"
    assert told in answer
    assert "http" not in answer
    assert "Error executing" not in answer


@pytest.mark.parametrize(
    ("document", "block"),
    [
        ('<!-- <bml id="old"> --><bml id="commented"><head id="h" lexeme="NOD"/></bml>', "commented"),
        ("<bml id='a&amp;b'><head id='h' lexeme='NOD'/></bml>", "a&b"),
        ('<?xml version="1.0"?><act><bml id="inner"><head id="h" lexeme="NOD"/></bml></act>', "inner"),
        (
            '<b:bml xmlns:b="http://www.bml-initiative.org/bml/bml-1.0" id="p"><b:head id="h" lexeme="NOD"/></b:bml>',
            "p",
        ),
        ('<BML ID="capitals" id="small"><head id="h" lexeme="NOD"/></BML>', "small"),
        ('<bml xml:id="not" id="this"><head id="h" lexeme="NOD"/></bml>', "this"),
    ],
)
def test_perform_tool_accepts_a_block_under_the_id_found_by_the_parser(server: Running, document: str, block: str):
    async def act(client):
        return await client.call_tool("perform", {"document": document})

    begun = monotonic()
    result = within(server, act)
    assert not result.is_error, text(result)
    assert json.loads(text(result))["block"] == block
    assert monotonic() - begun < MAX_WAIT


def test_four_simultaneous_documents_and_four_status_calls_are_accepted(server: Running):
    async def act(client):
        nods = [{"id": f"at_once{k}", "behaviours": [{"type": "head", "id": "h", "lexeme": "NOD"}]} for k in range(4)]
        calls = [client.call_tool("perform", {"document": nod}) for nod in nods]
        return await asyncio.gather(*calls, *(client.call_tool("status", {}) for _ in range(4)))

    results = within(server, act)
    assert not [text(each) for each in results if each.is_error]


def test_long_text_is_streamed_until_an_emergency_stop(server: Running):
    async def act(client):
        story = "See https://a.eu/b " + "We saw the old house. " * 80
        said = await client.call_tool("say", {"text": story, "style": "sad"})
        short = await client.call_tool("say", {"text": "And so on."})
        held = await client.call_tool("wait", {"seconds": 0.1})
        await client.call_tool("stop", {})
        await client.call_tool("resume", {})
        return said, short, held, await client.call_tool("wait", {"seconds": 20})

    said, short, held, ended = (json.loads(text(each)) for each in within(server, act))
    assert said["block"].startswith("said")
    assert said["about_seconds"] > 100
    assert len(said["not_spoken"]) == 1
    assert "about_seconds" in short
    assert not held["ended"]
    assert ended["ended"]


def test_long_texts_pending_at_an_emergency_stop_are_refused_unread(monkeypatch: pytest.MonkeyPatch):
    tools, read = import_module("kinesic.mcp.server"), list[str]()
    monkeypatch.setattr(tools, "list_omissions", read.append)

    async def run(robot: RobotLine) -> list[object]:
        setup = warm_setup()
        gate = RobotGate.of(robot, setup)
        server = tools.make_server(gate, lambda: setup.lexicon, resumes=True)
        async with import_module("mcp").Client(server) as client:
            calls = [asyncio.create_task(client.call_tool("say", {"text": "and so on. " * 300})) for _ in range(3)]
            await client.list_tools()
            await client.call_tool("stop", {})
            return await asyncio.gather(*calls)

    with line(lambda _message, _say: None) as (robot, _server):
        answers = asyncio.run(run(robot))
    assert all("an emergency stop discarded this call" in text(answer) for answer in answers)
    assert not read


def test_stop_is_answered_within_a_second_and_only_a_person_can_resume_servos(server: Running):
    async def act(client):
        slow = [asyncio.create_task(client.call_tool("say", {"text": "and so on. " * 300}))]
        await asyncio.sleep(0.5)  # planning takes seconds
        slow.append(asyncio.create_task(client.call_tool("say", {"text": "and so on."})))  # waits for the planning
        begun = monotonic()
        stopped = await client.call_tool("stop", {})
        took = monotonic() - begun
        await asyncio.gather(*slow, return_exceptions=True)
        state = json.loads(text(await client.call_tool("status", {})))["state"]
        tools = {tool.name for tool in (await client.list_tools()).tools}
        return stopped, took, state, tools

    stopped, took, state, tools = within(server, act, resumes=False)
    assert "only a person" in text(stopped)
    assert took < 1.0
    assert state == "stopped"
    assert "resume" not in tools
    within(server, lambda client: client.call_tool("resume", {}))


def test_model_instructions_are_short_and_their_example_is_performed(server: Running):
    lexicon = Lexicon.load()

    async def act(client):
        usual, names, schema = [
            (await client.read_resource(f"kinesic://{name}")).contents[0].text
            for name in ("usual", "gestures", "schema")
        ]
        prompt = (await client.get_prompt("perform_story", {"story": "Once."})).messages[0].content.text
        example = json.loads(MODEL_INSTRUCTIONS[MODEL_INSTRUCTIONS.index("{") : MODEL_INSTRUCTIONS.index("]}\n") + 2])
        return usual, names, schema, prompt, await client.call_tool("perform", {"document": example})

    usual, names, schema, prompt, performed = within(server, act)
    assert len(usual.split(", ")) == 40
    assert len(usual) <= 1000
    assert set(usual.split(", ")) <= lexicon.forms_by_id.keys()
    assert len(names) <= 4000
    assert set(names.split()) == lexicon.forms_by_id.keys()
    assert len(MODEL_INSTRUCTIONS) / 4 <= 600, "tokens, about"
    assert prompt.endswith("Once.")
    assert json.loads(schema) == json.loads(json.dumps(BML_SCHEMA))
    assert json.loads(text(performed))["not_as_asked"] == [], text(performed)
