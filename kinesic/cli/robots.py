"""`kinesic robots`: which robots there are, what they are made of, whether they can work; imports other ones."""

from pathlib import Path

import click
import numpy as np
from rich.table import Table

from kinesic.body.config import CONFIGS
from kinesic.body.robot import Robot
from kinesic.cli.progress import show_stages
from kinesic.cli.terminal import console, quote_text
from kinesic.files.output_file import check_file, new_file, write_text
from kinesic.hardware.protocol.servo_map import load_robot
from kinesic.sim.importer.apart.imported import ImportedRobot, import_apart
from kinesic.sim.shells.shell import SUFFIX, is_stale, shell_of

WARN_TORQUE = 0.4  # of stall
FAIL_TORQUE = 0.8
MAX_NOTES_SHOWN = 5  # parts of a foreign robot that are left out


def list_robots() -> int:
    """Lists the robots that come with kinesic."""
    for path in sorted((CONFIGS / "robots").glob("*.toml")):
        click.echo(path.stem)
    return 0


def show_robot(robot: str) -> int:
    """Prints range, servo and limits of every hinge of a robot."""
    body = load_robot(robot)
    table = Table("hinge", "range deg", "rest deg", "servo", "reduction", "stall Nm", "speed limit rad/s", box=None)
    for hinge, drive, speed in zip(body.skeleton.hinges, body.drives, body.speed_limits, strict=True):
        low, high, rest = np.degrees([hinge.lower, hinge.upper, hinge.rest])
        servo = drive.servo.name if drive.count == 1 else f"{drive.count} x {drive.servo.name}"
        figures = f"{low:.0f}..{high:.0f}", f"{rest:.0f}", servo, f"{drive.reduction:g}", f"{drive.stall:.1f}"
        table.add_row(*map(quote_text, (hinge.name, *figures)), f"{speed:.2f}")
    console().print(table)
    click.echo(_tell_shell(body))
    return 0


def _tell_shell(robot: Robot) -> str:
    """Says what the robot is drawn as, and what mends a shell that was made from another description."""
    if robot.skin is not None:
        return "drawn with its skin"
    if is_stale(robot):
        made = f"{robot.path.with_suffix(SUFFIX).name} was made from another description"
        return f"drawn as capsules: {made}; make it anew: python -m kinesic.sim.shells.bake {robot.path.name}"
    return "drawn in its shell" if shell_of(robot) else "drawn as capsules"


def assess_robot(robot: str) -> int:
    """Prints static torque ratios, workspace and clearance of a robot."""
    from kinesic.planning.workspace import workspace  # noqa: PLC0415 - slow to import, and imports need neither
    from kinesic.sim.robot_check import check_robot  # noqa: PLC0415

    body = load_robot(robot)
    with show_stages() as stage:
        stage("searching the worst postures")
        physics = check_robot(body)
        stage("reaching for every sector")
        reach = workspace(body)
    table = Table("hinge", "at rest", "worst", "", box=None, title="static torque / stall")
    failed = False
    for name, rest, worst in zip(body.skeleton.names, physics.rest_ratios, physics.worst_ratios, strict=True):
        failed |= bool(worst > FAIL_TORQUE)
        mark = "[red]fail[/]" if worst > FAIL_TORQUE else "[yellow]warn[/]" if worst > WARN_TORQUE else "pass"
        table.add_row(quote_text(name), f"{rest:.3f}", f"{worst:.3f}", mark)
    console().print(table)
    click.echo(
        f"mass {physics.mass:.2f} kg, {physics.moving_mass:.2f} kg of it moving; arm length {body.arm_length:.3f} m"
    )
    for name, gap in (("at rest", physics.rest_gap), ("at zero", physics.zero_gap)):
        click.echo(f"clearance {name}: {1000 * gap.distance:.0f} mm, {gap.pair[0]} and {gap.pair[1]}")
    least = 1000 * body.least_clearance
    click.echo(f"{100 * physics.clear_share:.0f} % of random postures keep {least:.0f} mm")
    total = len(reach.reached) + len(reach.missed)
    click.echo(f"workspace: {len(reach.reached)} of {total} sectors within 2 cm, torso upright")
    return 1 if failed else 0


def import_robot(file: Path, out: Path | None, force: bool) -> int:
    """Map the joints of an MJCF or URDF and write a TOML."""
    target = out or Path(f"{file.stem}.toml")
    shell = target.with_suffix(SUFFIX)
    for path in (target, shell):
        check_file(path, force=force)
    with show_stages() as stage:
        stage("mapping its hinges")
        found = import_apart(file)
    write_text(target, found.text, force=force, durable=True)
    console().print(_mapping(found))
    click.echo(f"robot: {target}")
    if found.shell:
        with new_file(shell, force=force) as fresh:
            fresh.write_bytes(found.shell)
        click.echo(f"shell: {shell}")
    for why in found.left_out[:MAX_NOTES_SHOWN]:
        click.echo(f"left out: {quote_text(why)}")
    if (more := len(found.left_out) - MAX_NOTES_SHOWN) > 0:
        click.echo(f"left out: {more} more")
    if found.doubt:
        click.echo(f"kinesic: review {target} before it moves: {found.doubt}", err=True)
    return 1 if found.doubt else 0


def _mapping(found: ImportedRobot) -> Table:
    """Tabulate which hinge of the file became which."""
    table = Table("hinge", "of the file", "range deg", "rest deg", box=None)
    for name, joint, *degrees in found.mapping:
        table.add_row(name, quote_text(joint), *degrees)
    return table
