"""Verb `kinesic servos accept`: the owner's acceptance test of a robot.

Its report expires when the robot changes.
"""

from collections.abc import Iterable
from datetime import UTC, datetime
from math import inf
from pathlib import Path
from typing import TypeVar

import click
import msgspec

from kinesic.body.config import ConfigError
from kinesic.body.robot import Robot
from kinesic.cli.doctor import count_servo_faults
from kinesic.cli.servos.ports import open_ports, read_all_ports
from kinesic.files.output_file import check_file, write_text
from kinesic.hardware.protocol.servo_map import load_robot
from kinesic.hardware.supervisor.manifest import Manifest
from kinesic.hardware.tools.survey import survey
from kinesic.metrics.acceptance import (
    Step,
    fingerprint_gains,
    fingerprint_limbs,
    list_manual_steps,
    list_measured_steps,
)
from kinesic.report.impacts import IMPACT_DISCLAIMER
from kinesic.report.run import SERVO_LOG_NAME
from kinesic.sim.log import read_log
from kinesic.version import __version__

FAILED_EXIT_CODE = 1  # exit code if a step is not passed, or a report has expired
FORCE_CHECK = "safety.force"  # name of the check of contact forces in report.json
MAX_REPORT_SIZE = 50_000_000  # [bytes] largest file that is read
Content = TypeVar("Content")  # type of a JSON file


class PerformedCheck(msgspec.Struct):
    """One check in a performance's report.json."""

    name: str
    value: float | None


class WorstEnergy(msgspec.Struct):
    """Largest contact energy in a performance's report.json."""

    energy_j: float
    segment: str
    at_s: float


class ForceLimit(msgspec.Struct):
    """Planned contact force on one body part, and its limit."""

    force_n: float
    limit_n: float | None


class PlannedContact(msgspec.Struct):
    """Planned contacts with people in a performance's report.json."""

    near: str
    source: str | None
    forces: dict[str, ForceLimit]
    energy: WorstEnergy


class ServoEnding(msgspec.Struct):
    """End of a servo performance in report.json."""

    ending: str


class PerformedReport(msgspec.Struct):
    """Part of report.json that the acceptance test needs."""

    robot: str
    input: str
    checks: list[PerformedCheck]
    contact: PlannedContact | None = None
    servos: ServoEnding | None = None


class TestedServo(msgspec.Struct, frozen=True):
    """Servo of the robot in the acceptance test."""

    bus: str
    id: int
    hinge: str
    model: str
    firmware: int


class TestedRobot(msgspec.Struct, frozen=True):
    """Properties of a robot whose changes make a report expire."""

    name: str
    limbs: str  # hash of masses, inertias and positions
    gains: str  # hash of the position gains
    servos: tuple[TestedServo, ...]


class StepResult(msgspec.Struct, frozen=True):
    """Measured value of one test step, and its largest passed value."""

    name: str
    instruction: str
    value: float | None  # measured value; None: skipped
    bound: float  # largest value that passes
    ratio: float | None  # value / bound; None: skipped, or the bound is 0
    unit: str
    passed: bool


class AcceptanceReport(msgspec.Struct, frozen=True):
    """Content of the file that `kinesic servos accept` writes."""

    kinesic: str
    date: str
    person: str
    performance: str
    near: str
    limits: str | None
    robot: TestedRobot
    passed: bool
    steps: tuple[StepResult, ...]
    note: str = IMPACT_DISCLAIMER


def accept_robot(source: Path, robot: str, ports: tuple[str, ...], person: str, out: Path, force: bool) -> int:
    """Run the acceptance test, or check an earlier report against the robot."""
    loaded = load_robot(robot)
    if source.is_file():
        return _print_expiry(_read(source, AcceptanceReport), _describe_robot(loaded, ports))
    performed = _read(source / "report.json", PerformedReport)
    contact = _require_policy(performed, loaded.name, source)
    check_file(out, force=force)
    planned, measured = read_log(source / "measured.npz", loaded), read_log(source / SERVO_LOG_NAME, loaded)
    ratio = next((check.value for check in performed.checks if check.name == FORCE_CHECK), None)
    faults = count_servo_faults(loaded, ports)
    tested = _describe_robot(loaded, ports)
    energy = contact.energy
    manual_steps = list_manual_steps(
        loaded, energy=energy.energy_j, segment=energy.segment, time=energy.at_s, planned=planned
    )
    measured_steps = list_measured_steps(
        loaded, faults=faults, force_ratio=inf if ratio is None else ratio, planned=planned, measured=measured
    )
    name = person or click.prompt("Name of the person who measures", err=True)
    results = tuple(_evaluate(step) for step in (*measured_steps, *manual_steps))
    report = AcceptanceReport(
        kinesic=__version__,
        date=datetime.now(UTC).isoformat(timespec="seconds"),
        person=name,
        performance=performed.input,
        near=contact.near,
        limits=contact.source,
        robot=tested,
        passed=all(result.passed for result in results),
        steps=results,
    )
    write_text(out, msgspec.json.format(msgspec.json.encode(report), indent=1).decode() + "\n", force=force)
    _print_verdict(report, contact)
    click.echo(out)
    return 0 if report.passed else FAILED_EXIT_CODE


