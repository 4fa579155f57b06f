"""Main interface for Python programs: plan, perform and report documents."""

import warnings
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Literal, Unpack, get_args

from kinesic.body.choices import InvertedTerms
from kinesic.body.command import Sink
from kinesic.body.config import ConfigError, suggestion
from kinesic.body.robot import Robot
from kinesic.controller.dry_run import dry_run, dry_runs
from kinesic.controller.feedforward import FeedForward
from kinesic.controller.play import commands, play_together
from kinesic.expressivity.lexicon.lexicon import Lexicon
from kinesic.expressivity.style.style import Style
from kinesic.host import SERVO_DRIVER
from kinesic.planning.face_track import compute_faces
from kinesic.planning.plan import Plan
from kinesic.planning.setup import Setup
from kinesic.session.options import INTERACTIVE_DEFAULTS, PlanningOptions
from kinesic.session.plan import DocumentSource, plan, plan_document
from kinesic.session.setup import set_up
from kinesic.sim.servo_factors import NOMINAL_FACTORS, TWIN_FACTORS, Factors, TwinName

if TYPE_CHECKING:
    from kinesic.metrics.servo_run import ServoRun
    from kinesic.report.run import Performance

On = Literal["twin", "servos"]


class Performer:
    """Planning, performance and reports of BML documents by one robot and style.

    Example:
        ```python
        performer = kinesic.Performer("upper22", style="joyful")
        run = performer.perform(performer.plan("greeting.bml"))
        run.report("out/greeting")
        ```

    Attributes:
        setup: robot, style and all other inputs of planning except documents.
    """

    def __init__(
        self,
        robot: Robot | str | Path = "upper22",
        *,
        style: Style | str | Path = "neutral",
        **options: Unpack[PlanningOptions],
    ) -> None:
        """Load a robot and a style.

        Args:
            robot: name of the robot, or path of its TOML file.
            style: name of the style, or path of its TOML file.
            options: settings, lexicon, dialect, gather, idle, variation, seed, voice, pause, targets, character; see
                `kinesic.session.options.PlanningOptions`. The defaults are those of the command line: the robot
                idles, gestures vary, and the voice is `auto`. The silent voice `durations` has the same times on
                every machine.

        Raises:
            ConfigError: a file is missing or a value is invalid; the message names valid values.
            TypeError: an option is unknown.
        """
        self.setup = set_up(robot, style=style, **(INTERACTIVE_DEFAULTS | options))

    @property
    def robot(self) -> Robot:
        """Robot that performs."""
        return self.setup.robot

    @property
    def style(self) -> Style:
        """Style of the performance."""
        return self.setup.style

    @property
    def lexicon(self) -> Lexicon:
        """Gesture lexicon, searched by `performer.lexicon.find("wave")`."""
        return self.setup.lexicon

    def plan(self, document: DocumentSource, *, source: str | None = None) -> Plan:
        """Plan a document without moving.

        Args:
            document: path (BML, or a .bap motion), name of a built-in document, or BML text.
            source: name in messages and reports; default is the path.

        Raises:
            BmlError: the document is refused, or the file does not exist.
            ConfigError: the motion file is invalid.
        """
        return plan_document(document, self.setup, source=source)

    def perform(
        self,
        plan: Plan | DocumentSource,
        *,
        on: On = "twin",
        ports: Mapping[str, str | Path] | None = None,
        sinks: Sequence[Sink] = (),
        twin: TwinName | Factors = "nominal",
        feedforward: InvertedTerms = "full",
        correction: bool = True,
        believed: Factors | None = None,
    ) -> "Performance":
        """Perform a plan in the twin, optionally on sinks and servos.

        Servos move only if all checks of the twin passed; otherwise `run.servos` is None. Ctrl-C folds them to rest.

        Args:
            plan: plan, or a document that is planned first.
            on: "servos" to perform on the servos, too.
            ports: device path of each bus of the robot by name, for servos.
            sinks: additional sinks; each receives every command as fast as it accepts them and is closed at the end.
            twin: deviations of the twin from the robot's description.
            feedforward: terms of the inverse servo model, for the twin and sinks; servos need "full".
            correction: whether setpoints of the twin are corrected by its measured tracking errors.
            believed: estimated servo parameters for the feed-forward. Default are the twin's own if its factors are
                given, else those of the data sheets.

        Raises:
            BmlError: the document is refused.
            BusError: a port or servo is missing or wrong; nothing has moved.
            ConfigError: an option is invalid.
            TypeError: a sink has no `write` or `close` method.
        """
        from kinesic.report.run import performance_of  # noqa: PLC0415 - faster start without performing

        _check_options(on, twin, sinks)
        if on == "servos" and feedforward != "full":
            raise ConfigError(
                f"feedforward is {feedforward!r}: servos accept only 'full', with which their dry run is computed"
            )
        planned = plan if isinstance(plan, Plan) else self.plan(plan)
        if on == "servos":
            SERVO_DRIVER.require()
            _check_ports(planned.setup.robot, ports or {})
        factors = (twin,) if isinstance(twin, Factors) else TWIN_FACTORS[twin]
        if believed is None:
            believed = twin if isinstance(twin, Factors) else NOMINAL_FACTORS
        first_run, *other_runs = dry_runs(
            planned, factors, feedforward=feedforward, correction=correction, believed=believed
        )
        run = performance_of(first_run, other_runs=tuple(other_runs), seed=planned.setup.idling.seed)
        if sinks:
            _play(planned, sinks, believed, feedforward)
        if on == "servos" and run.ok:
            live = _perform_on_servos(run, ports or {})
            run = performance_of(first_run, other_runs=tuple(other_runs), seed=planned.setup.idling.seed, servos=live)
        return run

    def report(
        self, done: "Performance | Plan | DocumentSource", folder: str | Path, *, film: bool = True
    ) -> "Performance":
        """Write the report of a performance.

        Perform it in the twin first if needed.

        Raises:
            BmlError: the document is refused.
            ConfigError: the folder contains other files than a report.
        """
        run = self.perform(done) if isinstance(done, Plan | str | bytes | Path) else done
        run.report(folder, film=film)
        return run

    def __repr__(self) -> str:
        return f"Performer({self.robot.name!r}, style={self.style.name!r})"


