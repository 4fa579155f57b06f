"""The command line: one file per verb, one line per error, and exit codes as promised."""

import sys

import click

from kinesic.bml.block import BmlError
from kinesic.body.config import ConfigError
from kinesic.cli.lazy_group import Verbs
from kinesic.hardware.protocol.wire import BusError
from kinesic.version import __version__

BAD_INPUT = 2


@click.group(cls=Verbs, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(__version__)
def kinesic() -> None:
    """Performs BML (Behavior Markup Language) on humanoids with servos."""


kinesic.offer(
    __name__,
    bench="Measures PART; timings are medians in a warm process.",
    doctor="Shows what works here and what would mend the rest.",
    face="Draws the face: a still, a film, a contact sheet, or a window where there is a display and no --out.",
    gestures="Lists, shows and draws the gestures of the lexicon.",
    perform="Performs FILE (BML, a .bap motion, or - for BML from standard input) and writes a report.",
    plan="Plans FILE (BML, a .bap motion, or - for BML from standard input) and writes the motion.",
    robots="Lists, shows, checks and imports robots.",
    serve="Performs blocks of BML as they come, and answers with BML feedback.",
    servos="Finds, shows, calibrates, releases and simulates servos on wires.",
    study="Asks people what they see in the face, with and without wrinkles.",
    sweep="Plays GESTURE over the range of a parameter in the twin, measures and draws it.",
    twin="Fits the twin to a robot.",
    validate="Performs every document of PATHS (folders are searched) in the twin.",
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
