"""Verb `kinesic demo`: perform the built-in greeting and open its report."""

from pathlib import Path

import click

from kinesic.cli.browser import open_in_browser
from kinesic.cli.options import Output, Performers, Planning, TwinOptions
from kinesic.cli.perform import perform_file
from kinesic.cli.perform_options import PerformOptions
from kinesic.files.film_settings import FilmSettings
from kinesic.report.output import PAGE_FILE
from kinesic.session.options import INTERACTIVE_DEFAULTS

DEMO_DOCUMENT = "welcome"  # name of the built-in document
DEMO_FOLDER = Path("out/demo")  # default folder of the report
DEMO_FILM = FilmSettings(size=(854, 480), rate=15.0)  # film smaller than by default, so that it is ready sooner


def perform_demo(out: Path | None, robot: str, style: str, film: bool, force: bool, browser: bool) -> int:
    """Perform the greeting in the twin, write its report and open it.

    A report in the default folder is replaced; a folder of the user's is replaced only by force.
    """
    folder = out or DEMO_FOLDER
    options = PerformOptions(
        Planning(robot, style, INTERACTIVE_DEFAULTS),
        Performers(frozenset({"twin"}), ()),
        TwinOptions(twin=None, learn=None, feedforward="full", correction=True),
        Output(folder, force or out is None, as_json=False),
        DEMO_FILM if film else None,
    )
    exit_code = perform_file(DEMO_DOCUMENT, options)
    page = folder / PAGE_FILE
    if browser and page.is_file() and open_in_browser(page.resolve().as_uri()):
        click.echo("the page is open in the browser")
    return exit_code
