"""Verbs `kinesic robots`: list, show, check and import robots."""

from pathlib import Path

import click
import numpy as np

from kinesic.body.config import CONFIGS
from kinesic.body.robot import Robot
from kinesic.cli.extras import explain_missing
from kinesic.cli.progress import show_stages
from kinesic.cli.screen.table import Table
from kinesic.cli.terminal import console, quote_text
from kinesic.files.output_file import check_file, new_file, write_text
from kinesic.hardware.protocol.servo_map import ServoMap, load_robot
from kinesic.hardware.supervisor.manifest import Manifest
from kinesic.hardware.supervisor.settings import DEFAULT_SETTINGS
from kinesic.hardware.supervisor.wiring_check import compute_bus_loads, find_supply_faults
from kinesic.sim.importer.apart.imported import ImportedRobot, import_apart
from kinesic.sim.shells.shell import SHELL_SUFFIX, is_stale, load_shell
from kinesic.sim.shells.variant import find_shell

WARN_TORQUE_RATIO = 0.4  # holding torque / stall torque above which a hinge gets a warning
TORQUE_COLOURS = {"pass": "", "warn": "yellow", "fail": "red"}  # verdict on a torque ratio -> its colour
FAIL_TORQUE_RATIO = 0.8  # holding torque / stall torque above which a hinge fails the check
PICTURE_SUFFIX = ".mapping.png"  # suffix of the picture of an imported robot's joint mapping
MAX_PRINTED_NOTES = 5  # largest number of printed notes of one kind about an import


def list_robots() -> int:
    """Print the names of the robots that come with kinesic."""
    for path in sorted((CONFIGS / "robots").glob("*.toml")):
        click.echo(path.stem)
    return 0


def show_robot(robot: str) -> int:
    """Print range, servo and limits of every hinge of a robot."""
    robot_model = load_robot(robot)
    table = Table("hinge", "range deg", "rest deg", "servo", "reduction", "stall Nm", "speed limit rad/s")
    for hinge, drive, velocity in zip(
        robot_model.skeleton.hinges, robot_model.drives, robot_model.velocity_limits, strict=True
    ):
        low, high, rest = np.degrees([hinge.lower, hinge.upper, hinge.rest])
        servo = drive.servo.name if drive.count == 1 else f"{drive.count} x {drive.servo.name}"
        cells = f"{low:.0f}..{high:.0f}", f"{rest:.0f}", servo, f"{drive.reduction:g}", f"{drive.stall:.1f}"
        table.add_row(*map(quote_text, (hinge.name, *cells)), f"{velocity:.2f}")
    console().print(table)
    click.echo(_describe_surface(robot_model))
    return 0


def _describe_surface(robot: Robot) -> str:
    """Describe the robot's surface, with the remedy for an outdated shell."""
    if robot.skin is not None:
        return "drawn with its skin"
    if load_shell(robot):
        return "drawn in its shell"
    if find_shell(robot):
        return "drawn in the shell of the robot that it extends"
    if is_stale(robot):
        problem = f"{robot.path.with_suffix(SHELL_SUFFIX).name} was made from another robot description"
        return f"drawn as capsules: {problem}; rebuild it: python -m kinesic.sim.shells.bake {robot.path.name}"
    return f"drawn as capsules; build a shell: python -m kinesic.sim.shells.bake {robot.path.name}"


def assess_robot(robot: str) -> int:
    """Print static torque ratios, workspace and clearance of a robot."""
    from kinesic.planning.workspace import find_workspace  # noqa: PLC0415 - slow to import, and unused by the other verbs
    from kinesic.sim.robot_check import check_robot  # noqa: PLC0415

    robot_model = load_robot(robot)
    with show_stages() as stage:
        stage("searching the worst postures")
        checked = check_robot(robot_model)
        stage("computing the workspace")
        reach = find_workspace(robot_model)
    table = Table("hinge", "at rest", "worst", "", title="static torque / stall")
    failed = False
    for name, rest, worst in zip(robot_model.skeleton.names, checked.rest_ratios, checked.worst_ratios, strict=True):
        failed |= bool(worst > FAIL_TORQUE_RATIO)
        status = "fail" if worst > FAIL_TORQUE_RATIO else "warn" if worst > WARN_TORQUE_RATIO else "pass"
        table.add_row(quote_text(name), f"{rest:.3f}", f"{worst:.3f}", quote_text(status, style=TORQUE_COLOURS[status]))
    console().print(table)
    click.echo(
        f"mass {checked.mass:.2f} kg, {checked.moving_mass:.2f} kg of it moving; "
        f"arm length {robot_model.arm_length:.3f} m"
    )
    for name, clearance in (("at rest", checked.rest_gap), ("at zero", checked.zero_gap)):
        click.echo(f"clearance {name}: {1000 * clearance.distance:.0f} mm, {clearance.pair[0]} and {clearance.pair[1]}")
    min_clearance = 1000 * robot_model.min_clearance
    click.echo(f"{100 * checked.clear_share:.0f} % of random postures have {min_clearance:.0f} mm clearance")
    total = len(reach.reached) + len(reach.missed)
    click.echo(f"workspace: {len(reach.reached)} of {total} sectors within 2 cm, torso upright")
    return 1 if _has_wiring_faults(robot_model) or failed else 0


