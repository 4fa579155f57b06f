"""`kinesic robots`: which robots there are, what they are made of, and whether they can work."""

import click
import numpy as np
from rich.table import Table

from kinesic.body.config import CONFIGS
from kinesic.controller.cli.console import console
from kinesic.controller.robots import load_robot
from kinesic.controller.workspace import workspace
from kinesic.sim.check import check as check_physics

WARN_TORQUE = 0.4  # of stall
FAIL_TORQUE = 0.8


@click.group()
def robots() -> None:
    """Lists, shows and checks robots."""


@robots.command("list")
def list_robots() -> int:
    """Lists the robots that come with kinesic."""
    for path in sorted((CONFIGS / "robots").glob("*.toml")):
        click.echo(path.stem)
    return 0


@robots.command()
@click.argument("robot", default="upper22")
def show(robot: str) -> int:
    """Shows the hinges of ROBOT: range, servo, limits."""
    body = load_robot(robot)
    table = Table("hinge", "range deg", "rest deg", "servo", "reduction", "stall Nm", "speed limit rad/s", box=None)
    for hinge, drive, speed in zip(body.skeleton.hinges, body.drives, body.speed_limits, strict=True):
        low, high, rest = np.degrees([hinge.lower, hinge.upper, hinge.rest])
        servo = drive.servo.name if drive.count == 1 else f"{drive.count} x {drive.servo.name}"
        figures = f"{low:.0f}..{high:.0f}", f"{rest:.0f}", servo, f"{drive.reduction:g}", f"{drive.stall:.1f}"
        table.add_row(hinge.name, *figures, f"{speed:.2f}")
    console().print(table)
    return 0


@robots.command()
@click.argument("robot", default="upper22")
def check(robot: str) -> int:
    """Computes static torque ratios, workspace and clearance of ROBOT from its model."""
    body = load_robot(robot)
    physics, reach = check_physics(body), workspace(body)
    table = Table("hinge", "at rest", "worst", "", box=None, title="static torque / stall")
    failed = False
    for name, rest, worst in zip(body.skeleton.names, physics.rest_ratios, physics.worst_ratios, strict=True):
        failed |= bool(worst > FAIL_TORQUE)
        mark = "[red]fail[/]" if worst > FAIL_TORQUE else "[yellow]warn[/]" if worst > WARN_TORQUE else "pass"
        table.add_row(name, f"{rest:.3f}", f"{worst:.3f}", mark)
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
