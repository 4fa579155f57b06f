"""The verbs of the live server: `kinesic serve`, and `kinesic studio` with its page."""

from dataclasses import fields
from pathlib import Path

import click

from kinesic.cli.live.door import door
from kinesic.cli.live.token import token_option
from kinesic.cli.options import done_by, performers, planning, servo_options
from kinesic.serve.wire.quotas import USUAL, Quotas

RULE_HELP = (
    f"A limit for clients: {', '.join(f'{each.name}={getattr(USUAL, each.name):g}' for each in fields(Quotas))}."
)
CONNECT_HELP = "The page of a robot that `kinesic serve` drives already, there or here; the token is that server's."
FOLDER_HELP = "Where documents are opened and saved (default: that of FILE, or this one)."


@click.command("serve")
@planning
@door
@performers("Who performs.")
@servo_options
@click.option("--sound/--no-sound", default=None, help="Speech is heard (default: where that works).")
@click.option("--rule", "rules", multiple=True, metavar="NAME=VALUE", help=RULE_HELP)
@click.option("--end-with-input", is_flag=True, help="End when standard input ends, also where others may connect.")
@done_by("live.serve:serve_blocks")
def serve_verb() -> None:
    """Performs blocks of BML as they come, and answers with BML feedback.

    Messages come by TCP (each ends with a NUL byte), by WebSocket at the same address (one message is one block), and
    on standard input, unless that is a terminal.
    """


@click.command("studio")
@click.argument("file", required=False, type=click.Path(path_type=Path))
@planning
@door
@performers("Who performs.")
@click.option("--folder", type=click.Path(path_type=Path, file_okay=False), help=FOLDER_HELP)
@click.option("--sound/--no-sound", default=None, help="Speech is heard (default: where that works).")
@click.option("--browser/--no-browser", default=True, help="Opens the page in the browser, where there is a display.")
@click.option("--rule", "rules", multiple=True, metavar="NAME=VALUE", help=RULE_HELP)
@click.option("--connect", metavar="HOST[:PORT]", help=CONNECT_HELP)
@done_by("live.studio:open_studio")
def studio_verb() -> None:
    """Opens the studio: a page on which FILE (BML) is written, seen and performed.

    It is `kinesic serve` with a page at the same address: programs may connect meanwhile.
    """


@click.command("mcp")
@planning
@performers("Who performs; servos only if they are named here.")
@click.option("--connect", metavar="HOST:PORT", help="A server that performs already, instead of one of its own.")
@token_option("That the server asks for, and clients by --http must show. Better --token-file or KINESIC_TOKEN.")
@click.option("--http", metavar="HOST:PORT", help="Serves clients by HTTP at this address, not by standard input.")
@done_by("live.mcp:serve_tools")
def mcp_verb() -> None:
    """Serves a language model the tools to perform: gestures, documents, text, gaze, status and stop.

    It needs the extra mcp: pip install 'kinesic[mcp]'.

    A client starts it by itself and talks to it over standard input and output: kinesic mcp --robot upper36.
    """