def perform(
    text: str | bytes,
    setup: Setup | None = None,
    *,
    source: str = "<text>",
    twin: Factors = NOMINAL_FACTORS,
    feedforward: InvertedTerms = "full",
    correction: bool = True,
) -> "Performance":
    """Plan a BML document and perform it in the twin.

    Raises:
        BmlError: the document is refused.
    """
    from kinesic.report.run import performance_of  # noqa: PLC0415 - as above

    planned = plan(text, setup, source=source)
    run = dry_run(planned, twin=twin, feedforward=feedforward, correction=correction)
    return performance_of(run, seed=run.plan.setup.idling.seed)


def _check_options(on: str, twin: object, sinks: Sequence[object]) -> None:
    if on not in get_args(On):
        raise ConfigError(f"on is {on!r}{suggestion(on, get_args(On))}")
    if not isinstance(twin, Factors) and twin not in TWIN_FACTORS:
        raise ConfigError(f"twin is {twin!r}{suggestion(str(twin), list(TWIN_FACTORS))}")
    for sink in sinks:
        missing = [name for name in ("write", "close") if not callable(getattr(sink, name, None))]
        if missing:
            raise TypeError(f"a sink needs write(command) and close(); {type(sink).__name__} lacks {missing[0]}")


def _check_ports(robot: Robot, ports: Mapping[str, str | Path]) -> None:
    from kinesic.hardware.servos import check_ports  # noqa: PLC0415 - faster start without servos
    from kinesic.hardware.supervisor.manifest import Manifest  # noqa: PLC0415

    check_ports(robot, Manifest.of(robot), ports)


def _perform_on_servos(run: "Performance", ports: Mapping[str, str | Path]) -> "ServoRun":
    """Repeat a twin performance on the servos, together with its speech.

    Ctrl-C ends it.
    """
    from kinesic.controller.servo_performance import catch_interrupts, perform_live  # noqa: PLC0415 - as above
    from kinesic.controller.slow_moves import settings_near_people  # noqa: PLC0415
    from kinesic.controller.soundtrack import speak_along  # noqa: PLC0415
    from kinesic.hardware.servos import Servos  # noqa: PLC0415

    with speak_along(run.plan, _warn) as playback:
        servos = Servos(run.plan.setup.robot, ports, settings=settings_near_people(run.plan.setup))
        with catch_interrupts() as stopped:
            return perform_live(run, servos, requested=lambda: "end" if stopped() else "go on", shown=playback)


def _play(plan: Plan, sinks: Sequence[Sink], believed: Factors, terms: InvertedTerms) -> None:
    """Send all commands of a plan, faces included, to all sinks."""
    times, setup = plan.command_times, plan.setup
    setpoints = FeedForward.of(setup.robot, setup.dynamics, believed, terms=terms).compute_setpoints(
        plan.trajectory, times
    )
    stream = commands(plan.trajectory, times, setpoints, compute_faces(plan, times))
    play_together(((command,) * len(sinks) for command in stream), sinks)


def _warn(line: str) -> None:
    warnings.warn(line, stacklevel=8)  # location of the call of `perform`
