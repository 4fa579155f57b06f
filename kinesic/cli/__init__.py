"""Command-line entry point with one-line errors and exit codes."""

import sys

from kinesic.cli.ending_signals import INTERRUPTED_EXIT_CODE, exit_at_once_on_interrupt, exit_on_signals

with exit_at_once_on_interrupt():  # Ctrl-C prints one line even during imports.
    import click

    from kinesic.bml.block import BmlError
    from kinesic.body.config import ConfigError
    from kinesic.cli.capture_verbs import capture_verbs
    from kinesic.cli.certify_verb import certify_verb
    from kinesic.cli.examples import attach_examples
    from kinesic.cli.export_verb import export_verb
    from kinesic.cli.extras import explain_missing
    from kinesic.cli.gesture_verbs import gesture_verbs
    from kinesic.cli.live import mcp_verb, serve_verb, studio_verb
    from kinesic.cli.many.verbs import results_verb, search_verb, sweep_verb, validate_verb
    from kinesic.cli.plain_words import printable
    from kinesic.cli.servos import servo_verbs
    from kinesic.cli.study.verbs import study_verbs
    from kinesic.cli.style_verbs import style_verbs
    from kinesic.cli.verbs import kinesic, robots
    from kinesic.face.display import DisplayError
    from kinesic.hardware.protocol.wire import BusError

BAD_INPUT_EXIT_CODE = 2  # exit code for invalid input or configuration


for verb in (
    gesture_verbs,
    style_verbs,
    serve_verb,
    studio_verb,
    mcp_verb,
    servo_verbs,
    study_verbs,
    results_verb,
    sweep_verb,
    validate_verb,
    export_verb,
    capture_verbs,
    certify_verb,
):
    kinesic.add_command(verb)
robots.add_command(search_verb)
attach_examples(kinesic)


def main() -> None:
    """Run the command line and exit, with one-line messages for input errors."""
    try:
        with exit_on_signals():
            sys.exit(kinesic(standalone_mode=False) or 0)
    except (BmlError, ConfigError, BusError, DisplayError) as error:
        for line in str(error).splitlines():
            click.echo(f"kinesic: {printable(line)}", err=True)
        sys.exit(BAD_INPUT_EXIT_CODE)
    except ModuleNotFoundError as error:
        if (remedy := explain_missing(error)) is None:
            raise
        click.echo(f"kinesic: {remedy}", err=True)
        sys.exit(BAD_INPUT_EXIT_CODE)
    except click.ClickException as error:
        error.show()
        sys.exit(BAD_INPUT_EXIT_CODE)
    except click.Abort:
        sys.exit(INTERRUPTED_EXIT_CODE)
