"""Verb `kinesic certify`: check a motion file and write a feasible motion."""

import json
from collections.abc import Mapping
from pathlib import Path

import click

from kinesic.capture.certification import Certification, certify_clip, judge_clip
from kinesic.capture.read import read_clip
from kinesic.capture.robot_motion import RobotMotion
from kinesic.capture.violations import Violation
from kinesic.cli.progress import show_stages
from kinesic.cli.screen.table import Table
from kinesic.cli.terminal import console, quote_text
from kinesic.files.output_file import check_file
from kinesic.planning.files.motion_files import check_motion_file, save_motion
from kinesic.report.report import Json
from kinesic.session.setup import set_up

MAX_ROWS = 12  # largest number of violations that are printed
VIOLATION_EXIT_CODE = 1  # exit code if limits are violated


def certify_file(file: Path, robot: str, check: bool, out: Path | None, force: bool, as_json: bool) -> int:
    """Print a motion's violations and its distance to the nearest feasible motion.

    Returns:
        With `check` 1 if the file violates a limit; otherwise 1 if the nearest motion does.

    Raises:
        ConfigError: the file cannot be read, or the output must not be written.
    """
    if check and out is not None:
        raise click.UsageError("--check only judges FILE; leave --out away")
    if out is not None:
        check_motion_file(out)
        check_file(out, force=force)
    with show_stages() as stage:
        stage("reading the robot")
        setup = set_up(robot)
        stage("reading the motion")
        clip = read_clip(file)
        stage("searching the nearest motion")
        if check:
            desired, violations = judge_clip(clip, setup, str(file))
            result = None
        else:
            result = certify_clip(clip, setup, str(file))
            desired, violations = result.desired, result.violations
    if out is not None and result is not None:
        save_motion(result.trajectory, setup.robot, out, force=force)
    if as_json:
        record = _violation_record(file, setup.robot.name, desired, violations)
        click.echo(json.dumps({**record, **(_nearest_record(result) if result else {})}, indent=1))
    else:
        _print_violations(file, setup.robot.name, desired, violations)
        if result is not None:
            _print_nearest(result)
    if out is not None:
        click.echo(f"motion: {out}", err=as_json)
    is_good = not violations if result is None else result.is_certified
    return 0 if is_good else VIOLATION_EXIT_CODE


def _print_violations(file: Path, robot: str, desired: RobotMotion, violations: tuple[Violation, ...]) -> None:
    click.echo(f"{file} on {robot}: {desired.duration:.2f} s")
    for note in desired.notes:
        click.echo(f"note: {note}")
    if not violations:
        click.echo("violates no limit")
        return
    click.echo(f"violates {len(violations)} limits:")
    table = Table("limit", "joint or pair", "value / limit", "at [s]", "of time")
    for violation in violations[:MAX_ROWS]:
        table.add_row(
            violation.limit,
            quote_text(violation.part),
            f"{violation.ratio:.2f}",
            f"{violation.time:.2f}",
            f"{100.0 * violation.fraction:.1f} %",
        )
    console().print(table)
    if len(violations) > MAX_ROWS:
        click.echo(f"... and {len(violations) - MAX_ROWS} more; --json lists all")


def _print_nearest(result: Certification) -> None:
    nearest, distance = result.nearest, result.distance
    verdict = "within all limits" if result.is_certified else "NOT within all limits"
    click.echo(
        f"nearest motion: {verdict}; largest value / limit {result.limit_ratio:.3f}, "
        f"drive duty {result.torque_ratio:.2f}, clearance {1000.0 * result.clearance:.0f} mm"
    )
    click.echo(
        f"wrists {distance.wrist_rms:.3f} (rms) and {distance.wrist_max:.3f} (largest), "
        f"elbows {distance.elbow_rms:.3f} and {distance.elbow_max:.3f} arm lengths away; "
        f"correlation {distance.correlation:.3f}"
    )
    click.echo(f"time stretch {nearest.total_stretch:.2f}, locally up to {float(nearest.stretch.max()):.2f}")


def _violation_record(
    file: Path, robot: str, desired: RobotMotion, violations: tuple[Violation, ...]
) -> Mapping[str, Json]:
    return {
        "file": str(file),
        "robot": robot,
        "duration": desired.duration,
        "notes": list(desired.notes),
        "violations": [
            {
                "limit": violation.limit,
                "part": violation.part,
                "time": violation.time,
                "ratio": violation.ratio,
                "fraction": violation.fraction,
            }
            for violation in violations
        ],
    }


def _nearest_record(result: Certification) -> Mapping[str, Json]:
    distance = result.distance
    return {
        "certified": result.is_certified,
        "limit_ratio": result.limit_ratio,
        "torque_ratio": result.torque_ratio,
        "clearance": result.clearance,
        "stretch": result.nearest.total_stretch,
        "largest_stretch": float(result.nearest.stretch.max()),
        "wrist_rms": distance.wrist_rms,
        "wrist_max": distance.wrist_max,
        "elbow_rms": distance.elbow_rms,
        "elbow_max": distance.elbow_max,
        "elbow_direction": distance.elbow_direction,
        "correlation": distance.correlation,
    }
