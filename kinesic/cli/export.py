"""Verb `kinesic export`: write a motion for Foxglove or Rerun."""

from collections.abc import Mapping
from pathlib import Path
from typing import Literal

import click

from kinesic.body.config import ConfigError
from kinesic.cli.options import Planning
from kinesic.cli.plan import document_name, plan_input
from kinesic.cli.progress import show_stages
from kinesic.cli.summary import print_notices
from kinesic.cli.terminal import error_console
from kinesic.controller.dry_run import dry_run
from kinesic.files.output_file import check_file
from kinesic.files.plain_name import cut_name
from kinesic.importing import import_at_once
from kinesic.report.export.mcap_file import save_mcap
from kinesic.report.export.recording import ExportedMotion
from kinesic.report.export.rerun_file import save_rerun

ExportKind = Literal["mcap", "rerun"]
FILE_SUFFIXES: Mapping[ExportKind, str] = {"mcap": ".mcap", "rerun": ".rrd"}  # kind -> file suffix
PACKAGE_NAMES: Mapping[ExportKind, str] = {"mcap": "foxglove", "rerun": "rerun"}  # kind -> import name of its package
MAX_NAME_LENGTH = 100  # [bytes] longest default file name without its suffix


def export_motion(
    file: str, planning: Planning, kind: ExportKind, performed: bool, out: Path | None, force: bool
) -> int:
    """Plan a document and export its planned or performed motion.

    Raises:
        ConfigError: the path has another suffix, or must not be written.
        ModuleNotFoundError: the extra of this kind is missing.
    """
    path = out or Path(
        (cut_name(Path(document_name(file)).stem, limit=MAX_NAME_LENGTH) or "motion") + FILE_SUFFIXES[kind]
    )
    if path.suffix.lower() != FILE_SUFFIXES[kind]:
        raise ConfigError(f"{path}: --to {kind} writes {FILE_SUFFIXES[kind]}; name it {path.stem}{FILE_SUFFIXES[kind]}")
    import_at_once(PACKAGE_NAMES[kind])
    check_file(path, force=force)
    with show_stages() as stage:
        stage("planning")
        plan = plan_input(file, planning.set_up())
        if performed:
            stage("performing in the twin")
        motion = ExportedMotion.of_performance(dry_run(plan)) if performed else ExportedMotion.of_plan(plan)
        stage("writing")
        if kind == "mcap":
            save_mcap(motion, path, force=force)
        else:
            save_rerun(motion, path, force=force)
    print_notices(plan, error_console())
    click.echo(f"recording: {path}")
    return 0
