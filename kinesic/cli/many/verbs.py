"""The verbs that work through many tasks: `kinesic results`, `robots search`, `sweep` and `validate`."""

from pathlib import Path

import click

from kinesic.bml.block import RANGES
from kinesic.cli.many.workers import workers
from kinesic.cli.options import FORCE_HELP, TWIN_HELP, done_by, force_option, output, planning

VARY_HELP = (
    "What differs: BODY.length in m, HINGE.servo by its model, HINGE.reduction; HINGE may be a pattern such as "
    "'*_elbow_*'. Repeat for more."
)


@click.command("results")
@click.argument("query")
@click.argument("folder", type=click.Path(path_type=Path))
@click.option("--json", "as_json", is_flag=True, help="Prints the rows as JSON.")
@click.option("--out", type=click.Path(path_type=Path), help="Of plot: the PNG (default: results.png in FOLDER).")
@force_option
@done_by("many.results:ask_results")
def results_verb() -> None:
    """Asks QUERY (SQL, summary or plot) of the results that a run left in FOLDER.

    Such runs are `kinesic validate`, `sweep`, `bench` and `robots search` with --out FOLDER; plot draws them.
    """


@click.command("search")
@click.argument("robot")
@click.argument("paths", nargs=-1, required=True, type=click.Path(path_type=Path))
@click.option("--vary", "varied", multiple=True, required=True, metavar="WHAT.FEATURE=A,B,...", help=VARY_HELP)
@click.option("--designs", type=click.IntRange(1), default=32, show_default=True, help="Drawn of all combinations.")
@click.option("--seed", type=click.IntRange(0), default=0, show_default=True, help="Of designs and of rounds.")
@click.option("--style", default="neutral", show_default=True, help="Manner, unless documents say otherwise.")
@workers
@output(
    "Folder of the designs; an interrupted search goes on there.",
    "Begins anew in a folder that kinesic has made.",
    "Prints all designs as JSON.",
)
@done_by("many.search:search_designs")
def search_verb() -> None:
    """Searches better designs of ROBOT: variants of it perform the documents of PATHS (folders are searched).

    What is not beaten in lateness, violations, torque, mass, price, reach and length of the arm is printed.
    """


@click.command("sweep")
@click.argument("gesture")
@planning
@click.option("--parameter", metavar="NAME", help=f"One of {', '.join(RANGES)}.")
@click.option("--values", metavar="A,B,...", help="Values to play (default: five over the whole range).")
@click.option("--all", "every", is_flag=True, help="Every parameter, and every preset of style.")
@workers
@output("Folder of figures (default: out/sweep-NAME-TIME).", FORCE_HELP, "Prints the measures as JSON.")
@done_by("sweep:sweep_gesture")
def sweep_verb() -> None:
    """Plays GESTURE over the range of a parameter in the twin, measures and draws it."""


@click.command("validate")
@click.argument("paths", nargs=-1, required=True, type=click.Path(path_type=Path))
@planning
@click.option("--twin", default="nominal", show_default=True, help=TWIN_HELP)
@workers
@output(
    "Folder of the reports; an interrupted run goes on there.",
    "Begins anew in a folder that kinesic has made.",
    "Prints verdicts and totals as JSON.",
)
@done_by("validate:validate_paths")
def validate_verb() -> None:
    """Performs every document of PATHS (folders are searched) in the twin.

    With --out, an interrupted run goes on where it stopped when the same command is given again.
    """
