"""The page of all messages that clients send to `kinesic serve`."""

from typing import get_args

import msgspec
from struct_tables import key_table, nested_tables, title_of

from kinesic.serve.messages import BodyReport, ServoPlace, ServoReport
from kinesic.serve.wire.protocol import MAX_CONTROL_SIZE, Control
from kinesic.serve.wire.questions import LONG_VERBS

HEAD = f"""# Messages of the server

A program controls a running `kinesic serve` by sending messages. This page lists all messages with their keys. The
[wire protocol](wire-protocol.md) explains when to send them and what the server answers. The page is generated from
the types that the server decodes.

A message is a JSON object of at most {MAX_CONTROL_SIZE} bytes, and its key `do` names the message. Only {{long}}
may be as long as a document. If a key or a value is invalid, the server refuses the message and says where the error
is.

In the tables, a key with an empty default is optional. *None* means that the key is missing or `null`. With an `id`
other than 0, the answer repeats this number, so that a client can match answers to its requests. A unit such as [m]
precedes a meaning, and (m,) marks a list with one element for each of the m servos.

"""


def list_messages() -> list[type[msgspec.Struct]]:
    """Return all client message types, sorted by verb."""
    return sorted(get_args(Control), key=verb_of)


def verb_of(message: type[msgspec.Struct]) -> str:
    """Return the value of a message's key `do`."""
    return str(message.__struct_config__.tag)


def write_page() -> str:
    """Return the page with the keys of all messages."""
    *verbs, last = [f"`{verb}`" for verb in sorted(LONG_VERBS)]
    long = f"{', '.join(verbs)} and {last}"
    lines = [HEAD.format(long=long) + "| message | effect |", "|---|---|"]
    for message in list_messages():
        lines.append(f"| [`{verb_of(message)}`](#{verb_of(message)}) | {_about(message)} |")
    for message in list_messages():
        lines += ["", f"## {verb_of(message)}", "", _about(message), ""]
        lines += (
            key_table(message) if message.__struct_fields__ else [f'`{{"do": "{verb_of(message)}"}}` has no other key.']
        )
        for table in list(nested_tables(message))[1:]:
            lines += ["", f"### {title_of(table)}", "", _about(table), "", *key_table(table)]
    lines += [
        "",
        "## Reports",
        "",
        "A client that has sent `watch` receives `body` reports. The answer to `servos` lists servo places.",
    ]
    for report in (BodyReport, ServoReport, ServoPlace):
        title = report.__name__.replace("Report", " report").replace("Place", " place").capitalize()
        lines += ["", f"### {title}", "", _about(report), "", *key_table(report)]
    return "\n".join(lines) + "\n"


def _about(message: type[msgspec.Struct]) -> str:
    return " ".join((message.__doc__ or "").split())
