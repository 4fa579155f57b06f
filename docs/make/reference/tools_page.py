"""The page of the tools that `kinesic mcp` offers to language models."""

import asyncio
import json
from collections.abc import Mapping, Sequence
from concurrent.futures import Future

from mcp.types import Tool

from kinesic.expressivity.lexicon.lexicon import Lexicon
from kinesic.mcp.robot_gate import RobotGate
from kinesic.mcp.robot_line import RobotLine
from kinesic.mcp.server import make_server
from kinesic.planning.setup import Setup

HEAD = """# MCP tools

`kinesic mcp` gives these tools to a language model. Their descriptions are the texts that the model reads.
[Connect a language model](../how-to/connect-a-language-model.md) shows how to use them.

An error is an answer with `isError`. Its text names the parameter or the place in the document, such as
`behaviours[1].stroke`, and a valid value.
"""

TAIL = """
The list of common gestures has less than 1 kB, and the list of all names has less than 4 kB.

## Answers

- The document of `perform` needs a new id: an id that already plays or waits is refused. A refusal names the wrong
  value by its path in JSON (`behaviours[1].stroke`), or by line and column in XML.
- `preview` also works while the robot is stopped. It shows 8 strokes at most, and no picture if the server of
  `--connect` performs with a robot other than `--robot`.
- The tools answer while the robot's server is still starting; a call that moves the robot waits for it. If the
  server does not start, each call reports the reason, and the command exits with code 2.
- Each tool call waits at most 15 s for an answer from the robot's server. Only `wait` may take longer.

## Pending calls and stops

`perform`, `say` and `look` are executed one after the other, in the order of their arrival. At most 64 calls are
pending. One more call is refused at once, and the refusal gives the number of pending calls and the remedy. A pending
call is removed if its client cancels it or disconnects.

`stop`, `status` and `preview` have their own connections and threads. A stop discards all pending calls: none of them
moves the robot afterwards, and each is answered with a refusal. A stop from another source, such as a person
at the studio, has the same effect. A plan made before the stop is not performed, even after `resume`.

## HTTP sessions

With `--http`, the server keeps 16 sessions. A new session replaces the session that has been idle longest, but never a
session with a pending call. The client of the replaced session receives 404 and opens a new one, as the protocol
requires.
"""

RESUME_NOTE = "Only in the twin: on servos, and with `--connect`, a person has to resume."
PLAIN_KINDS = {
    "boolean": "`true` or `false`",
    "string": "text",
    "number": "number",
    "integer": "whole number",
    "object": "JSON object",
}
SCHEMA_LINK = "[document as JSON](bml.md#bml-as-json)"


def write_page() -> str:
    """Return the page with all tools and resources."""
    server = make_server(RobotGate(Future[RobotLine](), Future[Setup]()), Lexicon.load, resumes=True)
    tools, resources = asyncio.run(server.list_tools()), asyncio.run(server.list_resources())
    prompts = asyncio.run(server.list_prompts())
    lines = [HEAD, "| tool | effect |", "|---|---|"]
    lines += [f"| [`{tool.name}`](#{tool.name}) | {_paragraphs(tool)[0]} |" for tool in tools]
    for tool in tools:
        lines += ["", *_section(tool)]
    lines += ["", "## Resources and prompts", "", "| name | content |", "|---|---|"]
    lines += [f"| `{resource.uri}` | {resource.description} |" for resource in resources]
    lines += [f"| prompt `{prompt.name}` | {prompt.description} |" for prompt in prompts]
    return "\n".join(lines) + "\n" + TAIL


def _section(tool: Tool) -> list[str]:
    is_quiet = tool.annotations is not None and tool.annotations.read_only_hint
    lines = [f"## {tool.name}", "", "*Moves nothing.*" if is_quiet else "*Changes what the robot does.*", ""]
    for paragraph in [*_paragraphs(tool), *([RESUME_NOTE] if tool.name == "resume" else [])]:
        lines += [paragraph, ""]
    properties, required = tool.input_schema.get("properties", {}), tool.input_schema.get("required", [])
    if not properties:
        return [*lines, "It has no parameters."]
    lines += ["| parameter | value | default | meaning |", "|---|---|---|---|"]
    for name, schema in properties.items():
        default = "required" if name in required else _code(schema.get("default", ""))
        lines.append(f"| `{name}` | {_kind(schema)} | {default} | {_escape(schema.get('description', ''))} |")
    return lines


def _paragraphs(tool: Tool) -> list[str]:
    return [" ".join(part.split()) for part in (tool.description or "").split("\n\n")]


def _code(value: object) -> str:
    """Return a default value as Markdown code.

    Text is unchanged, other values are in JSON notation. An empty text has no code.
    """
    return f"`{value if isinstance(value, str) else json.dumps(value)}`".replace("``", "")


def _escape(text: str) -> str:
    return text.replace("*", "\\*").replace("|", "\\|")


def _kind(schema: Mapping[str, object]) -> str:
    """Describe a parameter's type in words."""
    choices, kind, limits = schema.get("enum"), schema.get("type"), ""
    if isinstance(choices, Sequence):
        return ", ".join(f"`{choice}`" for choice in choices)
    if "anyOf" in schema or not isinstance(kind, str):
        return f"{SCHEMA_LINK}, or text"
    if "maxLength" in schema:
        limits = f", at most {schema['maxLength']} characters"
    elif "minimum" in schema:
        limits = f" in [{schema['minimum']}, {schema['maximum']}]"
    return PLAIN_KINDS[kind] + limits
