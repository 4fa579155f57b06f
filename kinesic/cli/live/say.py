"""Verb `kinesic say -`: speak standard input phrase by phrase."""

import json
from functools import partial
from xml.sax.saxutils import unescape

import click

from kinesic.body.config import ConfigError
from kinesic.cli.live.access_options import AccessOptions
from kinesic.cli.live.frozen import FrozenPlanning
from kinesic.cli.live.serve import open_and_serve
from kinesic.cli.options import Output, Performers, Planning
from kinesic.cli.plain_words import printable
from kinesic.serve.wire.transport import WordConsole

NO_CLIENTS = AccessOptions("none", None, (), texts=False)  # server access without network
WARNING_TAG = "<warningFeedback"  # start of a BML warning message
LOSS_PREFIXES = ("rule ", "not performed", "left out")  # starts of warnings about lost words or behaviours


def speak_standard_input(planning: Planning, performers: Performers, output: Output) -> int:
    """Speak standard input as it arrives, and return after the last phrase.

    No other client can connect, and no report is written.
    """
    if output.out is not None:
        raise ConfigError(f"--out {output.out}: speech from standard input has no report; give the text as an argument")
    print_message = click.echo if output.as_json else _print_message
    console = partial(WordConsole, show=print_message)
    return open_and_serve(FrozenPlanning.of(planning), NO_CLIENTS, performers, None, (), console=console)


def _print_message(message: str) -> None:
    """Print spoken text, and warnings about unperformed parts to standard error."""
    if message.startswith("{"):
        answer = json.loads(message)
        if answer.get("told") == "saying":
            click.echo(printable(answer["text"]))
        elif "why" in answer:
            click.echo(f"kinesic: {printable(answer['why'])}", err=True)
    elif message.startswith(WARNING_TAG) and (reason := message.partition(">")[2]).startswith(LOSS_PREFIXES):
        click.echo(f"kinesic: {printable(unescape(reason.partition('<')[0]))}", err=True)
