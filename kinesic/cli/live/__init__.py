"""Declarations of the server verbs: `kinesic serve`, `studio` and `mcp`."""

from dataclasses import fields
from pathlib import Path

import click

from kinesic.cli.help_pages import VerbCommand
from kinesic.cli.live.access_options import access_options
from kinesic.cli.live.token import token_option
from kinesic.cli.options import implemented_by, performer_options, planning_options, servo_options
from kinesic.host import LIVE_SERVER
from kinesic.serve.wire.quotas import DEFAULT_QUOTAS, Quotas

DEFAULT_QUOTA_LIST = ", ".join(f"{field.name}={getattr(DEFAULT_QUOTAS, field.name):g}" for field in fields(Quotas))
RULE_HELP = f"Limit for clients. Defaults: {DEFAULT_QUOTA_LIST}."
HEAR_HELP = "Attend to people heard by a microphone (`default`, or a part of its name) or in a pipe (16 kHz, 16 bits)."
CONNECT_HELP = "Show the page of a robot that a running `kinesic serve` drives; the token is that server's."
FOLDER_HELP = "Folder in which documents are opened and saved (default: that of FILE, or this one)."


@click.command("serve", cls=VerbCommand)
@planning_options
@access_options
@performer_options("Sinks that perform, separated by commas.")
@servo_options
@click.option("--sound/--no-sound", default=None, help="Play the speech (default: if audio works).")
@click.option("--rule", "rules", multiple=True, metavar="NAME=VALUE", help=RULE_HELP)
@click.option("--end-with-input", is_flag=True, help="End when standard input ends, even if clients may connect.")
@click.option("--hear", metavar="MICROPHONE|PIPE", help=HEAR_HELP)
@implemented_by("live.serve:serve_blocks", needs=LIVE_SERVER)
def serve_verb() -> None:
    """Perform BML blocks as they arrive, and answer with BML feedback.

    Messages arrive by TCP (each ends with a NUL byte), by WebSocket at the same address (one block per message), and on
    standard input unless that is a terminal.
    """


@click.command("studio", cls=VerbCommand)
@click.argument("file", required=False, type=click.Path(path_type=Path))
@planning_options
@access_options
@performer_options("Sinks that perform, separated by commas.")
@click.option("--folder", type=click.Path(path_type=Path, file_okay=False), help=FOLDER_HELP)
@click.option("--sound/--no-sound", default=None, help="Play the speech (default: if audio works).")
@click.option("--browser/--no-browser", default=True, help="Open the page in the browser, if there is a display.")
@click.option("--rule", "rules", multiple=True, metavar="NAME=VALUE", help=RULE_HELP)
@click.option("--connect", metavar="HOST[:PORT]", help=CONNECT_HELP)
@implemented_by("live.studio:open_studio", needs=LIVE_SERVER)
def studio_verb() -> None:
    """Open the studio, a web page to write and perform FILE (BML).

    The studio is `kinesic serve` with a web page at the same address: programs may connect at the same time.
    """


@click.command("mcp", cls=VerbCommand)
@planning_options
@performer_options("Sinks that perform, separated by commas; servos only if named here.")
@click.option("--connect", metavar="HOST:PORT", help="Running server to use, instead of starting one.")
@token_option("Token of the server, also required from --http clients. Prefer --token-file or KINESIC_TOKEN.")
@click.option("--http", metavar="HOST:PORT", help="Serve clients by HTTP at this address, not by standard input.")
@implemented_by("live.mcp:serve_tools", needs=LIVE_SERVER)
def mcp_verb() -> None:
    """Serve MCP tools to a language model, so that it performs.

    There are tools for gestures, documents, text, gaze, status and stop. It needs the extra mcp.

    An MCP client starts this command and exchanges messages with it over standard input and output: kinesic mcp --robot
    upper36.
    """
