"""The tools, resources and prompt that a language model gets over the Model Context Protocol."""

import json
from collections.abc import Awaitable
from dataclasses import asdict, replace
from functools import partial
from secrets import token_hex
from typing import Annotated, Literal
from xml.sax.saxutils import quoteattr

from mcp.server import MCPServer
from mcp.server.mcpserver.exceptions import ToolError
from mcp.types import ToolAnnotations
from pydantic import Field

from kinesic.bml.reading.namespaces import BML_1_0
from kinesic.body.config import names_of
from kinesic.controller.documents import write_bml
from kinesic.expressivity.style.style import Style
from kinesic.mcp.document_line import RobotAnswer
from kinesic.mcp.errors import RefusedError, RobotError
from kinesic.mcp.performing import Performing
from kinesic.mcp.robot_line import RobotLine
from kinesic.mcp.teaching import BML_SCHEMA, TEACHING
from kinesic.mcp.vocabulary import all_names, search_gestures, usual_gestures
from kinesic.planning.setup import Setup
from kinesic.version import __version__

SAID = "said"  # id of the block that `write_bml` writes
MOST_TEXT = 20_000  # letters of what is said in one call
READS = ToolAnnotations(read_only_hint=True)
MOVES = ToolAnnotations(read_only_hint=False, destructive_hint=False)

Text = Annotated[str, Field(max_length=MOST_TEXT)]
Query = Annotated[str, Field(max_length=200)]
Name = Annotated[str, Field(max_length=64)]
Document = Annotated[str, Field(max_length=900_000)]
Direction = Literal["AUDIENCE", "LEFT", "RIGHT", "UP", "DOWN", "UPLEFT", "UPRIGHT", "DOWNLEFT", "DOWNRIGHT"]


def make_server(robot: RobotLine, known: Setup, *, resumes: bool) -> MCPServer:
    """Makes the server of tools.

    Args:
        robot: the connection to whoever performs.
        known: the lexicon, the language and the style in which text is performed.
        resumes: whether a model may go on after a stop; on servos only a person may.
    """
    server = MCPServer("kinesic", instructions=TEACHING, version=__version__, log_level="WARNING")
    performing = Performing(robot)
    search_gestures(known.lexicon, "")  # the first search and the first text take long, and would hold up a stop
    _spoken("Hello.", "", known)

    @server.tool(annotations=READS)
    async def list_gestures(query: Query = "", category: Name = "") -> str:
        """Finds gestures by words of their name or meaning; without a query the first 25."""
        return json.dumps([asdict(found) for found in search_gestures(known.lexicon, query, category)])

    @server.tool(annotations=MOVES)
    async def perform(document: Document | dict[str, object]) -> str:
        """Perform BML, as JSON (kinesic://schema) or XML, after pending calls."""
        return await _answered(performing.perform(partial(_as_text, document)))

    @server.tool(annotations=MOVES)
    async def say(text: Text, style: Name = "") -> str:
        """Says a text with gestures that fit its words, after what is performed now; *stress* stresses a word."""
        return await _answered(performing.perform(partial(_spoken, text, style, known)))

    @server.tool(annotations=MOVES)
    async def look(at: Direction) -> str:
        """Turns the gaze to the audience, or away from it in a direction, until it is turned again."""
        away = "" if at == "AUDIENCE" else f' offsetDirection="{at}" offsetAngle="25"'
        gaze = f'<gazeShift id="gaze" target="AUDIENCE" start="0"{away}/>'
        return await _answered(performing.perform(partial(_block, gaze)))

    @server.tool(annotations=READS)
    async def status() -> str:
        """Says whether the robot rests, plays or is stopped, and the last feedback."""
        return await _answered(robot.status())

    @server.tool(annotations=ToolAnnotations(read_only_hint=False, idempotent_hint=True))
    async def stop() -> str:
        """Stops every motion at once. Use it whenever somebody asks for it, or something seems wrong."""
        performing.discard()
        try:
            await robot.stop()
        except RobotError as error:
            raise ToolError(str(error)) from None
        return "stopped" if resumes else "stopped; only a person at the robot can go on"

    if resumes:

        @server.tool(annotations=MOVES)
        async def resume() -> str:
            """Goes on after a stop: the robot returns to rest, and documents are taken again."""
            try:
                await robot.resume()
            except RobotError as error:
                raise ToolError(str(error)) from None
            return "resumed"

    @server.resource("kinesic://usual", description="the 40 gestures that are used most", mime_type="text/plain")
    def usual() -> str:
        return usual_gestures(known.lexicon)

    @server.resource("kinesic://gestures", description="the names of all gestures", mime_type="text/plain")
    def gestures() -> str:
        return all_names(known.lexicon)

    @server.resource("kinesic://schema", description="BML as JSON", mime_type="application/schema+json")
    def schema() -> str:
        return json.dumps(BML_SCHEMA)

    @server.prompt(description="Performs a story with speech and gestures.")
    def perform_story(story: str) -> str:
        common = usual_gestures(known.lexicon)
        task = "Perform this story, a few sentences a call:"
        return f"{TEACHING}\nGestures that are used most: {common}.\n\n{task}\n\n{story}"

    return server


async def _answered(answer: Awaitable[RobotAnswer]) -> str:
    """Write the robot's answer as JSON."""
    try:
        return json.dumps(await answer)
    except (RefusedError, RobotError) as error:
        raise ToolError(str(error)) from None


def _as_text(document: str | dict[str, object]) -> str:
    return document if isinstance(document, str) else json.dumps(document, ensure_ascii=False)


def _spoken(text: str, style: str, known: Setup) -> str:
    """Writes a block that says a text.

    Raises:
        RefusedError: there is no such style.
    """
    if style and style not in names_of("style"):  # never a path: a model reads no files
        raise RefusedError(f"no style {style!r}; there are {', '.join(names_of('style'))}")
    chosen = replace(known, style=Style.load(style)) if style else known
    written = write_bml(text, chosen)
    manner = f" kinesic:style={quoteattr(style)}" if style else ""
    return written.replace(f'id="{SAID}"', f'id="{_fresh_id()}" composition="APPEND"{manner}', 1)


def _block(behaviour: str) -> str:
    return f'<bml xmlns="{BML_1_0}" id="{_fresh_id()}">{behaviour}</bml>'


def _fresh_id() -> str:
    """An id that no client has used before."""
    return f"mcp-{token_hex(6)}"
