"""MCP server whose argument errors name parameter, value and valid values."""

import json
from collections.abc import Iterable, Mapping

from mcp.server import MCPServer
from mcp.server.mcpserver import Context
from mcp.server.mcpserver.exceptions import ToolError
from mcp.types import CallToolResult, InputRequiredResult
from pydantic import ValidationError
from pydantic_core import ErrorDetails

from kinesic.body.config import suggestion

MAX_SHOWN_VALUE = 60  # [characters] longest part of an invalid value shown in an error


class ToolServer(MCPServer[None]):
    """MCP server that explains invalid arguments in sentences."""

    async def call_tool(
        self, name: str, arguments: Mapping[str, object], context: Context[None, object] | None = None
    ) -> CallToolResult | InputRequiredResult:
        """Call a tool, and explain invalid arguments in the error.

        Raises:
            ToolError: the tool is unknown, an argument is invalid, or the tool refuses the call.
        """
        try:
            return await super().call_tool(name, dict(arguments), context)
        except ToolError as error:
            if isinstance(error.__cause__, ValidationError):
                raise ToolError(describe_errors(name, error.__cause__.errors(include_url=False))) from None
            raise ToolError(str(error).removeprefix(f"Error executing tool {name}: ")) from None


def describe_errors(tool: str, errors: Iterable[ErrorDetails]) -> str:
    """Return one sentence for each invalid parameter of a call."""
    by_parameter: dict[str, list[ErrorDetails]] = {}
    for error in errors:
        by_parameter.setdefault(str(error["loc"][0]) if error["loc"] else "arguments", []).append(error)
    return "\n".join(_describe(tool, name, found) for name, found in by_parameter.items())


def _describe(tool: str, parameter: str, errors: list[ErrorDetails]) -> str:
    error = errors[0]
    value, limits = _shown(error["input"]), error.get("ctx", {})
    match error["type"]:
        case "missing":
            return f"{tool} needs the parameter {parameter}; nothing was done"
        case "string_too_long":
            length, limit = len(error["input"]), limits["max_length"]
            return f"{parameter} has {length} characters, at most {limit} are accepted: shorten or divide it"
        case "literal_error" | "value_error":
            choices = str(limits.get("expected", limits.get("error", ""))).replace("'", "").replace(" or ", ", ")
            near = suggestion(str(error["input"]), choices.split(", "))
            return f"{parameter}: {value} is not one of {choices}{near if 'did you mean' in near else ''}"
        case "greater_than_equal" | "less_than_equal":
            return f"{parameter}: {value} is out of range; {error['msg'].lower()}"
    kinds = " or ".join(dict.fromkeys(_kind(error["type"]) for error in errors))
    return f"{parameter}: {value} is not {kinds}"


def _kind(type_: str) -> str:
    """Return the kind of value that a pydantic error type expects."""
    name = type_.partition("_")[0]
    return {"string": "a text", "dict": "an object", "float": "a number", "int": "a whole number"}.get(
        name, f"a {name}"
    )


def _shown(value: object) -> str:
    text = json.dumps(value, ensure_ascii=False, default=str)
    return text if len(text) <= MAX_SHOWN_VALUE else f"{text[:MAX_SHOWN_VALUE]}..."
