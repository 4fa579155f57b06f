"""Options that set the server's address and admit clients."""

from dataclasses import dataclass
from typing import Annotated

import click

from kinesic.cli.live.token import token_option
from kinesic.cli.options import together
from kinesic.client import PORT

LISTEN_HELP = "Address for TCP and WebSocket; 'none' for standard input alone. Port 0: any that is free."
TOKEN_HELP = "That clients must show; needed where others can connect. Better --token-file or KINESIC_TOKEN."
ORIGIN_HELP = "Whose pages may connect beside the server's own, such as http://localhost:5173; repeat it."
TEXT_HELP = "Says messages that are neither XML nor JSON, with gestures that fit their words."


@dataclass(frozen=True)
class Door:
    """Where clients connect, and which of them may."""

    listen: Annotated[
        str,
        click.option("--listen", default=f"127.0.0.1:{PORT}", show_default=True, metavar="HOST:PORT", help=LISTEN_HELP),
    ]
    token: Annotated[str | None, token_option(TOKEN_HELP)]
    origins: Annotated[
        tuple[str, ...],
        click.option("--allow-origin", "origins", multiple=True, metavar="ORIGIN", help=ORIGIN_HELP),
    ]
    texts: Annotated[bool, click.option("--text", "texts", is_flag=True, help=TEXT_HELP)]


door = together("door", Door)
