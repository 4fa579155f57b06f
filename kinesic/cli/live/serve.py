"""`kinesic serve`: BML blocks in, BML feedback out, until stopped."""

import asyncio
import signal
import sys
from collections.abc import Callable, Mapping, Sequence
from contextlib import AbstractAsyncContextManager, AsyncExitStack
from dataclasses import fields, replace
from functools import partial
from ipaddress import ip_address
from pathlib import Path

import click

from kinesic.body.config import ConfigError, suggestion
from kinesic.cli.ending_signals import leave_closed_terminal
from kinesic.cli.live.door import Door
from kinesic.cli.live.frozen import FrozenPlanning
from kinesic.cli.options import FAULT, Performers, Planning, ServoOptions
from kinesic.cli.progress import show_stages
from kinesic.cli.servos.memory import UNKNOWN, ServoMemory
from kinesic.cli.servos.ports import all_ports
from kinesic.cli.servos.summary import print_lesson, warn_of_lost_events
from kinesic.client import PORT
from kinesic.controller.learned_gains import Lesson
from kinesic.controller.servo_performance import DELAY, ENDING
from kinesic.hardware.servos import Servos
from kinesic.hardware.supervisor.manifest import Manifest
from kinesic.planning.plan import Plan
from kinesic.serve.desk.export import Writers
from kinesic.serve.server import Address, Serving, open_serving, until_done
from kinesic.serve.sinks.learner import ServoLearner
from kinesic.serve.sinks.real_time import AHEAD, RealTimeSink, RealTwin
from kinesic.serve.sinks.servos import RealServos
from kinesic.serve.tracks import SoundAndFace
from kinesic.serve.wire.origin import Access, read_origin
from kinesic.serve.wire.pages import NO_FILES, WebFile
from kinesic.serve.wire.quotas import USUAL, Quotas
from kinesic.serve.wire.transport import Console
from kinesic.sim.distances import CapsuleDistances
from kinesic.speech.loudspeaker import audio_fault

SERVO_POLL = 1.0  # [s] between two looks at what has happened to the servos


def serve_blocks(
    planning: Planning,
    door: Door,
    performers: Performers,
    servos: ServoOptions,
    sound: bool | None,
    rules: tuple[str, ...],
    end_with_input: bool,
) -> int:
    """Perform blocks from TCP, WebSocket and standard input until the end."""
    memory, frozen = ServoMemory.of(servos), FrozenPlanning.of(planning)
    return open_and_serve(frozen, door, performers, sound, rules, memory=memory, ends_with_input=end_with_input)


def open_and_serve(
    planning: FrozenPlanning,
    door: Door,
    performers: Performers,
    sound: bool | None,
    rules: tuple[str, ...],
    *,
    memory: ServoMemory = UNKNOWN,
    files: Mapping[str, WebFile] = NO_FILES,
    folder: Path | None = None,
    armed: bool = True,
    opened: Callable[[Address], None] = lambda _address: None,
    console: Callable[[Quotas], Console] | None = None,
    ends_with_input: bool = False,
) -> int:
    """Opens a server, and waits until it has ended.

    Args:
        planning: how documents are planned.
        door: where clients come in.
        performers: who performs.
        sound: whether speech is heard; None: where that works.
        rules: changes of limits, NAME=VALUE.
        memory: how servos are believed to be, and where what they tell is kept.
        files: that browsers may have.
        folder: where clients keep documents.
        armed: whether servos have torque from the beginning; else a client arms them.
        opened: called with the address once clients may come.
        console: makes what reads standard input, a terminal too; None: messages are read there, unless it is one.
        ends_with_input: whether the end of standard input ends the server although it listens.
    """
    why = audio_fault() if sound is not False else "not wanted"
    if sound and why:
        raise ConfigError(f"--sound: {why}")
    address, limits = read_address(door.listen, door.token), read_rules(rules)
    access = Access(door.token or None, frozenset(map(read_origin, door.origins)), texts=door.texts)
    sinks = _open_sinks(planning, performers, memory, armed=armed)
    server = open_serving(
        planning.set_up,
        sinks,
        address=address,
        rules=limits,
        access=access,
        accompaniment=SoundAndFace(face="face" in performers.sinks, sound=not why),
        files=files,
        folder=folder,
        writers=WRITERS,
    )
    return asyncio.run(_serve(server, sinks, memory, opened, console, ends_with_input=ends_with_input))


def _write_scene(planned: Plan, path: Path) -> None:
    from kinesic.report.gltf.scene import save_scene  # noqa: PLC0415 - the server itself draws nothing

    save_scene(planned, path, force=True)


WRITERS: Writers = {"glb": _write_scene}


