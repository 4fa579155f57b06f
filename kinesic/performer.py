"""The front door: `Performer` plans documents for a robot in a style, performs and reports them."""

import warnings
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Literal, Unpack, get_args

from kinesic.bml.block import BmlError
from kinesic.body.choices import Terms
from kinesic.body.command import Sink
from kinesic.body.config import ConfigError, suggestion
from kinesic.body.robot import Robot
from kinesic.controller.documents import read_block
from kinesic.controller.feedforward import FeedForward
from kinesic.controller.options import LIVELY, PlanningOptions
from kinesic.controller.perform import dry_runs, set_up
from kinesic.controller.perform import perform as perform_text
from kinesic.controller.play import command_times, commands, play_together
from kinesic.expressivity.style.style import Style
from kinesic.planning.bap import SUFFIX, read_bap
from kinesic.planning.face_track import faces
from kinesic.planning.imported_motion import plan_imported
from kinesic.planning.plan import Plan, plan_block
from kinesic.planning.setup import Setup
from kinesic.sim.servo_factors import NOMINAL, TWINS, Factors, TwinName

if TYPE_CHECKING:
    from kinesic.controller.servo_performance import ServoRun
    from kinesic.report.run import Performance

DocumentSource = str | bytes | Path  # a path, or BML text
On = Literal["twin", "servos"]


class Performer:
    """A robot in a style: plans documents, performs them, and reports.

    Example:
        ```python
        performer = kinesic.Performer("upper22", style="joyful")
        run = performer.perform(performer.plan("greeting.bml"))
        run.report("out/greeting")
        ```

    Attributes:
        setup: everything that planning knows beside the documents.
    """

    def __init__(
        self,
        robot: Robot | str | Path = "upper22",
        *,
        style: Style | str | Path = "neutral",
        **options: Unpack[PlanningOptions],
    ) -> None:
        """Loads robot and manner.

        Args:
            robot: its name, or its TOML file.
            style: its name, or its TOML file.
            options: settings, lexicon, dialect, gather, idle, variation, seed, voice, pause, targets, character; what
                each says stands in `kinesic.controller.options.PlanningOptions`. Unless told otherwise, it idles, and
                gestures vary.

        Raises:
            ConfigError: something is missing or wrong; says what would have worked.
            TypeError: there is no such option.
        """
        self.setup = set_up(robot, style=style, **(LIVELY | options))

    @property
    def robot(self) -> Robot:
        """The robot that performs."""
        return self.setup.robot

    @property
    def style(self) -> Style:
        """The style in which it performs."""
        return self.setup.style

    def plan(self, document: DocumentSource, *, source: str | None = None) -> Plan:
        """Plans a document; nothing moves.

        Args:
            document: a path (BML, or a .bap motion), or BML text.
            source: its name in messages and reports; the path, where it is one.

        Raises:
            BmlError: the document is refused, or there is no such file.
            ConfigError: a motion's file is wrong.
        """
        text, name = _read(document)
        name = source or name
        if text is None:
            return plan_imported(read_bap(Path(str(document)), self.robot), self.setup, source=name)
        return plan_block(read_block(text, self.setup, source=name), self.setup)

    def perform(
        self,
        plan: Plan | DocumentSource,
        *,
        on: On = "twin",
        ports: Mapping[str, str | Path] | None = None,
        sinks: Sequence[Sink] = (),
        twin: TwinName | Factors = "nominal",
        feedforward: Terms = "full",
        correction: bool = True,
        believed: Factors | None = None,
    ) -> "Performance":
        """Performs in the twin; then in sinks of one's own, and on the servos, if they are requested.

        Servos move only where no check of the twin has failed (`run.servos` is None otherwise). Ctrl-C folds them to
        rest.

        Args:
            plan: or a document, which is planned first.
            on: whether servos perform too.
            ports: path of the device by the name of each bus of the robot, for servos.
            sinks: each gets every command, as fast as it takes them, and is closed at the end.
            twin: how far the twin is from the robot's description.
            feedforward: what of the servos' model is inverted, for the twin and sinks; servos are led with "full".
            correction: whether goals in the twin are corrected by what it measures.
            believed: how the servos are believed to be, by which goals lead; None: as the twin's where its factors are
                given, as this very robot's, else as data sheets say.

        Raises:
            BmlError: the document is refused.
            BusError: a port or a servo is missing or wrong; nothing has moved.
            ConfigError: there is no such way to perform.
            TypeError: a sink cannot `write` or `close`.
        """
        from kinesic.report.run import performance_of  # noqa: PLC0415 - who only plans starts sooner

        _check_way(on, twin, sinks)
        if on == "servos" and feedforward != "full":
            raise ConfigError(
                f"feedforward is {feedforward!r}: servos are led with 'full' alone, as their dry run is then"
            )
        planned = plan if isinstance(plan, Plan) else self.plan(plan)
        if on == "servos":
            _check_ports(planned.setup.robot, ports or {})
        factors = (twin,) if isinstance(twin, Factors) else TWINS[twin]
        if believed is None:
            believed = twin if isinstance(twin, Factors) else NOMINAL
        found, *beside = dry_runs(planned, factors, feedforward=feedforward, correction=correction, believed=believed)
        run = performance_of(found, beside=tuple(beside), seed=planned.setup.idling.seed)
        if sinks:
            _play(planned, sinks, believed, feedforward)
        if on == "servos" and run.ok:
            live = _perform_on_servos(run, ports or {})
            run = performance_of(found, beside=tuple(beside), seed=planned.setup.idling.seed, servos=live)
        return run

    def report(
        self, done: "Performance | Plan | DocumentSource", folder: str | Path, *, film: bool = True
    ) -> "Performance":
        """Writes the report of a performance; what is not performed yet is performed in the twin first.

        Raises:
            BmlError: the document is refused.
            ConfigError: something else than a report is in the folder.
        """
        run = self.perform(done) if isinstance(done, Plan | str | bytes | Path) else done
        run.report(folder, film=film)
        return run

    def __repr__(self) -> str:
        return f"Performer({self.robot.name!r}, style={self.style.name!r})"