def _read(path: Path, kind: type[Content]) -> Content:
    """Read a JSON file.

    Raises:
        ConfigError: the file is missing, too large, or has other content.
    """
    try:
        if path.stat().st_size > MAX_REPORT_SIZE:
            raise ConfigError(f"{path}: has more than {MAX_REPORT_SIZE // 1_000_000} MB")
        return msgspec.json.decode(path.read_bytes(), type=kind)
    except OSError as error:
        raise ConfigError(f"{path}: {error.strerror}") from None
    except (msgspec.DecodeError, UnicodeDecodeError) as error:
        raise ConfigError(f"{path}: {error}") from None


def _require_policy(performed: PerformedReport, robot: str, source: Path) -> PlannedContact:
    """Return a performance's contacts with people, if suitable for the test.

    Raises:
        ConfigError: another robot performed, without servos, not to its end, or without a policy.
    """
    if performed.robot != robot:
        raise ConfigError(f"{source}: {performed.robot} performed, not {robot}; give --robot {performed.robot}")
    if performed.servos is None or performed.servos.ending != "performed":
        raise ConfigError(f"{source}: servos did not perform to the end; repeat it with --on servos")
    if performed.contact is None or performed.contact.near == "nobody":
        raise ConfigError(f"{source}: performed without a policy; repeat it with --near adult or --near child")
    return performed.contact


def _describe_robot(robot: Robot, ports: tuple[str, ...]) -> TestedRobot:
    """Read models and firmware of all servos, and describe limbs and gains."""
    manifest = Manifest.of(robot)
    with open_ports(manifest, read_all_ports(ports, manifest.bauds)) as wires:
        servos = tuple(
            TestedServo(servo.member.bus, servo.member.id, servo.member.hinge, servo.model_name, servo.firmware)
            for servo in survey(manifest, wires)
        )
    return TestedRobot(robot.name, fingerprint_limbs(robot), fingerprint_gains(manifest), servos)


def _evaluate(step: Step) -> StepResult:
    """Evaluate a step, print it and return its result.

    The owner enters a value that is not measured.
    """
    value = _ask(step) if step.value is None else step.value
    is_passed = value is not None and value <= step.bound
    ratio = value / step.bound if value is not None and step.bound > 0.0 else None
    mark = (
        click.style("pass", fg="green") if is_passed else click.style("fail" if value is not None else "open", fg="red")
    )
    shown = "skipped" if value is None else f"{value:.3g}"
    what = f" ({step.instruction})" if step.value is not None else ""
    click.echo(f"{mark}  {step.name:10} {shown}, at most {step.bound:.3g} {step.unit}{what}")
    return StepResult(step.name, step.instruction, value, step.bound, ratio, step.unit, is_passed)


def _ask(step: Step) -> float | None:
    """Ask for a measured value, or return None for a skipped step."""
    click.echo(f"{step.name}: {step.instruction}", err=True)
    return click.prompt(
        f"Value in {step.unit} (Enter skips)", default="", show_default=False, value_proc=_parse_value, err=True
    )


def _parse_value(text: str) -> float | None:
    """Parse a finite, non-negative value, or return None without text."""
    if not text.strip():
        return None
    try:
        value = float(text)
    except ValueError:
        value = -1.0
    if not 0.0 <= value < inf:
        raise click.BadParameter("give a number that is not negative, or press Enter")
    return value


def _print_verdict(report: AcceptanceReport, contact: PlannedContact) -> None:
    """Print the result of the test and the planned forces."""
    for region, force in contact.forces.items():
        if force.limit_n is not None:
            part = region.replace("_", " ")
            click.echo(f"Planned motion: at most {force.force_n:.0f} N on a free {part} (model; policy {report.near}).")
    open_steps = [result.name for result in report.steps if not result.passed]
    click.echo(f"not passed: {', '.join(open_steps)}" if open_steps else "The robot is as its model within all bounds.")
    click.echo(report.note)


def _print_expiry(report: AcceptanceReport, present: TestedRobot) -> int:
    """Print whether a report still holds for this robot."""
    changes = list(_find_changes(report.robot, present))
    for change in changes:
        click.echo(f"expired: {change}")
    if not report.passed:
        click.echo("the test was not passed")
    if not changes:
        click.echo(f"robot as tested on {report.date} by {report.person}")
    click.echo(report.note)
    return FAILED_EXIT_CODE if changes or not report.passed else 0


def _find_changes(tested: TestedRobot, present: TestedRobot) -> Iterable[str]:
    """Yield the differences that make a report expire."""
    if tested.name != present.name:
        yield f"the report is of {tested.name}, not {present.name}"
        return
    if tested.limbs != present.limbs:
        yield "the limbs have other masses or lengths"
    if tested.gains != present.gains:
        yield "the servos have other gains"
    earlier = {(servo.bus, servo.id): servo for servo in tested.servos}
    for servo in present.servos:
        before = earlier.get((servo.bus, servo.id))
        if before != servo:
            old = "no servo" if before is None else f"{before.model} with firmware {before.firmware}"
            new = f"{servo.model} with firmware {servo.firmware}" if servo.model else "no answer"
            yield f"servo {servo.id} ({servo.hinge}): {old} -> {new}"
