"""`kinesic twin`: fits the twin to measurements of a robot."""

import json
from dataclasses import asdict
from pathlib import Path
from typing import cast

import click
import numpy as np
from rich.table import Table

from kinesic.body.config import ConfigError
from kinesic.cli.progress import show_stages
from kinesic.cli.terminal import console, quote_text
from kinesic.files.output_file import check_file, write_text
from kinesic.hardware.protocol.servo_map import load_robot
from kinesic.sim.fitting.fit import Estimate, Fit, fit_factors
from kinesic.sim.fitting.parameters import ServoFigure
from kinesic.sim.log import read_log


def fit_twin(log: Path, robot: str, free: tuple[str, ...], out: Path | None, force: bool, as_json: bool) -> int:
    """Fits servo factors to a log, and says which of them it cannot tell."""
    if out is not None:
        check_file(out, force=force)
    body = load_robot(robot)
    try:
        with show_stages() as stage:
            stage("reading the log")
            found = fit_factors(
                read_log(log, body),
                body,
                free=cast(tuple[ServoFigure, ...], free),
                progress=lambda count: stage(f"fitting: replay {count} of the log"),
            )
    except ValueError as error:
        raise ConfigError(f"--free: {error}") from None
    if as_json:
        click.echo(json.dumps(_data(found), indent=1))
    else:
        console().print(_table(found))
        click.echo(_summary(found))
    if out is not None:
        write_text(out, _toml(found, log), force=force)
        click.echo(f"factors: {out}", err=as_json)
    return 0


def _table(found: Fit) -> Table:
    table = Table("figure", "factor or s", "+-", "", box=None, header_style="bold")
    for estimate in found.estimates:
        cells = ("as in the sheet", "") if estimate.why else (f"{estimate.value:.4f}", f"{estimate.deviation:.4f}")
        table.add_row(*map(quote_text, (str(estimate.unknown), *cells, estimate.why)))
    return table


def _summary(found: Fit) -> str:
    before, after = np.degrees([found.before, found.after])
    fitted = sum(not estimate.why for estimate in found.estimates)
    return f"{fitted} of {len(found.estimates)} figures told; twin minus log {before:.3f} -> {after:.3f} deg RMS"


def _data(found: Fit) -> dict[str, object]:
    return {
        "estimates": [
            {**asdict(e.unknown), "value": e.value, "deviation": e.deviation, "why": e.why} for e in found.estimates
        ],
        "before_deg": float(np.degrees(found.before)),
        "after_deg": float(np.degrees(found.after)),
    }


def _toml(found: Fit, log: Path) -> str:
    """Writes the factors with their deviations; in comments, what the log does not tell."""
    lines = [f"# Fitted by `kinesic twin fit` from {log.name}. {_summary(found)}."]
    servos = list(dict.fromkeys(estimate.unknown.servo for estimate in found.estimates))
    for servo in sorted(servos):  # the whole robot's first
        lines += ["", f"[servos.{servo}]"] if servo else []
        lines += [_line(estimate) for estimate in found.estimates if estimate.unknown.servo == servo]
    return "\n".join(lines) + "\n"


def _line(estimate: Estimate) -> str:
    if estimate.why:
        return f"# {estimate.unknown.figure}: {estimate.why}"
    return f"{estimate.unknown.figure} = {estimate.value:.6g}  # +- {estimate.deviation:.2g}"
