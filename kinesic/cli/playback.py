"""Real-time performance with the face window, voice, servos and stop keys."""

from collections.abc import Callable, Iterator, Mapping
from contextlib import ExitStack, contextmanager
from pathlib import Path
from time import monotonic

import click

from kinesic.body.command import COMMAND_RATE
from kinesic.body.config import ConfigError
from kinesic.body.robot import Robot
from kinesic.cli.ending_signals import detach_closed_terminal
from kinesic.cli.screen.live import LiveLines
from kinesic.cli.servos.summary import warn_of_lost_events
from kinesic.cli.terminal import error_console, pressed_keys
from kinesic.controller.learned_gains import Identification
from kinesic.controller.play import pace_commands, play
from kinesic.controller.servo_performance import RunRequest, catch_interrupts, perform_live
from kinesic.controller.slow_moves import settings_near_people
from kinesic.controller.soundtrack import open_speaker, sound, speak_along
from kinesic.face.display import DisplayError
from kinesic.face.show.controls import KEY_HELP
from kinesic.face.show.preview import Preview
from kinesic.face.show.preview_settings import PreviewSettings
from kinesic.face.show.window import has_display
from kinesic.files.output_file import new_file
from kinesic.hardware.servos import Servos
from kinesic.hardware.supervisor.channel import Status
from kinesic.hardware.supervisor.state_machine import Awaited
from kinesic.metrics.dry_run import DryRun
from kinesic.metrics.servo_run import ServoRun
from kinesic.planning.face_track import commands_with_face
from kinesic.planning.plan import Plan
from kinesic.report.output import WrittenPaths, rewrite
from kinesic.report.report import Json
from kinesic.report.servo_estimate import add_identification
from kinesic.report.servo_report import live_log, with_live
from kinesic.sim.log import write_log

SERVO_KEY_HELP = "space: stop and hold; Enter: resume; Ctrl-C: fold to rest and switch torque off."
STATUS_LINE_RATE = 8.0  # [Hz] redraws of the servos' status line
WAIT_MESSAGES: Mapping[Awaited, str] = {
    "consent": "the servos hold: Enter resumes, Ctrl-C folds to rest and ends",
    "confirmation": "a limb cannot fold and is held: `kinesic servos release` lets it fall",
    "port": "a port was disconnected: plug it in again",
}


@contextmanager
def preview_window(robot: Robot, *, requested: bool, body_film: Path | None = None) -> Iterator[Preview | None]:
    """Open a face window if requested and a display exists.

    Otherwise the value is None.

    Args:
        robot: robot whose head turns the face.
        requested: whether the window is requested.
        body_film: film of the robot's body to show next to the face.

    Raises:
        ConfigError: the window does not open.
    """
    if not requested:
        yield None
        return
    if not has_display():
        click.echo("face: no display for a window; the report has a film, unless --no-film", err=True)
        yield None
        return
    try:
        preview = Preview(robot, look=PreviewSettings(beside=body_film), windowed=True)
    except DisplayError as error:
        raise ConfigError(str(error)) from None
    click.echo(KEY_HELP, err=True)
    with preview:
        yield preview


def play_whole(plan: Plan, preview: Preview) -> None:
    """Play a plan in the face window, with its voice if possible."""
    commands, voice = tuple(commands_with_face(plan, plan.command_times)), sound(plan)
    with ExitStack() as stack:
        speaker = None if voice is None else stack.enter_context(open_speaker(warn))
        if voice is not None and speaker is not None:
            speaker.play(voice, monotonic())
        play(pace_commands(commands), preview)


def follow_servos(plan: Plan, preview: Preview | None) -> Callable[[Status], None]:
    """Make a callback that shows the face at the servos' performance time."""
    if preview is None:
        return lambda status: None
    commands = tuple(commands_with_face(plan, plan.command_times))

    def follow(status: Status) -> None:
        preview.write(commands[min(max(round(status.time * COMMAND_RATE), 0), len(commands) - 1)])

    return follow