def perform(
    text: str | bytes,
    known: Setup | None = None,
    *,
    source: str = "<text>",
    twin: Factors = NOMINAL,
    feedforward: Terms = "full",
    correction: bool = True,
) -> "Performance":
    """Plans a BML document and performs it in the twin.

    Raises:
        BmlError: the document is refused.
    """
    from kinesic.report.run import performance_of  # noqa: PLC0415 - as above

    run = perform_text(text, known, source=source, twin=twin, feedforward=feedforward, correction=correction)
    return performance_of(run, seed=run.plan.setup.idling.seed)


def _read(document: DocumentSource) -> tuple[str | bytes | None, str]:
    """Reads text and name of a document; no text of a motion.

    Raises:
        BmlError: there is no such file, or it cannot be read.
    """
    if isinstance(document, bytes) or (isinstance(document, str) and document.lstrip("\ufeff \t\r\n")[:1] in "<{["):
        return document, "<text>"
    path = Path(document)
    if path.suffix.lower() == SUFFIX:
        return None, str(path)
    try:
        return path.read_bytes(), str(path)
    except OSError as error:
        raise BmlError(f"{path}: {error.strerror}; give a path, or BML text that begins with <") from None
    except ValueError as error:
        raise BmlError(f"{str(path)!r}: {error}; give a path, or BML text that begins with <") from None


def _check_way(on: str, twin: object, sinks: Sequence[object]) -> None:
    if on not in get_args(On):
        raise ConfigError(f"on is {on!r}{suggestion(on, get_args(On))}")
    if not isinstance(twin, Factors) and twin not in TWINS:
        raise ConfigError(f"twin is {twin!r}{suggestion(str(twin), list(TWINS))}")
    for sink in sinks:
        missing = [name for name in ("write", "close") if not callable(getattr(sink, name, None))]
        if missing:
            raise TypeError(f"a sink needs write(command) and close(); {type(sink).__name__} lacks {missing[0]}")


def _check_ports(robot: Robot, ports: Mapping[str, str | Path]) -> None:
    from kinesic.hardware.servos import check_ports  # noqa: PLC0415 - who has no servos starts sooner
    from kinesic.hardware.supervisor.manifest import Manifest  # noqa: PLC0415

    check_ports(robot, Manifest.of(robot), ports)


def _perform_on_servos(run: "Performance", ports: Mapping[str, str | Path]) -> "ServoRun":
    """Performs on the servos what the twin has performed, with its voice; Ctrl-C ends it."""
    from kinesic.controller.servo_performance import interrupted, perform_live  # noqa: PLC0415 - as above
    from kinesic.controller.soundtrack import speak_along  # noqa: PLC0415
    from kinesic.hardware.servos import Servos  # noqa: PLC0415

    with speak_along(run.plan, _warn) as said:
        servos = Servos(run.plan.setup.robot, ports)
        with interrupted() as stopped:
            return perform_live(run, servos, requested=lambda: "end" if stopped() else "go on", shown=said)


def _play(plan: Plan, sinks: Sequence[Sink], believed: Factors, terms: Terms) -> None:
    """Hands every command of a plan, with the face, to all sinks."""
    times, known = command_times(plan.duration), plan.setup
    setpoints = FeedForward.of(known.robot, known.dynamics, believed, terms=terms).lead(plan.trajectory, times)
    stream = commands(plan.trajectory, times, setpoints, faces(plan, times))
    play_together(((command,) * len(sinks) for command in stream), sinks)


def _warn(line: str) -> None:
    warnings.warn(line, stacklevel=8)  # of who called `perform`
