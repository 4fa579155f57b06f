"""Verb `kinesic export`: write a motion for viewers, ROS, animation and analysis."""

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
from kinesic.files.output_folder import check_folder
from kinesic.files.plain_name import cut_name
from kinesic.importing import import_at_once
from kinesic.planning.files.motion_files import save_motion
from kinesic.report.export.lerobot_dataset import save_lerobot
from kinesic.report.export.mcap_file import save_mcap
from kinesic.report.export.recording import ExportedMotion
from kinesic.report.export.rerun_file import save_rerun

ExportKind = Literal["mcap", "rerun", "lerobot", "ros", "json", "csv", "npz", "bvh"]
FILE_SUFFIXES: Mapping[ExportKind, str] = {  # kind -> file suffix
    "mcap": ".mcap",
    "rerun": ".rrd",
    "lerobot": "",
    "ros": ".mcap",
    "json": ".json",
    "csv": ".csv",
    "npz": ".npz",
    "bvh": ".bvh",
}
PACKAGE_NAMES: Mapping[ExportKind, str] = {
    "mcap": "foxglove",
    "rerun": "rerun",
    "lerobot": "duckdb",
}  # kind of recording -> Python package that writes it
MAX_NAME_LENGTH = 100  # [bytes] longest default file name without its suffix


def export_motion(
    file: str, planning: Planning, kind: ExportKind, performed: bool, out: Path | None, force: bool
) -> int:
    """Plan a document and export its planned or performed motion.

    Raises:
        ConfigError: the path has another suffix, or must not be written; or a performed motion that is no recording.
        ModuleNotFoundError: the extra of this kind is missing.
    """
    path = out or Path(
        (cut_name(Path(document_name(file)).stem, limit=MAX_NAME_LENGTH) or "motion") + FILE_SUFFIXES[kind]
    )
    if path.suffix.lower() != FILE_SUFFIXES[kind]:
        written = FILE_SUFFIXES[kind] or "a folder"
        raise ConfigError(f"{path}: --to {kind} writes {written}; name it {path.stem}{FILE_SUFFIXES[kind]}")
    if performed and kind not in PACKAGE_NAMES:
        raise ConfigError(f"--performed needs --to {' or '.join(PACKAGE_NAMES)}; --to {kind} writes the planned motion")
    if kind in PACKAGE_NAMES:
        import_at_once(PACKAGE_NAMES[kind])
    (check_folder if kind == "lerobot" else check_file)(path, force=force)
    with show_stages() as stage:
        stage("planning")
        plan = plan_input(file, planning.set_up())
        if kind not in PACKAGE_NAMES:
            stage("writing")
            save_motion(plan.trajectory, plan.setup.robot, path, force=force)
        else:
            if performed:
                stage("performing in the twin")
            motion = ExportedMotion.of_performance(dry_run(plan)) if performed else ExportedMotion.of_plan(plan)
            stage("writing")
            _save(motion, kind, path, force=force)
    print_notices(plan, error_console())
    click.echo(f"{_name(kind)}: {path}")
    return 0


def _save(motion: ExportedMotion, kind: ExportKind, path: Path, *, force: bool) -> None:
    """Write a motion as a recording or a dataset."""
    match kind:
        case "mcap":
            save_mcap(motion, path, force=force)
        case "rerun":
            save_rerun(motion, path, force=force)
        case _:
            save_lerobot([motion], path, force=force)


def _name(kind: ExportKind) -> str:
    """Return the displayed name of the written output."""
    if kind == "lerobot":
        return "dataset"
    return "recording" if kind in PACKAGE_NAMES else "motion"
