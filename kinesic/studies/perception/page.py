"""The static page that shows each stimulus once and asks: it needs a browser and the folder of stimuli, no server."""

import json
from pathlib import Path

from jinja2 import Environment, FileSystemLoader, StrictUndefined
from markupsafe import Markup

from kinesic.studies.perception.answers import COLUMNS
from kinesic.studies.perception.design import ACTIONS, PER_CELL, POINTS, stimuli
from kinesic.studies.perception.stimuli import SECONDS, file_of

HERE = Path(__file__).parent
SCALE = ("totally disagree", "disagree", "neither", "agree", "totally agree")
OPINIONS = {"naturalness": "This face looks natural", "realism": "This face looks realistic"}


def write_study_page(path: Path, *, folder: str = "stimuli", post_to: str = "") -> None:
    """Writes the page.

    Args:
        path: of the page.
        folder: of the stimuli, as seen from the page.
        post_to: URL that each participant's answers are sent to as CSV; empty: they are only offered as a file.
    """
    environment = Environment(
        loader=FileSystemLoader(HERE), autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True
    )
    study = {
        "stimuli": [
            {
                "id": each.id,
                "file": f"{folder}/{file_of(each)}",
                "agent": each.agent,
                "action": each.action.name,
                "strength": each.strength,
                "wrinkles": "with" if each.wrinkles else "without",
                "presentation": each.presentation,
                "region": each.action.region,
            }
            for each in stimuli()
        ],
        "questions": {
            region: {a.name: a.label for a in ACTIONS if a.region == region} | OPINIONS for region in ("upper", "lower")
        },
        "scale": SCALE,
        "points": POINTS,
        "columns": COLUMNS,
        "perCell": PER_CELL,
        "seconds": SECONDS,
        "postTo": post_to,
    }
    text = environment.get_template("study.jinja").render(
        look=Markup((HERE / "study.css").read_text(encoding="utf-8")),
        script=Markup((HERE / "study.js").read_text(encoding="utf-8")),
        study=Markup(json.dumps(study).replace("<", "\\u003c")),
        shown=4 * PER_CELL,
    )
    path.write_text(text, encoding="utf-8")