def _has_wiring_faults(robot: Robot) -> bool:
    """Print bus loads and supply faults, and return whether faults exist.

    An overloaded bus is a fault.
    """
    loads = compute_bus_loads(Manifest.of(robot), period=DEFAULT_SETTINGS.period) if ServoMap.of(robot).buses else ()
    for load in loads:
        click.echo(f"bus {load.bus}: {load.text}")
    supply_faults = find_supply_faults(robot)
    for line in supply_faults:
        click.echo(f"supply: {line}")
    return bool(supply_faults) or not all(load.fits for load in loads)


def import_robot(file: Path, out: Path | None, wished: tuple[str, ...], force: bool) -> int:
    """Convert an MJCF or URDF robot to a robot file."""
    target = out or Path(f"{file.stem}.toml")
    shell = target.with_suffix(SHELL_SUFFIX)
    picture = target.with_suffix(PICTURE_SUFFIX)
    for path in (target, shell, picture):
        check_file(path, force=force)
    with show_stages() as stage:
        stage("mapping the joints")
        imported = import_apart(file, wished=wished)
    write_text(target, imported.text, force=force, durable=True)
    console().print(_tabulate_mapping(imported))
    click.echo(f"confidence of the joint mapping: {imported.confidence:.2f} of 1")
    _print_notes("to check", imported.review)
    click.echo(f"robot: {target}")
    if imported.shell:
        with new_file(shell, force=force) as temporary:
            temporary.write_bytes(imported.shell)
        click.echo(f"shell: {shell}")
    _draw_picture(imported, target, picture, force=force)
    _print_notes("note", imported.left_out)
    if imported.doubt:
        click.echo(f"kinesic: review {target} before it moves: {imported.doubt}", err=True)
    return 1 if imported.doubt else 0


def _draw_picture(imported: ImportedRobot, target: Path, picture: Path, *, force: bool) -> None:
    """Draw the joint mapping next to the robot file.

    Without matplotlib, a line names the extra that installs it.
    """
    from kinesic.report.mapping_picture import draw_mapping  # noqa: PLC0415 - unused by the other verbs

    joint_of = [(hinge, joint) for hinge, joint, *_ in imported.mapping]
    try:
        with new_file(picture, force=force) as temporary:
            draw_mapping(
                Robot.load(target),
                joint_of,
                temporary,
                confidence=imported.confidence,
                doubtful=bool(imported.doubt),
            )
    except ModuleNotFoundError as error:
        reason = explain_missing(error)
        if reason is None:
            raise
        click.echo(f"no picture of the mapping: {reason}")
    else:
        click.echo(f"picture: {picture}")


def _print_notes(kind: str, notes: tuple[str, ...]) -> None:
    """Print the first notes of one kind, and count the unprinted notes."""
    for note in notes[:MAX_PRINTED_NOTES]:
        click.echo(f"{kind}: {quote_text(note)}")
    if (hidden_count := len(notes) - MAX_PRINTED_NOTES) > 0:
        click.echo(f"{kind}: {hidden_count} more")


def _tabulate_mapping(imported: ImportedRobot) -> Table:
    """Tabulate the imported file's joint for each hinge."""
    table = Table("hinge", "joint in the file", "range deg", "rest deg")
    for name, joint, *degrees in imported.mapping:
        table.add_row(name, quote_text(joint), *degrees)
    return table
