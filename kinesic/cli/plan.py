"""`kinesic plan`: from BML, or from a motion that others made, to a motion in a file; nothing moves."""

from pathlib import Path

import click

from kinesic.cli.options import PlanningOptions, planning, read_input
from kinesic.controller.perform import plan as plan_document
from kinesic.planning.bap import SUFFIX, read_bap
from kinesic.planning.imported_motion import plan_imported
from kinesic.planning.motion_files import write_motion


@click.command()
@click.argument("file")
@planning
@click.option("--out", required=True, type=click.Path(path_type=Path), help="motion.npz, motion.csv or motion.bap.")
def plan(
    file: str,
    settings: PlanningOptions,
    out: Path,
) -> int:
    """Plans FILE (BML, a .bap motion, or - for BML from standard input) and writes the motion."""
    known = settings.setup()
    if file.endswith(SUFFIX):
        planned = plan_imported(read_bap(Path(file), known.robot), known, source=file)
    else:
        planned = plan_document(read_input(file), known, source="stdin" if file == "-" else file)
    write_motion(planned.trajectory, known.robot, out)
    for notice in planned.notices:
        click.echo(f"{notice.type.value} {notice.id}: {notice.text}", err=True)
    click.echo(f"{planned.trajectory.duration:.2f} s, {len(planned.postures.postures)} keys")
    click.echo(f"motion: {out}")
    return 0
