"""Verb `kinesic twin fit`: fit servo factors to a robot's log."""

import json
from dataclasses import asdict
from pathlib import Path
from typing import cast

import click
import numpy as np

from kinesic.body.config import ConfigError
from kinesic.cli.progress import show_stages
from kinesic.cli.screen.table import Table
from kinesic.cli.terminal import console, quote_text
from kinesic.files.output_file import check_file, write_text
from kinesic.hardware.protocol.servo_map import load_robot
from kinesic.sim.fitting.fit import Estimate, Fit, fit_factors
from kinesic.sim.fitting.parameters import ServoParameter
from kinesic.sim.log import read_log


def fit_twin(log: Path, robot: str, free: tuple[str, ...], out: Path | None, force: bool, as_json: bool) -> int:
    """Fit the twin's servo parameters to a log, and list undetermined parameters."""
    if out is not None:
        check_file(out, force=force)
    robot_model = load_robot(robot)
    with show_stages() as stage:
        stage("reading the log")
        measured = read_log(log, robot_model)
        try:
            fit = fit_factors(
                measured,
                robot_model,
                free=cast(tuple[ServoParameter, ...], free),
                progress=lambda count: stage(f"fitting: replay {count} of the log"),
            )
        except ValueError as error:
            raise ConfigError(f"--free: {error}") from None
    if as_json:
        click.echo(json.dumps(_to_json(fit), indent=1))
    else:
        console().print(_tabulate(fit))
        click.echo(_summarise(fit))
    if out is not None:
        write_text(out, _to_toml(fit, log), force=force)
        click.echo(f"factors: {out}", err=as_json)
    return 0


def _tabulate(fit: Fit) -> Table:
    table = Table("parameter", "factor or s", "+-", "")
    for estimate in fit.estimates:
        cells = ("as in the data sheet", "") if estimate.why else (f"{estimate.value:.4f}", f"{estimate.deviation:.4f}")
        table.add_row(*map(quote_text, (str(estimate.unknown), *cells, estimate.why)))
    return table


def _summarise(fit: Fit) -> str:
    before, after = np.degrees([fit.error_before, fit.error_after])
    fitted = sum(not estimate.why for estimate in fit.estimates)
    return f"{fitted} of {len(fit.estimates)} parameters identified; twin minus log {before:.3f} -> {after:.3f} deg RMS"


def _to_json(fit: Fit) -> dict[str, object]:
    return {
        "estimates": [
            {**asdict(estimate.unknown), "value": estimate.value, "deviation": estimate.deviation, "why": estimate.why}
            for estimate in fit.estimates
        ],
        "before_deg": float(np.degrees(fit.error_before)),
        "after_deg": float(np.degrees(fit.error_after)),
    }


def _to_toml(fit: Fit, log: Path) -> str:
    """Format factors as TOML with standard deviations, undetermined factors as comments."""
    lines = [f"# Fitted by `kinesic twin fit` from {log.name}. {_summarise(fit)}."]
    servos = list(dict.fromkeys(estimate.unknown.servo for estimate in fit.estimates))
    for servo in sorted(servos):  # The factors of the whole robot come first.
        lines += ["", f"[servos.{servo}]"] if servo else []
        lines += [_format_estimate(estimate) for estimate in fit.estimates if estimate.unknown.servo == servo]
    return "\n".join(lines) + "\n"


def _format_estimate(estimate: Estimate) -> str:
    if estimate.why:
        return f"# {estimate.unknown.figure}: {estimate.why}"
    return f"{estimate.unknown.figure} = {estimate.value:.6g}  # +- {estimate.deviation:.2g}"