def read_address(text: str, token: str | None) -> Address | None:
    """Reads HOST:PORT to listen at; None for `none`.

    Raises:
        ConfigError: it is no address, or others than this machine could connect without a token.
    """
    if text == "none":
        return None
    host, _, port = text.rpartition(":")
    host = host.strip("[]")
    if not host or not port.isdecimal() or int(port) > 65_535:
        raise ConfigError(f"--listen {text}: give HOST:PORT, such as 127.0.0.1:{PORT}, or none")
    if not token and not _is_here(host):
        raise ConfigError(f"--listen {text}: others can connect there; give --token-file, or set KINESIC_TOKEN")
    return Address(host, int(port))


def read_rules(changes: tuple[str, ...]) -> Quotas:
    """Reads changes of single limits, NAME=VALUE.

    Raises:
        ConfigError: no such rule, or a value that makes no sense.
    """
    rules, kinds = USUAL, {each.name: type(getattr(USUAL, each.name)) for each in fields(Quotas)}
    for change in changes:
        name, _, value = change.partition("=")
        if name not in kinds:
            raise ConfigError(f"--rule {change}: no rule {name}{suggestion(name, tuple(kinds))}")
        try:
            rules = replace(rules, **{name: kinds[name](value)})
        except ValueError as error:
            raise ConfigError(f"--rule {change}: {error}") from None
    return rules


def _is_here(host: str) -> bool:
    try:
        return ip_address(host).is_loopback
    except ValueError:
        return host == "localhost"


def _open_sinks(
    planning: FrozenPlanning, performers: Performers, memory: ServoMemory, *, armed: bool
) -> list[RealTimeSink]:
    robot, sinks, believed = planning.robot, performers.sinks, memory.believed
    believed.applied(robot)  # before anything is opened: refuses servos that it has not
    factors = memory.twins[0]
    opened: list[RealTimeSink] = []
    if "twin" in sinks:  # one that is as it is believed to be tells nothing
        learner = ServoLearner(robot, believed) if memory.learns and factors != believed else None
        opened.append(RealTimeSink(RealTwin(robot, factors=factors), believed=believed, learner=learner))
    if "servos" in sinks:
        ports = all_ports(performers.ports, Manifest.of(robot).bauds)
        opens = partial(Servos, robot, ports, log=Path("events.jsonl"))
        watched = RealServos(opens, distances=CapsuleDistances(robot), least=robot.least_clearance, armed=armed)
        learner = ServoLearner(robot, believed) if memory.learns else None
        opened.append(RealTimeSink(watched, ahead=AHEAD, delay=DELAY, believed=believed, learner=learner))
    if "face" in sinks:
        from kinesic.face.show.preview import Preview  # noqa: PLC0415 - slow to import, and few ask for it

        opened.append(RealTimeSink(Preview(robot)))
    return opened


async def _serve(
    server: AbstractAsyncContextManager[Serving],
    sinks: Sequence[RealTimeSink],
    memory: ServoMemory,
    opened: Callable[[Address], None],
    console: Callable[[Quotas], Console] | None,
    *,
    ends_with_input: bool,
) -> int:
    end_requested = asyncio.Event()

    def end() -> None:
        leave_closed_terminal()
        end_requested.set()

    async with AsyncExitStack() as closing:
        with show_stages() as stage:
            stage("starting the planner")
            open_ = await closing.enter_async_context(server)
        for number in (each for each in ENDING if signal.getsignal(each) is not signal.SIG_IGN):
            asyncio.get_running_loop().add_signal_handler(number, end)
        where = f"listening at {open_.address}" if open_.address is not None else "reading standard input"
        click.echo(f"{where}; Ctrl-C folds to rest and ends", err=True)
        if open_.address is not None:
            opened(open_.address)
        telling = asyncio.create_task(_tell_of_servos(sinks, memory))
        is_read = console is not None or not sys.stdin.isatty()
        await until_done(
            open_,
            end_requested,
            console=is_read,
            ends_with_input=ends_with_input,
            make_console=console or Console,
        )
        telling.cancel()
    session = open_.clients.session
    if session.loop.error is not None:
        click.echo(f"kinesic: {session.loop.error}", err=True)
    return FAULT if session.loop.failed or session.planner.failed else 0


async def _tell_of_servos(sinks: Sequence[RealTimeSink], memory: ServoMemory) -> None:
    """Tells of lost events, and of what servos have told, which is kept for the next time."""
    servos = [each.sink for each in sinks if isinstance(each.sink, RealServos)]
    told: list[Lesson] = []
    while True:
        for each in servos:
            warn_of_lost_events(each.servos.events())
        for lesson in (each.lesson for each in sinks if each.lesson is not None and each.lesson not in told):
            told.append(lesson)
            try:
                print_lesson(lesson, memory.keep(lesson), on_error=True)
            except ConfigError as error:  # the disk is full, or the folder has gone; the robot goes on
                click.echo(f"kinesic: {error}", err=True)
        await asyncio.sleep(SERVO_POLL)
