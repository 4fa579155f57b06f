"""Evaluation of robot designs: body, statics and performance of documents."""

import hashlib
from collections.abc import Callable
from dataclasses import dataclass

from kinesic.bml.block import BmlError
from kinesic.body.config import ConfigError, locate_config
from kinesic.body.robot import Robot
from kinesic.body.robot_extension import read_robot
from kinesic.body.robot_schema import RobotFile
from kinesic.controller.dry_run import dry_run
from kinesic.metrics.dry_run import DryRun
from kinesic.planning.setup import Setup
from kinesic.planning.workspace import find_workspace
from kinesic.report.checks import checks
from kinesic.report.checks.twin import stroke_errors
from kinesic.session.plan import plan
from kinesic.session.setup import set_up
from kinesic.sim.robot_check import RobotCheck, check_robot
from kinesic.studies.designs.variant import Design, build

MAX_TORQUE_RATIO = 0.8  # torque / stall torque above which a servo yields or overheats, as in reports
MISSING_STROKE_ERROR = 1.0  # [s] error counted for a stroke that never arrived


@dataclass(frozen=True)
class BodyFigures:
    """Price, mass, arm length, torque and reach of a robot design."""

    price: float | None  # [US$] of all servos; None: a price is unknown
    mass: float  # [kg] moving mass
    arm_length: float  # [m]
    torque: float  # largest static torque / stall torque over all joints and postures
    hinge: str  # joint with this ratio
    sectors: int  # sectors of gesture space within reach of the left hand, torso upright


@dataclass(frozen=True)
class DocumentFigures:
    """Stroke timing errors and violations of one document in the twin."""

    file: str
    strokes: int
    late: float  # [s] absolute error to the requested times, summed over strokes
    worst: float  # [s] absolute error of the worst stroke
    violations: tuple[str, ...]  # failed checks, dropped behaviours, or the reason of a refusal


@dataclass(frozen=True)
class DesignTask:
    """A robot design with the documents to perform.

    Without documents, only its body is evaluated.
    """

    design: Design
    documents: tuple[tuple[str, bytes], ...]  # name and content; workers need no access to the documents' folder
    settings: str  # everything else that affects the result

    @property
    def key(self) -> str:
        """Key of the design's result in the journal."""
        digest = hashlib.blake2b(repr((self.design, self.settings)).encode(), digest_size=16)
        for name, content in self.documents:
            digest.update(name.encode() + b"\0" + hashlib.blake2b(content).digest())
        return digest.hexdigest()


@dataclass(frozen=True)
class Trial:
    """Measured results of one robot design."""

    design: Design
    out: str = ""  # reason of its rejection; empty if it can be built and holds itself
    body: BodyFigures | None = None  # None: cannot be built
    documents: tuple[DocumentFigures, ...] = ()

    @property
    def lateness(self) -> float:
        """Mean absolute timing error of the design's strokes [s]."""
        return sum(one.late for one in self.documents) / max(1, sum(one.strokes for one in self.documents))

    @property
    def worst(self) -> float:
        """Largest absolute timing error of a stroke of the design [s]."""
        return max((one.worst for one in self.documents), default=0.0)

    @property
    def violations(self) -> int:
        """Number of failed checks, dropped behaviours and refused documents."""
        return sum(len(one.violations) for one in self.documents)


def prepare_trials(robot: str, style: str) -> Callable[[DesignTask], Trial]:
    """Read a robot file and return the function that tries its designs.

    The function caches the setup of the last design.
    """
    path = locate_config("robot", robot)
    file = read_robot(path, RobotFile)
    cached_setup: dict[Design, Setup] = {}

    def do(task: DesignTask) -> Trial:
        if task.design not in cached_setup:
            cached_setup.clear()
            try:
                body = build(file, task.design, path)
            except ConfigError as error:
                return Trial(task.design, str(error))
            cached_setup[task.design] = set_up(body, style=style)
        setup = cached_setup[task.design]
        if not task.documents:
            return weigh(task.design, setup.robot)
        return Trial(task.design, documents=tuple(_perform(name, content, setup) for name, content in task.documents))

    return do


def weigh(design: Design, robot: Robot) -> Trial:
    """Evaluate a robot design's body: price, mass, statics and reach.

    A design that collides at rest or cannot hold itself is rejected with a reason.
    """
    result = check_robot(robot)
    hinge = int(result.worst_ratios.argmax())
    models = [(mount.drive.servo.price_usd, mount.drive.count) for mount in robot.mounts]
    setup = [price * count for price, count in models if price is not None]
    body = BodyFigures(
        price=sum(setup) if len(setup) == len(models) else None,
        mass=result.moving_mass,
        arm_length=robot.arm_length,
        torque=float(result.worst_ratios[hinge]),
        hinge=robot.skeleton.names[hinge],
        sectors=len(find_workspace(robot).reached),
    )
    return Trial(design, _fault(robot, result, body), body)


def _fault(robot: Robot, result: RobotCheck, body: BodyFigures) -> str:
    least = robot.min_clearance
    if result.rest_gap.distance < least:
        a, b = result.rest_gap.pair
        gap = f"{1000 * result.rest_gap.distance:.0f} mm"
        return f"it collides: at rest {a} and {b} are {gap} apart; at least {1000 * least:.0f} mm are required"
    if body.torque > MAX_TORQUE_RATIO:
        need = f"{body.hinge} needs {body.torque:.2f} of its stall torque"
        return f"it does not hold itself: {need}; the limit is {MAX_TORQUE_RATIO:g}"
    return ""


def _perform(name: str, content: bytes, setup: Setup) -> DocumentFigures:
    try:
        performance = dry_run(plan(content, setup, source=name))
    except BmlError as error:
        return DocumentFigures(name, 0, 0.0, 0.0, (str(error),))
    errors = [MISSING_STROKE_ERROR if error is None else abs(error) for error, _ in stroke_errors(performance)]
    return DocumentFigures(name, len(errors), sum(errors), max(errors, default=0.0), tuple(_violations(performance)))


def _violations(performance: DryRun) -> list[str]:
    failed = [check.name for check in checks(performance) if check.status == "fail"]
    outcomes = performance.plan.keyframes.outcomes
    return failed + [
        f"{name} dropped: {outcome.why}" for name, outcome in outcomes.items() if outcome.kind == "dropped"
    ]
