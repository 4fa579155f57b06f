"""The robot's part of `kinesic perform`: ports, keyboard, and what is written and told afterwards."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import click
from rich.console import Console
from rich.live import Live as Display

from kinesic.cli.playback import loudspeaker
from kinesic.cli.terminal import pressed_keys
from kinesic.controller.performance import Performance
from kinesic.controller.servo_performance import ServoRun, Wish, interrupted, perform_live
from kinesic.controller.soundtrack import SpeechPlayback, sound
from kinesic.hardware.servos import Servos
from kinesic.hardware.supervisor.channel import Status
from kinesic.planning.plan import Plan
from kinesic.report.output import Written, rewrite
from kinesic.report.report import Json
from kinesic.report.servo_report import live_log, with_live
from kinesic.sim.log import write_log

KEYS = "space: stop where it is; again: let go. Ctrl-C: fold to rest and let go."


def perform_on_servos(
    performance: Performance,
    ports: dict[str, Path],
    folder: Path,
    *,
    quiet: bool,
    told: Callable[[Status], None] = lambda status: None,
) -> ServoRun:
    """Performs on the servos, and aloud, what the twin has performed; events are added to FOLDER/events.jsonl.

    Args:
        performance: of the twin.
        ports: of the robot's buses.
        folder: of the report.
        quiet: nothing is shown in the terminal.
        told: hears how it goes.

    Raises:
        BusError: a port or a servo is missing or wrong; nothing has moved.
    """
    plan = performance.plan
    with speak_along(plan) as said:
        servos = Servos(plan.setup.robot, ports, log=folder / "events.jsonl")
        if not quiet:
            click.echo(KEYS, err=True)
        with interrupted() as folding, pressed_keys() as keys, _display(quiet) as shown:
            return perform_live(performance, servos, wish=_wish(keys, folding), shown=_all(shown, said, told))


@contextmanager
def speak_along(plan: Plan) -> Iterator[Callable[[Status], None]]:
    """What is said in a plan is heard meanwhile at the time that the servos tell, where there is a loudspeaker."""
    heard = sound(plan)
    if heard is None:
        yield lambda status: None
        return
    with loudspeaker() as speaker:
        yield SpeechPlayback(heard, speaker) if speaker is not None else lambda status: None


def _all(*listeners: Callable[[Status], None]) -> Callable[[Status], None]:
    """All of them hear."""

    def hear(status: Status) -> None:
        for listener in listeners:
            listener(status)

    return hear


def _wish(keys: Callable[[], str], folding: Callable[[], bool]) -> Callable[[], Wish]:
    """What somebody at the keyboard wants."""

    def wish() -> Wish:
        if " " in keys():
            return "stop"
        return "end" if folding() else "go on"

    return wish


def write_live(live: ServoRun, data: dict[str, Json], written: Written) -> tuple[dict[str, Json], Path]:
    """Writes the report anew with what the robot did, and its log; the report, and the path of the log."""
    told = with_live(data, live)
    rewrite(written, live.performance, told)
    log = written.report.with_name("servos.npz")
    write_log(live_log(live), live.performance.plan.setup.robot, log)
    return told, log


@contextmanager
def _display(quiet: bool) -> Iterator[Callable[[Status], None]]:
    """One line that tells how it goes, where there is a terminal."""
    screen = Console(stderr=True)
    if quiet or not screen.is_terminal:
        yield lambda told: None
        return
    with Display(console=screen, transient=True) as display:
        yield lambda told: display.update(_line(told))


def _line(told: Status) -> str:
    return (
        f"{told.stage.value:9} {told.time:6.2f} s  {told.energised} servos on  {told.hottest:.0f} C  {told.volts:.1f} V"
        f"{'' if not told.silent else f'  {told.silent} silent'}"
    )
