"""Verb `kinesic serve`: perform BML blocks and send feedback until stopped."""

import asyncio
import signal
import sys
from collections.abc import Callable, Mapping, Sequence
from contextlib import AbstractAsyncContextManager, AsyncExitStack
from dataclasses import dataclass, fields, replace
from functools import partial
from pathlib import Path

import click

from kinesic.body.config import ConfigError, suggestion
from kinesic.cli.ending_signals import detach_closed_terminal
from kinesic.cli.live.access_options import AccessOptions
from kinesic.cli.live.addresses import read_listen_address
from kinesic.cli.live.frozen import FrozenPlanning
from kinesic.cli.options import FAULT_EXIT_CODE, Performers, Planning, ServoOptions
from kinesic.cli.progress import show_stages
from kinesic.cli.servos.memory import NO_SERVO_MEMORY, ServoMemory
from kinesic.cli.servos.ports import read_all_ports
from kinesic.cli.servos.summary import print_learned_factors, warn_of_lost_events
from kinesic.controller.learned_gains import Identification
from kinesic.controller.servo_performance import BUS_DELAY
from kinesic.controller.slow_moves import settings_near_people
from kinesic.hardware.servos import Servos
from kinesic.hardware.supervisor.manifest import Manifest
from kinesic.heap import freeze_heap
from kinesic.hearing.microphone import MicrophoneError, SampleSource, open_source
from kinesic.host import ENDING_SIGNALS
from kinesic.planning.plan import Plan
from kinesic.serve.address import Address
from kinesic.serve.desk.export import Writers
from kinesic.serve.listening import hear_people
from kinesic.serve.server import Serving, open_serving, serve_until_done
from kinesic.serve.sinks.learner import ServoLearner
from kinesic.serve.sinks.real_time import SERVO_LOOKAHEAD, RealTimeSink, RealTwin
from kinesic.serve.sinks.servos import RealServos
from kinesic.serve.tracks import SoundAndFace
from kinesic.serve.wire.origin import Access, read_origin
from kinesic.serve.wire.pages import NO_FILES, WebFile
from kinesic.serve.wire.quotas import DEFAULT_QUOTAS, Quotas
from kinesic.serve.wire.transport import Console
from kinesic.sim.distances import CapsuleDistances
from kinesic.speech.loudspeaker import audio_fault
from kinesic.speech.speaker import SAMPLE_RATE

SERVO_POLL_PERIOD = 1.0  # [s] period of checks for servo events and learned factors


@dataclass(frozen=True, eq=False)
class StandardInput:
    """Use of the standard input of a server."""

    console: Callable[[Quotas], Console] | None  # makes the reader, for terminals too; None: read messages from a pipe
    ends_server: bool  # whether its end ends a server that also listens


def serve_blocks(
    planning: Planning,
    access_options: AccessOptions,
    performers: Performers,
    servos: ServoOptions,
    sound: bool | None,
    rules: tuple[str, ...],
    end_with_input: bool,
    hear: str | None,
) -> int:
    """Perform blocks from TCP, WebSocket and standard input until the end."""
    memory, snapshot = ServoMemory.of(servos), FrozenPlanning.of(planning)
    return open_and_serve(
        snapshot, access_options, performers, sound, rules, memory=memory, ends_with_input=end_with_input, hear=hear
    )


def open_and_serve(
    planning: FrozenPlanning,
    access_options: AccessOptions,
    performers: Performers,
    sound: bool | None,
    rules: tuple[str, ...],
    *,
    memory: ServoMemory = NO_SERVO_MEMORY,
    files: Mapping[str, WebFile] = NO_FILES,
    folder: Path | None = None,
    armed: bool = True,
    announce: Callable[[Address], None] = lambda _address: None,
    console: Callable[[Quotas], Console] | None = None,
    ends_with_input: bool = False,
    hear: str | None = None,
) -> int:
    """Open a server and block until it ends.

    Args:
        planning: configuration of planning.
        access_options: address and access rules.
        performers: outputs that perform, and ports of servos.
        sound: whether speech is audible; None: if audio works.
        rules: changed quotas, NAME=VALUE.
        memory: estimated servo parameters, and where learned ones are stored.
        files: files that browsers may load.
        folder: folder in which clients store documents.
        armed: whether servos have torque from the start; otherwise a client arms them.
        announce: called with the address once clients can connect.
        console: makes the reader of standard input, terminals included; None: read messages unless it is a terminal.
        ends_with_input: whether the end of standard input ends a server that also listens.
        hear: microphone or pipe in which people are heard; None: none.
    """
    source = None if hear is None else _open_source(hear)
    audio_problem = audio_fault() if sound is not False else "not requested"
    if sound and audio_problem:
        raise ConfigError(f"--sound: {audio_problem}")
    address, quotas = read_listen_address(access_options.listen, access_options.token), read_rules(rules)
    access = Access(
        access_options.token or None, frozenset(map(read_origin, access_options.origins)), texts=access_options.texts
    )
    sinks = _open_sinks(planning, performers, memory, armed=armed)
    server = open_serving(
        planning.set_up,
        sinks,
        address=address,
        rules=quotas,
        access=access,
        accompaniment=SoundAndFace(face="face" in performers.sinks, sound=not audio_problem),
        files=files,
        folder=folder,
        writers=EXPORT_WRITERS,
    )
    standard_input = StandardInput(console, ends_with_input)
    return asyncio.run(_serve(server, sinks, memory, announce, standard_input, source=source))


