"""The tools over the protocol: a client in memory and one over standard input perform, ask, stop and misbehave."""

import asyncio
import json
import sys
import threading
from collections.abc import Awaitable, Callable, Iterator
from contextlib import closing
from importlib import import_module
from importlib.util import find_spec
from time import monotonic

import pytest

from kinesic.controller.perform import set_up
from kinesic.expressivity.lexicon.lexicon import Lexicon
from kinesic.mcp.document_line import MAX_WAIT
from kinesic.mcp.robot_line import RobotLine
from kinesic.mcp.teaching import BML_SCHEMA, TEACHING
from kinesic.serve.wire.quotas import Quotas

from ..serve.conftest import Running, running

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
Act = Callable[[object], Awaitable[object]]  # with a client of the protocol


@pytest.fixture(scope="module")
def server() -> Iterator[Running]:
    with running(Quotas(rate=1000.0, burst=1000)) as found:
        yield found


def within(server: Running, act: Act, *, resumes: bool = True) -> object:
    """Lets a client in memory act before the tools of a server."""

    mcp, made = import_module("mcp"), import_module("kinesic.mcp.server")  # by whoever runs these tests alone

    async def run() -> object:
        with closing(RobotLine("127.0.0.1", server.port)) as robot:
            async with mcp.Client(made.make_server(robot, set_up(), resumes=resumes)) as client:
                return await act(client)

    return asyncio.run(run())


def text(result: object) -> str:
    return "".join(each.text for each in result.content)


def test_a_model_finds_gestures_performs_says_looks_and_asks(server: Running):
    async def act(client):
        tools = {tool.name for tool in (await client.list_tools()).tools}
        found = await client.call_tool("list_gestures", {"query": "weigh against"})
        performed = await client.call_tool("perform", {"document": STORY})
        said = await client.call_tool("say", {"text": "No, I did not!", "style": "joyful"})
        looked = await client.call_tool("look", {"at": "LEFT"})
        status = await client.call_tool("status", {})
        return tools, found, performed, said, looked, status

    tools, found, performed, said, looked, status = within(server, act)
    assert tools == {"list_gestures", "perform", "say", "look", "status", "stop", "resume"}
    assert "balance" in text(found)
    assert json.loads(text(performed))["block"] == "story1"
    assert json.loads(text(performed))["seconds"] > 1.0
    assert not said.is_error, text(said)
    assert not looked.is_error, text(looked)
    assert json.loads(text(status))["state"] == "playing"


@pytest.mark.parametrize(
    ("tool", "arguments", "told"),
    [
        ("perform", {"document": '<bml id="x"><gesture id="g" lexeme="beat" stroke="nowhere:end"/></bml>'}, "line 1"),
        ("perform", {"document": '{"do": "resume"}'}, "no document"),
        ("perform", {"document": '{"do": "stop_line"}'}, "no document"),
        ("perform", {"document": '<bml id="x"/>\0{"do": "resume"}'}, "NUL"),
        ("perform", {"document": {"behaviours": []}}, '"id"'),
        ("perform", {"document": "[" * 5000}, "line 1"),
        ("perform", {"document": "hello"}, "line 1, column 1"),
        ("perform", {"document": '<bml id="x">\n <gesture id="g"></bml>'}, "line 2, column"),
        ("perform", {"document": '<act><bml id="x"/>\n<bml id="y"/></act>'}, "line 2, column 1: a second <bml>"),
        ("perform", {"document": '<gesture id="g" lexeme="beat"/>'}, "<bml id="),
        ("perform", {"document": "<bml><gesture id='g' lexeme='beat'/></bml>"}, "<bml id="),
        ("perform", {"document": "ü" * 600_000}, "bytes"),
        ("perform", {"document": 7}, ""),
        ("perform", {}, ""),
        ("say", {"text": "hi", "style": "../../etc/passwd"}, "no style"),
        ("say", {"text": "x" * 30_000}, ""),
        ("look", {"at": "behind"}, ""),
        ("list_gestures", {"query": "x" * 300}, ""),
        ("arm_servos", {}, ""),
    ],
)
def test_what_is_wrong_is_answered_and_moves_nothing(server: Running, tool: str, arguments: dict, told: str):
    async def act(client):
        return await client.call_tool(tool, arguments)

    try:
        result = within(server, act)
        answer = text(result) if result.is_error else "nothing is wrong"
    except import_module("mcp").MCPError as error:  # the protocol's own answer to a call that it does not know
        answer = str(error)
    assert answer != "nothing is wrong"
    assert told in answer


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
def test_block_is_awaited_under_the_id_that_the_parser_reads(server: Running, document: str, block: str):
    async def act(client):
        return await client.call_tool("perform", {"document": document})

    begun = monotonic()
    result = within(server, act)
    assert not result.is_error, text(result)
    assert json.loads(text(result))["block"] == block
    assert monotonic() - begun < MAX_WAIT


