"""Model Context Protocol server with tools, resources and a prompt."""

import json
from asyncio import to_thread
from collections.abc import Awaitable, Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from secrets import token_hex
from typing import TYPE_CHECKING, Annotated
from xml.sax.saxutils import quoteattr

from mcp.server.mcpserver import Image
from mcp.server.mcpserver.exceptions import ToolError
from mcp.types import ToolAnnotations
from pydantic import AfterValidator

from kinesic.bml.reading.namespaces import BML_1_0
from kinesic.expressivity.lexicon.categories import GESTURE_CATEGORIES
from kinesic.importing import import_at_once
from kinesic.mcp.conversing import add_conversation_tools
from kinesic.mcp.document_line import RobotAnswer
from kinesic.mcp.document_schema import BML_SCHEMA
from kinesic.mcp.errors import RefusedError, RobotError
from kinesic.mcp.parameters import (
    DEFAULT_RESULTS,
    DEFAULT_WAIT,
    BlockName,
    Count,
    Direction,
    Document,
    PreviewedDocument,
    Query,
    Seconds,
    Style,
    Text,
    check_choice,
    choice_schema,
)
from kinesic.mcp.performing import DocumentPerformer, check_document
from kinesic.mcp.preview import PlanPreview, Previewer
from kinesic.mcp.robot_gate import RobotGate
from kinesic.mcp.robot_status import summarise
from kinesic.mcp.teaching import MODEL_INSTRUCTIONS
from kinesic.mcp.tool_server import ToolServer
from kinesic.mcp.vocabulary import all_names, common_gestures, list_gesture_hits
from kinesic.mcp.waiting import wait_for_end
from kinesic.version import __version__

if TYPE_CHECKING:
    from kinesic.expressivity.lexicon.lexicon import Lexicon
    from kinesic.intent.author import AuthoredText
    from kinesic.intent.pacing.memory import ChoiceMemory
    from kinesic.planning.setup import Setup

LONG_TEXT = 1500  # [characters] length, about 100 s, above which a text is streamed phrase by phrase
SPEECH_BLOCK_ID = "said"  # id of the blocks that `write_text` writes, replaced before sending
READ_ONLY_TOOL = ToolAnnotations(read_only_hint=True)  # annotations of tools that move nothing
MOVING_TOOL = ToolAnnotations(read_only_hint=False, destructive_hint=False)  # annotations of tools that move the robot


def make_server(
    gate: RobotGate,
    load_lexicon: Callable[[], "Lexicon"],
    *,
    resumes: bool,
    categories: Sequence[str] = GESTURE_CATEGORIES,
) -> ToolServer:
    """Create the MCP server with its tools, resources and prompt.

    Args:
        gate: access to the server that performs, which may still be starting.
        load_lexicon: returns the gestures to find; called in other threads, because its first call is slow.
        resumes: whether a model may resume after a stop; on servos only a person may.
        categories: categories of these gestures, in alphabetical order.
    """
    server = ToolServer("kinesic", instructions=MODEL_INSTRUCTIONS, version=__version__, log_level="WARNING")
    _add_moving_tools(server, gate, resumes=resumes)
    add_conversation_tools(server, gate)
    _add_quiet_tools(server, gate, load_lexicon, categories)
    _add_resources(server, load_lexicon)
    return server


def warm_up_tools(setup: "Setup") -> "Setup":
    """Import and run slow code of the tools before the first call.

    A slow first call would delay a stop.
    """
    import_at_once("kinesic.mcp.stroke_picture")
    list_gesture_hits(setup.lexicon, "large", "", DEFAULT_RESULTS)
    check_document(lambda: write_speech("Hello.", "", setup).bml)
    return setup