def _open_source(name: str) -> SampleSource:
    try:
        return open_source(name, SAMPLE_RATE)
    except MicrophoneError as error:
        raise ConfigError(f"--hear: {error}") from None


def _write_scene(planned: Plan, path: Path) -> None:
    from kinesic.report.gltf.scene import save_scene  # noqa: PLC0415 - only exports need it

    save_scene(planned, path, force=True)


EXPORT_WRITERS: Writers = {"glb": _write_scene}


def read_rules(changes: tuple[str, ...]) -> Quotas:
    """Parse client limits written as NAME=VALUE.

    Raises:
        ConfigError: a quota does not exist, or a value is invalid.
    """
    quotas, types = DEFAULT_QUOTAS, {field.name: type(getattr(DEFAULT_QUOTAS, field.name)) for field in fields(Quotas)}
    for change in changes:
        name, _, value = change.partition("=")
        if name not in types:
            raise ConfigError(f"--rule {change}: no rule {name}{suggestion(name, tuple(types))}")
        try:
            quotas = replace(quotas, **{name: types[name](value)})
        except ValueError as error:
            raise ConfigError(f"--rule {change}: {error}") from None
    return quotas


def _open_sinks(
    planning: FrozenPlanning, performers: Performers, memory: ServoMemory, *, armed: bool
) -> list[RealTimeSink]:
    robot, sinks, estimate = planning.robot, performers.sinks, memory.estimate
    estimate.applied(robot)  # Refuses factors of unknown servos before anything is opened.
    factors = memory.twins[0]
    real_time_sinks: list[RealTimeSink] = []
    if "twin" in sinks:  # Nothing can be learned from a twin that equals the estimate.
        learner = ServoLearner(robot, estimate) if memory.learns and factors != estimate else None
        real_time_sinks.append(RealTimeSink(RealTwin(robot, factors=factors), estimate=estimate, learner=learner))
    if "servos" in sinks:
        ports = read_all_ports(performers.ports, Manifest.of(robot).bauds)
        settings = settings_near_people(planning.set_up())
        open_servos = partial(Servos, robot, ports, settings=settings, log=Path("events.jsonl"))
        servo_sink = RealServos(
            open_servos, distances=CapsuleDistances(robot), min_clearance=robot.min_clearance, armed=armed
        )
        learner = ServoLearner(robot, estimate) if memory.learns else None
        real_time_sinks.append(
            RealTimeSink(servo_sink, ahead=SERVO_LOOKAHEAD, delay=BUS_DELAY, estimate=estimate, learner=learner)
        )
    if "face" in sinks:
        from kinesic.face.show.preview import Preview  # noqa: PLC0415 - slow to import, and rarely used

        real_time_sinks.append(RealTimeSink(Preview(robot)))
    return real_time_sinks


async def _serve(
    server: AbstractAsyncContextManager[Serving],
    sinks: Sequence[RealTimeSink],
    memory: ServoMemory,
    announce: Callable[[Address], None],
    standard_input: StandardInput,
    *,
    source: SampleSource | None,
) -> int:
    end_requested = asyncio.Event()

    def end() -> None:
        detach_closed_terminal()
        if not end_requested.is_set() and any(isinstance(each.sink, RealServos) for each in sinks):
            click.echo("folding to rest, then the torque is switched off", err=True)
        end_requested.set()

    async with AsyncExitStack() as closing:
        with show_stages() as stage:
            stage("starting the planner")
            serving = await closing.enter_async_context(server)
            freeze_heap()
        for number in (number for number in ENDING_SIGNALS if signal.getsignal(number) is not signal.SIG_IGN):
            asyncio.get_running_loop().add_signal_handler(number, end)
        place = f"listening at {serving.address}" if serving.address is not None else "reading standard input"
        click.echo(f"{place}; Ctrl-C folds to rest and ends", err=True)
        if serving.address is not None:
            announce(serving.address)
        listener = None if source is None else hear_people(serving.clients.session, source)
        report_task = asyncio.create_task(_report_servos(sinks, memory))
        is_read = standard_input.console is not None or not sys.stdin.isatty()
        await serve_until_done(
            serving,
            end_requested,
            console=is_read,
            ends_with_input=standard_input.ends_server,
            make_console=standard_input.console or Console,
        )
        report_task.cancel()
        if listener is not None:
            listener.end()
    session = serving.clients.session
    if session.loop.error is not None:
        click.echo(f"kinesic: {session.loop.error}", err=True)
    return FAULT_EXIT_CODE if session.loop.has_failed or session.planner.has_failed else 0


async def _report_servos(sinks: Sequence[RealTimeSink], memory: ServoMemory) -> None:
    """Report lost events and newly learned servo parameters, and store the parameters."""
    servos = [real_time_sink.sink for real_time_sink in sinks if isinstance(real_time_sink.sink, RealServos)]
    reported: list[Identification] = []
    while True:
        for servo_sink in servos:
            warn_of_lost_events(servo_sink.servos.events())
        for identification in (
            sink.lesson for sink in sinks if sink.lesson is not None and sink.lesson not in reported
        ):
            reported.append(identification)
            try:
                print_learned_factors(identification, memory.keep(identification), to_stderr=True)
            except ConfigError as error:  # The disk may be full or the folder deleted; the robot continues.
                click.echo(f"kinesic: {error}", err=True)
        await asyncio.sleep(SERVO_POLL_PERIOD)
