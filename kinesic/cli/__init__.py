"""Runs the command line: prints one line per error, and sets the exit code."""

import sys

from kinesic.cli.ending_signals import STOPPED, ended_by_signals, ended_on_the_spot

with ended_on_the_spot():  # Ctrl-C is one line from the beginning
    import click

    from kinesic.bml.block import BmlError
    from kinesic.body.config import ConfigError
    from kinesic.cli.live import mcp_verb, serve_verb, studio_verb
    from kinesic.cli.many.verbs import results_verb, search_verb, sweep_verb, validate_verb
    from kinesic.cli.plain_words import printable
    from kinesic.cli.servos import servo_verbs
    from kinesic.cli.verbs import kinesic, robots
    from kinesic.hardware.protocol.wire import BusError

BAD_INPUT = 2


for verb in (serve_verb, studio_verb, mcp_verb, servo_verbs, results_verb, sweep_verb, validate_verb):
    kinesic.add_command(verb)
robots.add_command(search_verb)


def main() -> None:
    """Runs the command line; errors of input and configuration are one line on standard error."""
    try:
        with ended_by_signals():
            sys.exit(kinesic(standalone_mode=False) or 0)
    except (BmlError, ConfigError, BusError) as error:
        for line in str(error).splitlines():
            click.echo(f"kinesic: {printable(line)}", err=True)
        sys.exit(BAD_INPUT)
    except click.ClickException as error:
        error.show()
        sys.exit(BAD_INPUT)
    except click.Abort:
        sys.exit(STOPPED)