def perform_on_servos(
    performance: DryRun,
    ports: dict[str, Path],
    folder: Path,
    *,
    quiet: bool,
    listener: Callable[[Status], None] = lambda status: None,
) -> ServoRun:
    """Perform a plan on the servos with speech, after the twin.

    Servo events are appended to FOLDER/events.jsonl.

    Args:
        performance: performance of the twin.
        ports: ports of the robot's buses.
        folder: folder of the report.
        quiet: whether nothing is shown in the terminal.
        listener: called with every status of the servos.

    Raises:
        BusError: a port or a servo is missing or wrong; nothing has moved.
    """
    plan = performance.plan
    with speak_along(plan, warn) as voice:
        settings = settings_near_people(plan.setup)
        servos = Servos(plan.setup.robot, ports, settings=settings, log=folder / "events.jsonl")
        if not quiet:
            click.echo(SERVO_KEY_HELP, err=True)
        with catch_interrupts() as interrupted, pressed_keys() as keys, _open_status_line(quiet) as status_line:
            listeners = _call_all(status_line, voice, report_waiting(), listener)
            servo_run = perform_live(
                performance, servos, requested=_make_request_reader(keys, interrupted), shown=listeners
            )
    warn_of_lost_events(servo_run.notes)
    return servo_run


def _call_all(*listeners: Callable[[Status], None]) -> Callable[[Status], None]:
    def call(status: Status) -> None:
        for listener in listeners:
            listener(status)

    return call


def report_waiting() -> Callable[[Status], None]:
    """Make a callback that prints the user action required by the servos.

    It prints only if a person can act, and only when this changes.
    """
    previous: list[Awaited] = ["nothing"]

    def report(status: Status) -> None:
        if status.waits != previous[-1] and status.waits in WAIT_MESSAGES:
            warn(WAIT_MESSAGES[status.waits])
        previous[:] = [status.waits]

    return report


def _make_request_reader(keys: Callable[[], str], interrupted: Callable[[], bool]) -> Callable[[], RunRequest]:
    def request() -> RunRequest:
        pressed = keys()
        if " " in pressed:
            return "stop"
        if "\n" in pressed or "\r" in pressed:
            return "resume"
        if not interrupted():
            return "go on"
        detach_closed_terminal()
        return "end"

    return request


def write_servo_run(
    servo_run: ServoRun, data: dict[str, Json], written: WrittenPaths, identification: Identification | None
) -> tuple[dict[str, Json], Path]:
    """Rewrite the report with the servo run, and write the servo log.

    Returns:
        The report, and the path of the log.
    """
    new_data = add_identification(with_live(data, servo_run), identification)
    rewrite(written, servo_run.performance, new_data)
    servo_log = written.report.with_name("servos.npz")
    with new_file(servo_log, force=True) as temporary:
        write_log(live_log(servo_run), servo_run.performance.plan.setup.robot, temporary)
    return new_data, servo_log


@contextmanager
def _open_status_line(quiet: bool) -> Iterator[Callable[[Status], None]]:
    """Open a live status line of the servos, on terminals only."""
    screen = error_console()
    if quiet or not screen.is_terminal:
        yield lambda status: None
        return
    line = ""

    def show(status: Status) -> None:
        nonlocal line
        line = _format_status(status)

    with LiveLines(screen, lambda: (line,), rate=STATUS_LINE_RATE).shown():
        yield show


def _format_status(status: Status) -> str:
    parts = (
        f"{status.stage.value:9} {status.time:6.2f} s",
        f"{status.energised} servos with torque",
        f"{status.hottest:.0f} C",
        f"{status.volts:.1f} V",
        *((f"{status.silent} silent",) if status.silent else ()),
    )
    return "  ".join(parts)


def warn(line: str) -> None:
    """Print a warning line to standard error."""
    click.echo(line, err=True)
