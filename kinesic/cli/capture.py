"""Verb `kinesic capture import`: convert captured clips to gestures."""

from collections import Counter
from pathlib import Path

import click

from kinesic.body.robot import Robot
from kinesic.capture.gesture_library import import_folder, write_folder
from kinesic.cli.plain_words import printable
from kinesic.cli.progress import show_stages, stage_progress
from kinesic.files.output_folder import check_folder, new_folder

SWIVEL_ROBOT = "human"  # robot whose arms define the elbow swivel of captured gestures
PROBLEM_EXIT_CODE = 1  # exit code if clips were left out
MAX_PROBLEMS = 10  # largest number of omitted clips that are listed


def import_clips(folder: Path, out: Path, licence: str, source: str, force: bool) -> int:
    """Write all clips of a folder as gestures, and print their number.

    Returns:
        1 if a clip was left out.

    Raises:
        ConfigError: no clip can be read, or the output must not be written.
    """
    check_folder(out, force=force)
    with show_stages() as stage:
        stage("reading the clips")
        imported = import_folder(
            folder,
            Robot.load(SWIVEL_ROBOT),
            licence=licence,
            source=source,
            progress=stage_progress(stage, "reading the clips"),
        )
        stage("writing the gestures")
        with new_folder(out, force=force) as fresh:
            write_folder(imported, fresh)
    categories = Counter(clip.category for clip in imported.clips)
    click.echo(f"{len(imported.clips)} gestures: {', '.join(f'{n} {name}' for name, n in categories.most_common())}")
    click.echo(printable(f"licence: {imported.card.licence}"))
    for problem in imported.problems[:MAX_PROBLEMS]:
        click.echo(printable(f"left out: {problem}"), err=True)
    if len(imported.problems) > MAX_PROBLEMS:
        click.echo(f"left out: {len(imported.problems) - MAX_PROBLEMS} more", err=True)
    click.echo(f"gestures: {out}")
    return PROBLEM_EXIT_CODE if imported.problems else 0
