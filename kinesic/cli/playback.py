"""A document performed in real time: the face's window, the voice, the servos and the keys that stop them."""

from collections.abc import Callable, Iterator, Mapping
from contextlib import ExitStack, contextmanager
from pathlib import Path
from time import monotonic

import click
from rich.console import Console
from rich.live import Live as Display

from kinesic.body.command import RATE
from kinesic.body.config import ConfigError
from kinesic.body.robot import Robot
from kinesic.cli.ending_signals import leave_closed_terminal
from kinesic.cli.servos.summary import warn_of_lost_events
from kinesic.cli.terminal import pressed_keys
from kinesic.controller.learned_gains import Lesson
from kinesic.controller.performance import Performance
from kinesic.controller.play import command_times, pace, play
from kinesic.controller.servo_performance import RunRequest, ServoRun, interrupted, perform_live
from kinesic.controller.soundtrack import open_speaker, sound, speak_along
from kinesic.face.display import DisplayError
from kinesic.face.show.controls import HELP
from kinesic.face.show.preview import Preview
from kinesic.face.show.preview_settings import PreviewSettings
from kinesic.face.show.window import has_display
from kinesic.files.output_file import new_file
from kinesic.hardware.servos import Servos
from kinesic.hardware.supervisor.channel import Status
from kinesic.hardware.supervisor.state_machine import Awaited
from kinesic.planning.face_track import commands_with_face
from kinesic.planning.plan import Plan
from kinesic.report.output import WrittenPaths, rewrite
from kinesic.report.report import Json
from kinesic.report.servo_belief import with_lesson
from kinesic.report.servo_report import live_log, with_live
from kinesic.sim.log import write_log

KEYS = "space: stop where it is; Enter: go on; Ctrl-C: fold to rest and let go."
HELD: Mapping[Awaited, str] = {
    "consent": "the servos hold: Enter goes on, Ctrl-C folds to rest and ends",
    "confirmation": "a limb cannot fold, and is held: `kinesic servos release` lets it fall",
    "port": "a port is gone: plug it in again",
}


@contextmanager
def preview_window(robot: Robot, *, requested: bool, beside: Path | None = None) -> Iterator[Preview | None]:
    """Opens a window of the face meanwhile, where it is requested and there is a display; else it is None.

    Args:
        robot: whose head turns the face.
        requested: whether anybody wants to see it.
        beside: a film of its body.

    Raises:
        ConfigError: the window does not open.
    """
    if not requested:
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
    """Shows a whole performance in its own time, with its voice where there is a loudspeaker."""
    commands, voice = tuple(commands_with_face(plan, command_times(plan.duration))), sound(plan)
    with ExitStack() as opened:
        speaker = None if voice is None else opened.enter_context(open_speaker(warn))
        if voice is not None and speaker is not None:
            speaker.play(voice, monotonic())
        play(pace(commands), preview)


def follow_servos(plan: Plan, preview: Preview | None) -> Callable[[Status], None]:
    """Makes a callback that, at each status of the servos, shows the face at their performance time."""
    if preview is None:
        return lambda status: None
    commands = tuple(commands_with_face(plan, command_times(plan.duration)))

    def follow(status: Status) -> None:
        preview.write(commands[min(max(round(status.time * RATE), 0), len(commands) - 1)])

    return follow


def perform_on_servos(
    performance: Performance,
    ports: dict[str, Path],
    folder: Path,
    *,
    quiet: bool,
    listener: Callable[[Status], None] = lambda status: None,
) -> ServoRun:
    """Performs on the servos, and aloud, what the twin has performed; events are added to FOLDER/events.jsonl.

    Args:
        performance: of the twin.
        ports: of the robot's buses.
        folder: of the report.
        quiet: nothing is shown in the terminal.
        listener: gets every status of the servos.

    Raises:
        BusError: a port or a servo is missing or wrong; nothing has moved.
    """
    plan = performance.plan
    with speak_along(plan, warn) as said:
        servos = Servos(plan.setup.robot, ports, log=folder / "events.jsonl")
        if not quiet:
            click.echo(KEYS, err=True)
        with interrupted() as folding, pressed_keys() as keys, _display(quiet) as shown:
            listeners = _all(shown, said, tell_waiting(), listener)
            live = perform_live(performance, servos, requested=_requested(keys, folding), shown=listeners)
    warn_of_lost_events(live.notes)
    return live


def _all(*listeners: Callable[[Status], None]) -> Callable[[Status], None]:
    def hear(status: Status) -> None:
        for listener in listeners:
            listener(status)

    return hear


def tell_waiting() -> Callable[[Status], None]:
    """Makes a callback that prints what the servos wait for, when it is a person that can help."""
    before: list[Awaited] = ["nothing"]

    def tell(status: Status) -> None:
        if status.waits != before[-1] and status.waits in HELD:
            warn(HELD[status.waits])
        before[:] = [status.waits]

    return tell


def _requested(keys: Callable[[], str], folding: Callable[[], bool]) -> Callable[[], RunRequest]:
    def request() -> RunRequest:
        pressed = keys()
        if " " in pressed:
            return "stop"
        if "\n" in pressed or "\r" in pressed:
            return "resume"
        if not folding():
            return "go on"
        leave_closed_terminal()
        return "end"

    return request


def write_live(
    live: ServoRun, data: dict[str, Json], written: WrittenPaths, lesson: Lesson | None
) -> tuple[dict[str, Json], Path]:
    """Writes the report anew with what the robot did and told, and a log; returns report and path of the log."""
    whole = with_lesson(with_live(data, live), lesson)
    rewrite(written, live.performance, whole)
    log = written.report.with_name("servos.npz")
    with new_file(log, force=True) as fresh:
        write_log(live_log(live), live.performance.plan.setup.robot, fresh)
    return whole, log


@contextmanager
def _display(quiet: bool) -> Iterator[Callable[[Status], None]]:
    """Opens a line that shows how it goes, where there is a terminal."""
    screen = Console(stderr=True)
    if quiet or not screen.is_terminal:
        yield lambda status: None
        return
    with Display(console=screen, transient=True) as display:
        yield lambda status: display.update(_line(status))


def _line(status: Status) -> str:
    parts = (
        f"{status.stage.value:9} {status.time:6.2f} s",
        f"{status.energised} servos on",
        f"{status.hottest:.0f} C",
        f"{status.volts:.1f} V",
        *((f"{status.silent} silent",) if status.silent else ()),
    )
    return "  ".join(parts)


def warn(line: str) -> None:
    """Prints to standard error what cannot be seen or heard."""
    click.echo(line, err=True)
