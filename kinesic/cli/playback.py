"""What people see and hear while a document is performed: the face's window and the machine's loudspeaker."""

from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from time import monotonic

import click

from kinesic.body.command import RATE
from kinesic.body.config import ConfigError
from kinesic.body.robot import Robot
from kinesic.controller.play import command_times, pace, play
from kinesic.controller.soundtrack import sound
from kinesic.face.display import DisplayError
from kinesic.face.show.controls import HELP
from kinesic.face.show.preview import Preview
from kinesic.face.show.process import PreviewSettings
from kinesic.face.show.window import has_display
from kinesic.hardware.supervisor.channel import Status
from kinesic.planning.face_track import commands_with_face
from kinesic.planning.plan import Plan
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


@contextmanager
def preview_window(robot: Robot, *, asked: bool, beside: Path | None = None) -> Iterator[Preview | None]:
    """A window that is open meanwhile, where it is asked for and there is a display; else nothing is watched.

    Args:
        robot: whose head turns the face.
        asked: whether anybody wants to see it.
        beside: a film of its body.

    Raises:
        ConfigError: the window does not open.
    """
    if not asked:
        yield None
        return
    if not has_display():
        click.echo("face: no display for a window; its film is on the page, unless --no-film", err=True)
        yield None
        return
    try:
        preview = Preview(robot, look=PreviewSettings(beside=beside), windowed=True)
    except DisplayError as error:
        raise ConfigError(str(error)) from None
    click.echo(HELP, err=True)
    with preview:
        yield preview


def play_whole(plan: Plan, preview: Preview) -> None:
    """Shows a whole performance in its own time, and lets it be heard where there is a loudspeaker."""
    commands, heard = tuple(commands_with_face(plan, command_times(plan.duration))), sound(plan)
    with ExitStack() as opened:
        speaker = None if heard is None else opened.enter_context(loudspeaker())
        if heard is not None and speaker is not None:
            speaker.play(heard, monotonic())
        play(pace(commands), preview)


def follow_servos(plan: Plan, preview: Preview | None) -> Callable[[Status], None]:
    """Shows the face at the time to which servos have come, whenever they tell it."""
    if preview is None:
        return lambda told: None
    commands = tuple(commands_with_face(plan, command_times(plan.duration)))

    def follow(told: Status) -> None:
        preview.write(commands[min(max(round(told.time * RATE), 0), len(commands) - 1)])

    return follow
