"""Command-line options for the server's address and client access."""

from dataclasses import dataclass
from typing import Annotated

import click

from kinesic.cli.live.token import token_option
from kinesic.cli.options import group_options
from kinesic.client import DEFAULT_PORT

LISTEN_HELP = "Address for TCP and WebSocket; 'none': standard input only. Port 0: any free port."
TOKEN_HELP = (
    "Token that clients must send; required if other machines can connect. Prefer --token-file or KINESIC_TOKEN."
)
ORIGIN_HELP = "Origin whose pages may connect like the server's own, such as http://localhost:5173. Repeatable."
TEXT_HELP = "Say messages that are neither XML nor JSON, with matching gestures."


@dataclass(frozen=True)
class AccessOptions:
    """Address of the server and the access rules for clients."""

    listen: Annotated[
        str,
        click.option(
            "--listen", default=f"127.0.0.1:{DEFAULT_PORT}", show_default=True, metavar="HOST:PORT", help=LISTEN_HELP
        ),
    ]
    token: Annotated[str | None, token_option(TOKEN_HELP)]
    origins: Annotated[
        tuple[str, ...],
        click.option("--allow-origin", "origins", multiple=True, metavar="ORIGIN", help=ORIGIN_HELP),
    ]
    texts: Annotated[bool, click.option("--text", "texts", is_flag=True, help=TEXT_HELP)]


access_options = group_options("access_options", AccessOptions)