def _add_moving_tools(server: ToolServer, gate: RobotGate, *, resumes: bool) -> None:
    """Add the tools that move or stop the robot."""
    performing, spoken = DocumentPerformer(gate), SpokenTexts()

    @server.tool(annotations=MOVING_TOOL)
    async def perform(document: Document) -> str:
        """Perform a document of speech, gestures, head, face and gaze.

        Answers when the performance begins, with its block (for wait), its duration in seconds, and not_as_asked: each
        deviation from the document. A refused document moves nothing; the error has the path of the wrong value.
        """
        return await _answer_json(performing.perform(partial(_as_text, document)))

    @server.tool(annotations=MOVING_TOOL)
    async def say(text: Text, style: Style = "") -> str:
        """Speak a text with fitting gestures, after everything that plays.

        Use it for plain talk; use perform to decide gestures yourself. Directions such as (laughs) are performed.
        Answers when it begins, as perform does; not_spoken lists what is neither spoken nor performed. A long text is
        streamed phrase by phrase: its answer has about_seconds, and wait without a block waits for its end.
        """
        return await _answer_json(_say(performing, gate, text, style, spoken))

    @server.tool(annotations=MOVING_TOOL)
    async def look(at: Direction) -> str:
        """Turn eyes and head to the audience or a side, and stay."""
        away = "" if at == "AUDIENCE" else f' offsetDirection="{at}" offsetAngle="25"'
        gaze = f'<gazeShift id="gaze" target="AUDIENCE" start="0"{away}/>'
        return await _answer_json(performing.perform(partial(_block, gaze)))

    @server.tool(annotations=ToolAnnotations(read_only_hint=False, idempotent_hint=True))
    async def stop() -> str:
        """Stop all motion and speech at once, and discard everything that waits.

        Use it whenever a person asks for it or something seems wrong. Afterwards nothing moves until resume.
        """
        performing.discard()
        try:
            line = await gate.line()
            await line.stop()
            line.documents.end_talk()
        except RobotError as error:
            raise ToolError(str(error)) from None
        return "stopped" if resumes else "stopped; only a person at the robot can resume"

    if resumes:

        @server.tool(annotations=MOVING_TOOL)
        async def resume() -> str:
            """Continue after stop: the robot returns to rest and accepts documents again."""
            try:
                await (await gate.line()).resume()
            except RobotError as error:
                raise ToolError(str(error)) from None
            return "resumed"


def _add_quiet_tools(
    server: ToolServer, gate: RobotGate, load_lexicon: Callable[[], "Lexicon"], categories: Sequence[str]
) -> None:
    """Add the tools that do not move the robot."""
    previewing = Previewer(gate)
    Category = Annotated[  # noqa: N806 - a type
        str,
        AfterValidator(check_choice(categories)),
        choice_schema(categories, "Kind of gesture. Leave it out for all kinds."),
    ]

    @server.tool(annotations=READ_ONLY_TOOL)
    async def find_gesture(query: Query, category: Category = "", count: Count = DEFAULT_RESULTS) -> str:
        """Find gestures by meaning, the best match first.

        Use the `name` of a result as lexeme of a gesture in a document. Below a score of 0.5, read `says` first.
        """
        hits = await to_thread(lambda: list_gesture_hits(load_lexicon(), query, category, count))
        return json.dumps(hits, ensure_ascii=False)

    @server.tool(annotations=READ_ONLY_TOOL)
    async def preview(document: PreviewedDocument) -> list[str | Image]:
        """Plan a document without moving, and show the robot at its strokes.

        Answers with the duration, the times of all behaviours in seconds, and not_as_asked: each deviation from the
        document. Use it to check timing and poses before perform.
        """
        try:
            drawn = await previewing.preview(partial(_as_text, document))
        except (RefusedError, RobotError) as error:
            raise ToolError(str(error)) from None
        return _preview_content(drawn)

    @server.tool(annotations=READ_ONLY_TOOL)
    async def status() -> str:
        """Report running blocks, waiting ones (`next`), seconds left, and the last warnings.

        `state` is resting, starting (a performance is planned or begins soon), playing, settling (nothing plays; the
        robot is at rest within a second) or stopped (by an emergency stop). `conversation` is the state of a
        conversation that converse has begun.
        """

        async def ask() -> RobotAnswer:
            line = await gate.line()
            accepted = line.documents.accepted_blocks  # before the status, in which one of them may have ended
            conversation = line.documents.conversation
            return summarise(await line.status(), line.documents.warnings, accepted, conversation=conversation)

        return await _answer_json(ask())

    @server.tool(annotations=READ_ONLY_TOOL)
    async def wait(block: BlockName = "", seconds: Seconds = DEFAULT_WAIT) -> str:
        """Wait until a performance has ended, or until nothing plays.

        Answers with ended: true and the outcome (finished, interrupted), or with ended: false when the time is over.
        """
        return await _answer_json(wait_for_end(gate, block, seconds))