def test_documents_that_come_at_once_are_all_performed(server: Running):
    async def act(client):
        nods = [{"id": f"at_once{k}", "behaviours": [{"type": "head", "id": "h", "lexeme": "NOD"}]} for k in range(4)]
        calls = [client.call_tool("perform", {"document": nod}) for nod in nods]
        return await asyncio.gather(*calls, *(client.call_tool("status", {}) for _ in range(4)))

    results = within(server, act)
    assert not [text(each) for each in results if each.is_error]


def test_a_stop_waits_for_nothing_and_only_a_person_goes_on_with_servos(server: Running):
    async def act(client):
        slow = [asyncio.create_task(client.call_tool("say", {"text": "and so on. " * 300}))]
        await asyncio.sleep(0.5)  # until it is planned, which takes seconds
        slow.append(asyncio.create_task(client.call_tool("say", {"text": "and so on."})))  # which waits for that
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


def test_what_a_model_reads_is_small_and_its_example_is_performed(server: Running):
    lexicon = Lexicon.load()

    async def act(client):
        usual, names, schema = [
            (await client.read_resource(f"kinesic://{name}")).contents[0].text
            for name in ("usual", "gestures", "schema")
        ]
        prompt = (await client.get_prompt("perform_story", {"story": "Once."})).messages[0].content.text
        example = json.loads(TEACHING[TEACHING.index("{") : TEACHING.index("]}\n") + 2])
        return usual, names, schema, prompt, await client.call_tool("perform", {"document": example})

    usual, names, schema, prompt, performed = within(server, act)
    assert len(usual.split(", ")) == 40
    assert len(usual) <= 1000
    assert set(usual.split(", ")) <= lexicon.forms_by_id.keys()
    assert len(names) <= 4000
    assert set(names.split()) == lexicon.forms_by_id.keys()
    assert len(TEACHING) / 4 <= 600, "tokens, about"
    assert prompt.endswith("Once.")
    assert json.loads(schema) == json.loads(json.dumps(BML_SCHEMA))
    assert json.loads(text(performed))["not_as_asked"] == [], text(performed)


def test_a_client_over_standard_input_performs_and_its_end_ends_the_server(tmp_path):
    mcp = import_module("mcp")

    async def run():
        begun = mcp.StdioServerParameters(
            command=sys.executable, args=["-m", "kinesic", "mcp", "--voice", "durations"], cwd=tmp_path
        )
        async with mcp.Client(begun) as client:
            performed = await client.call_tool("perform", {"document": STORY})
            stopped = await client.call_tool("stop", {})
            resumed = await client.call_tool("resume", {})
            return [text(each) for each in (performed, stopped, resumed)]

    performed, stopped, resumed = asyncio.run(run())
    assert json.loads(performed)["block"] == "story1"
    assert (stopped, resumed) == ("stopped", "resumed")
    assert threading.active_count() < 50
