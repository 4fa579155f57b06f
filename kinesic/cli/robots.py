"""`kinesic robots`: which robots there are, what they are made of, whether they can work; imports other ones."""

from pathlib import Path

import click
import numpy as np
from rich.table import Table

from kinesic.body.config import CONFIGS
from kinesic.body.robot import Robot
from kinesic.body.robot_schema import robot_text
from kinesic.cli.progress import show_stages
from kinesic.cli.terminal import console, quote_text
from kinesic.files.output_file import check_file, new_file, write_text
from kinesic.hardware.protocol.servo_map import load_robot
from kinesic.planning.workspace import workspace
from kinesic.sim.importer.convert import REVIEW_BELOW, Mapped, import_humanoid
from kinesic.sim.importer.shell import own_shell
from kinesic.sim.robot_check import check_robot
from kinesic.sim.shells.shell import SUFFIX, is_stale, shell_of, write_shell

WARN_TORQUE = 0.4  # of stall
FAIL_TORQUE = 0.8
MESHES_SHOWN = 5  # meshes that are not drawn


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
    """Maps the hinges of a humanoid's MJCF or URDF, and writes a robot's TOML to edit."""
    target = out or Path(f"{file.stem}.toml")
    for path in (target, target.with_suffix(SUFFIX)):
        check_file(path, force=force)
    with show_stages() as stage:
        stage("mapping its hinges")
        found = import_humanoid(file)
    text = robot_text(found.file, heading=_heading(found, file.name), remarks=found.remarks)
    write_text(target, text, force=force, durable=True)
    console().print(_mapping(found))
    click.echo(f"robot: {target}")
    _write_looks(found, target, force=force)
    if found.doubtful:
        click.echo(f"kinesic: review {target} before it moves: {_doubt(found)}", err=True)
    return 1 if found.doubtful else 0


def _write_looks(found: Mapped, target: Path, *, force: bool) -> None:
    """Writes the robot's own meshes beside its TOML, where there are any, and says which are missing."""
    shell, path = own_shell(found, Robot.load(target, calibrated=False)), target.with_suffix(SUFFIX)
    if shell is not None:
        with new_file(path, force=force) as fresh:
            write_shell(shell, fresh)
        click.echo(f"shell: {path}")
    for why in found.figure.tree.left_out[:MESHES_SHOWN]:
        click.echo(f"left out: {quote_text(why)}")
    if (more := len(found.figure.tree.left_out) - MESHES_SHOWN) > 0:
        click.echo(f"left out: {more} more")


def _mapping(found: Mapped) -> Table:
    """Tabulates which hinge of the file became which."""
    table = Table("hinge", "of the file", "range deg", "rest deg", box=None)
    for hinge in found.hinges:
        low, high = np.degrees([hinge.lower, hinge.upper])
        rest = found.file.rest.get(hinge.name, 0.0) + 0.0  # no -0
        ranges = f"{low:.0f}..{high:.0f}{' assumed' if hinge.assumed else ''}"
        table.add_row(hinge.name, quote_text(found.figure.tree.joints[hinge.joint].name), ranges, f"{rest:.0f}")
    return table


def _heading(found: Mapped, name: str) -> list[str]:
    doubt = [f"REVIEW before it moves: {_doubt(found)}.", ""] if found.doubtful else []
    return [
        *doubt,
        f"Mapped from {name} by `kinesic robots import`; confidence {found.confidence:.2f} of 1. Edit freely.",
        "x forward, y left, z up; m, kg, deg, Nm. Zero pose: arms hanging, elbows straight. Beside each hinge: how the",
        "file's joint follows from its angle; at: where its axis passes its segment. Beside each servo: where its",
        "figures come from. Capsules are the file's own primitive shapes, or bones with a human's girth.",
    ]


def _doubt(found: Mapped) -> str:
    return f"confidence {found.confidence:.2f} is below {REVIEW_BELOW:g}, so shoulder, elbow or sides may be wrong"
