"""Writer of the HTML page of a study.

One file that stores the answers and needs no server.
"""

import json
import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from jinja2 import Environment, FileSystemLoader, StrictUndefined
from markupsafe import Markup

from kinesic.body.config import ConfigError
from kinesic.report.content_policy import content_policy
from kinesic.report.report import Json

TEMPLATE_FOLDER = Path(__file__).parent


@dataclass(frozen=True)
class Questionnaire:
    """Template, script and data of a study's page.

    The data contain the `name` under which a browser stores the answers, the `columns` of the answers, `most`, the
    maximum number of shown items per participant, and data for the study's own script.
    """

    data: Mapping[str, Json]
    template: Path  # template file, which extends `questionnaire.jinja`
    script: str  # script of the study, which runs after `questionnaire.js`
    shown: int  # number of items per participant, which the welcome text states
    images: str = "'none'"  # allowed image sources in the content policy
    variables: Mapping[str, Json] = field(default_factory=dict)  # further variables of the template


def write_questionnaire(path: Path, questionnaire: Questionnaire, *, post_to: str) -> None:
    """Write the HTML page of a study from its template.

    Args:
        path: path of the page.
        questionnaire: content of the page.
        post_to: URL that receives each participant's answers as CSV; empty: answers are only offered as a file.

    Raises:
        ConfigError: `post_to` is not an http or https URL.
    """
    template = questionnaire.template
    loader = FileSystemLoader([template.parent, TEMPLATE_FOLDER])
    environment = Environment(
        loader=loader, autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True
    )
    full_script = f"{(TEMPLATE_FOLDER / 'questionnaire.js').read_text(encoding='utf-8')}\n{questionnaire.script}"
    text = environment.get_template(template.name).render(
        look=Markup((TEMPLATE_FOLDER / "questionnaire.css").read_text(encoding="utf-8")),
        script=Markup(full_script),
        policy=content_policy(
            full_script, img_src=questionnaire.images, connect_src=f"blob: {find_origin(post_to)}".rstrip()
        ),
        study=Markup(json.dumps({**questionnaire.data, "postTo": post_to}).replace("<", "\\u003c")),
        shown=questionnaire.shown,
        **questionnaire.variables,
    )
    path.write_text(text, encoding="utf-8")


def find_origin(url: str) -> str:
    """Return the origin of a URL, such as `https://example.org:8080`.

    An empty URL gives an empty text.

    Raises:
        ConfigError: the URL is of another kind.
    """
    if not url:
        return ""
    match = re.match(r"(https?://(?:[\w.-]+|\[[0-9a-f:.]+\])(?::\d+)?)(?:[/?]|$)", url, re.ASCII | re.IGNORECASE)
    if match is None:
        raise ConfigError(f"--post-to {url}: must be a URL such as https://example.org/answers")
    return match.group(1)
