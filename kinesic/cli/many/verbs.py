"""Declarations of `kinesic results`, `robots search`, `sweep` and `validate`."""

from pathlib import Path

import click

from kinesic.bml.block import EXPRESSIVITY_RANGES
from kinesic.cli.completion import DOCUMENT_PATH, GESTURE_NAME, ROBOT_NAME, STYLE_NAME
from kinesic.cli.help_pages import VerbCommand
from kinesic.cli.many.workers import worker_options
from kinesic.cli.options import FORCE_HELP, TWIN_HELP, force_option, implemented_by, output_options, planning_options

VARY_HELP = (
    "Varied parameter: BODY.length in m, HINGE.servo by its model, HINGE.reduction; HINGE may be a pattern such as "
    "'*_elbow_*'. Repeatable."
)


@click.command("results", cls=VerbCommand)
@click.argument("query")
@click.argument("folder", type=click.Path(path_type=Path))
@click.option("--json", "as_json", is_flag=True, help="Print the rows as JSON.")
@click.option("--out", type=click.Path(path_type=Path), help="For plot: PNG file (default: results.png in FOLDER).")
@force_option
@implemented_by("many.results:ask_results")
def results_verb() -> None:
    """Run QUERY (SQL, summary or plot) on the results in FOLDER.

    The results are those of `kinesic validate`, `sweep`, `bench` or `robots search` with --out FOLDER. plot draws them.
    """


@click.command("search", cls=VerbCommand)
@click.argument("robot", type=ROBOT_NAME)
@click.argument("paths", nargs=-1, required=True, type=DOCUMENT_PATH)
@click.option("--vary", "varied", multiple=True, required=True, metavar="WHAT.FEATURE=A,B,...", help=VARY_HELP)
@click.option(
    "--designs",
    type=click.IntRange(1),
    default=32,
    show_default=True,
    help="Number of designs, drawn from all combinations.",
)
@click.option("--seed", type=click.IntRange(0), default=0, show_default=True, help="Seed of the designs and rounds.")
@click.option(
    "--style", type=STYLE_NAME, default="neutral", show_default=True, help="Style, unless a document sets another."
)
@worker_options
@output_options(
    "Folder of the designs; an interrupted search resumes there.",
    "Start again in a folder made by kinesic.",
    "Print all designs as JSON.",
)
@implemented_by("many.search:search_designs")
def search_verb() -> None:
    """Search for better designs of ROBOT by performing documents with variants.

    PATHS are BML files, or folders that are searched for them. The search prints the Pareto-optimal designs with
    respect to lateness, violations, torque, mass, price, reach and arm length.
    """


@click.command("sweep", cls=VerbCommand)
@click.argument("gesture", type=GESTURE_NAME)
@planning_options
@click.option("--parameter", metavar="NAME", help=f"One of {', '.join(EXPRESSIVITY_RANGES)}.")
@click.option("--values", metavar="A,B,...", help="Values to perform (default: five over the whole range).")
@click.option("--all", "all_parameters", is_flag=True, help="Sweep every parameter, and measure every preset style.")
@worker_options
@output_options("Folder of the results (default: out/sweep-NAME-TIME).", FORCE_HELP, "Print the measures as JSON.")
@implemented_by("sweep:sweep_gesture")
def sweep_verb() -> None:
    """Measure GESTURE over the range of a style parameter.

    The gesture is performed in the twin; the measures are printed and plotted.
    """


@click.command("validate", cls=VerbCommand)
@click.argument("paths", nargs=-1, required=True, type=DOCUMENT_PATH)
@planning_options
@click.option("--twin", default="nominal", show_default=True, help=TWIN_HELP)
@worker_options
@output_options(
    "Folder of the reports; an interrupted run resumes there.",
    "Start again in a folder made by kinesic.",
    "Print verdicts and totals as JSON.",
)
@implemented_by("validate:validate_paths")
def validate_verb() -> None:
    """Perform every document in PATHS (files or folders) in the twin.

    PATHS may also be names of built-in documents, such as welcome. With --out, an interrupted run resumes when the same
    command is given again.
    """
