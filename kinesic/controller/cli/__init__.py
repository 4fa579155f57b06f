"""The command line: one file per verb. It prints results, one line per error, and exits with the promised code."""

import sys

import click

from kinesic import __version__
from kinesic.bml.block import BmlError
from kinesic.body.config import ConfigError
from kinesic.controller.cli.verbs import Verbs
from kinesic.hardware.wire import BusError

BAD_INPUT = 2


@click.group(cls=Verbs, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(__version__)
def kinesic() -> None:
    """Performs BML (Behavior Markup Language) on humanoids with servos."""


kinesic.offer(
    __name__,
    *("perform", "validate", "plan", "serve", "robots", "gestures", "face"),
    *("study", "sweep", "twin", "servos", "bench", "doctor"),
)


def main() -> None:
    """Runs the command line; errors of input and configuration are one line on standard error."""
    try:
        sys.exit(kinesic(standalone_mode=False) or 0)
    except (BmlError, ConfigError, BusError) as error:
        for line in str(error).splitlines():
            click.echo(f"kinesic: {line}", err=True)
        sys.exit(BAD_INPUT)
    except click.ClickException as error:
        error.show()
        sys.exit(BAD_INPUT)
    except click.Abort:
        sys.exit(130)
