"""The machine's loudspeaker, where there is one."""

from collections.abc import Iterator
from contextlib import contextmanager

import click

from kinesic.speech.loudspeaker import SpeakerError
from kinesic.speech.speaker import Speaker


@contextmanager
def loudspeaker() -> Iterator[Speaker | None]:
    """Open meanwhile; None, and a line that tells why, where nothing can be heard."""
    try:
        speaker = Speaker()
    except SpeakerError as error:
        click.echo(f"voice: not heard ({error})", err=True)
        yield None
        return
    try:
        yield speaker
    finally:
        speaker.close()