def _add_resources(server: ToolServer, load_lexicon: Callable[[], "Lexicon"]) -> None:
    """Add the resources and the prompt of the MCP server."""

    @server.resource("kinesic://usual", description="The 40 most common gestures.", mime_type="text/plain")
    def usual() -> str:
        return common_gestures(load_lexicon())

    @server.resource("kinesic://gestures", description="The names of all gestures.", mime_type="text/plain")
    def gestures() -> str:
        return all_names(load_lexicon())

    @server.resource("kinesic://schema", description="JSON schema of documents.", mime_type="application/schema+json")
    def schema() -> str:
        return json.dumps(BML_SCHEMA)

    @server.prompt(description="Perform a story with speech and gestures.")
    def perform_story(story: str) -> str:
        common = common_gestures(load_lexicon())
        task = "Perform this story, a few sentences a call:"
        return f"{MODEL_INSTRUCTIONS}\nMost common gestures: {common}.\n\n{task}\n\n{story}"


async def _answer_json(answer: Awaitable[RobotAnswer]) -> str:
    """Await and encode the robot's answer, raising refusals as `ToolError`."""
    try:
        return json.dumps(await answer, ensure_ascii=False)
    except (RefusedError, RobotError) as error:
        raise ToolError(str(error)) from None


def _preview_content(drawn: PlanPreview) -> list[str | Image]:
    answer = json.dumps(drawn.answer, ensure_ascii=False)
    return [answer] if drawn.picture is None else [answer, Image(data=drawn.picture, format="png")]


def _as_text(document: str | dict[str, object]) -> str:
    return document if isinstance(document, str) else json.dumps(document, ensure_ascii=False)


@dataclass
class SpokenTexts:
    """Gestures of the texts already spoken, to avoid repetitions."""

    memory: "ChoiceMemory | None" = None  # None: before the first text


async def _say(
    performing: DocumentPerformer, gate: RobotGate, text: str, style: str, spoken: SpokenTexts
) -> RobotAnswer:
    """Speak a text, and list its omitted parts in the answer."""
    if len(text) > LONG_TEXT or (await gate.line()).documents.is_talking:  # a talk continues in order
        answer = await performing.speak(text, style)
        omitted = await to_thread(list_omissions, text)  # only now, as pending calls would delay an emergency stop
        return {**answer, "not_spoken": [*omitted]} if omitted else answer
    unspoken = list[str]()
    before = spoken.memory

    def write() -> str:
        nonlocal before
        before = spoken.memory
        written = write_speech(text, style, gate.setup.result(), before)
        unspoken.extend(written.warnings)
        spoken.memory = written.memory  # within the turn of this call, before the next text is written
        return written.bml

    try:
        answer = await performing.perform(write)
    except (RefusedError, RobotError):
        spoken.memory = before
        raise
    return {**answer, "not_spoken": [*unspoken]} if unspoken else answer


def list_omissions(text: str) -> tuple[str, ...]:
    """Return a warning for each unspoken part of a text."""
    from kinesic.intent.manuscript.reading import read_manuscript  # noqa: PLC0415 - slow to import

    return read_manuscript(text)[1]


def write_speech(text: str, style: str, setup: "Setup", memory: "ChoiceMemory | None" = None) -> "AuthoredText":
    """Write BML that speaks a text with gestures in a style.

    Args:
        text: text to speak.
        style: its name; empty: that of the setup.
        setup: robot, language and seed.
        memory: gestures of earlier texts; None: there are none.
    """
    from kinesic.expressivity.style.style import Style as LoadedStyle  # noqa: PLC0415 - slow to import
    from kinesic.intent.pacing.memory import NO_MEMORY  # noqa: PLC0415 - as above
    from kinesic.session.documents import write_text  # noqa: PLC0415 - as above

    chosen = replace(setup, style=LoadedStyle.load(style)) if style else setup
    written = write_text(text, chosen, memory or NO_MEMORY)
    manner = f" kinesic:style={quoteattr(style)}" if style else ""
    attributes = f'id="{_fresh_id()}" composition="APPEND"{manner}'
    return replace(written, bml=written.bml.replace(f'id="{SPEECH_BLOCK_ID}"', attributes, 1))


def _block(behaviour: str) -> str:
    return f'<bml xmlns="{BML_1_0}" id="{_fresh_id()}">{behaviour}</bml>'


def _fresh_id() -> str:
    """Return a random block id, unique in practice."""
    return f"mcp-{token_hex(6)}"
