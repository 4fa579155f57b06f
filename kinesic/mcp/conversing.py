"""Tools for a conversation of the robot with people."""

import json
from collections.abc import Awaitable

from mcp.server.mcpserver.exceptions import ToolError
from mcp.types import ToolAnnotations

from kinesic.mcp.document_line import NO_CONVERSATION, RobotAnswer
from kinesic.mcp.errors import RefusedError, RobotError
from kinesic.mcp.parameters import Amount, Conversing, Fillers, Thinking
from kinesic.mcp.robot_gate import RobotGate
from kinesic.mcp.tool_server import ToolServer

BEGIN_FIRST = "there is no conversation: call converse first"  # refusal of a tool that needs a conversation
CONVERSATION_TOOL = ToolAnnotations(read_only_hint=False, destructive_hint=False, idempotent_hint=True)


def add_conversation_tools(server: ToolServer, gate: RobotGate) -> None:
    """Add the tools that begin, end and direct a conversation."""

    @server.tool(annotations=CONVERSATION_TOOL)
    async def converse(on: Conversing, amount: Amount = 1.0, fillers: Fillers = False) -> str:
        """Begin or end a conversation: the robot attends to people between performances.

        It looks at people, listens, nods, and stops its own speech if a person takes the turn. A camera or microphone
        program must report people and voices to the robot's server. Answers with the state (off, idle, attending,
        listening, thinking, speaking, interrupted), as status does later. A stop ends the conversation.
        """
        return await _answer_state(_converse(gate, on=on, amount=amount, fillers=fillers))

    @server.tool(annotations=CONVERSATION_TOOL)
    async def think(on: Thinking) -> str:
        """Begin or end a thoughtful look, while an answer is being prepared.

        Call converse first. The look also ends when the robot speaks.
        """
        return await _answer_state(_think(gate, on=on))


async def _converse(gate: RobotGate, *, on: bool, amount: float, fillers: bool) -> RobotAnswer:
    line = await gate.line()
    return {"state": await line.documents.converse(on=on, amount=amount, fillers=fillers)}


async def _think(gate: RobotGate, *, on: bool) -> RobotAnswer:
    documents = (await gate.line()).documents
    if documents.conversation == NO_CONVERSATION:
        raise RefusedError(BEGIN_FIRST)
    await documents.send(lambda: json.dumps({"do": "think", "on": on}))
    return {"thinking": on}


async def _answer_state(answer: Awaitable[RobotAnswer]) -> str:
    """Await and encode an answer, raising refusals as `ToolError`."""
    try:
        return json.dumps(await answer)
    except (RefusedError, RobotError) as error:
        raise ToolError(str(error)) from None
