"""`kinesic say -`: what comes on standard input is said phrase by phrase, as it comes."""

import json
from functools import partial
from xml.sax.saxutils import unescape

import click

from kinesic.body.config import ConfigError
from kinesic.cli.live.door import Door
from kinesic.cli.live.frozen import FrozenPlanning
from kinesic.cli.live.serve import open_and_serve
from kinesic.cli.options import Output, Performers, Planning
from kinesic.cli.plain_words import printable
from kinesic.serve.wire.transport import WordConsole

NOBODY = Door("none", None, (), texts=False)
WARNING = "<warningFeedback"
GRAVE = ("rule ", "not performed", "left out")  # what warnings begin with that cost words or behaviours


def speak_as_it_comes(planning: Planning, performers: Performers, output: Output) -> int:
    """Says standard input until it ends and everything is said; nobody else connects, and no report is written."""
    if output.out is not None:
        raise ConfigError(f"--out {output.out}: words that come one by one leave no report; give the text itself")
    show = click.echo if output.as_json else _show
    console = partial(WordConsole, show=show)
    return open_and_serve(FrozenPlanning.of(planning), NOBODY, performers, None, (), console=console)


def _show(message: str) -> None:
    """Prints what is said now; to standard error what is not performed."""
    if message.startswith("{"):
        answer = json.loads(message)
        if answer.get("told") == "saying":
            click.echo(printable(answer["text"]))
        elif "why" in answer:
            click.echo(f"kinesic: {printable(answer['why'])}", err=True)
    elif message.startswith(WARNING) and (why := message.partition(">")[2]).startswith(GRAVE):
        click.echo(f"kinesic: {printable(unescape(why.partition('<')[0]))}", err=True)
