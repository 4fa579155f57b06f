"""Writer of the HTML page of a study.

One file that stores the answers and needs no server.
"""

import json
import re
from collections.abc import Mapping
from pathlib import Path
from types import MappingProxyType

from jinja2 import Environment, FileSystemLoader, StrictUndefined
from markupsafe import Markup

from kinesic.body.config import ConfigError
from kinesic.report.content_policy import content_policy
from kinesic.report.report import Json

TEMPLATE_FOLDER = Path(__file__).parent
NO_VARIABLES: Mapping[str, Json] = MappingProxyType({})


def write_questionnaire(
    path: Path,
    study: Mapping[str, Json],
    *,
    template: Path,
    script: str,
    post_to: str,
    shown: int,
    images: str = "'none'",
    variables: Mapping[str, Json] = NO_VARIABLES,
) -> None:
    """Write the HTML page of a study from its template.

    Args:
        path: path of the page.
        study: data for its script: `name`, under which a browser stores the answers; `columns` of the answers; `most`,
            the maximum
            number of shown items per participant; and data for the study's own script.
        template: template that extends `questionnaire.jinja`.
        script: script of the study, which runs after `questionnaire.js`.
        post_to: URL that receives each participant's answers as CSV; empty: answers are only offered as a file.
        shown: number of items per participant, stated in the welcome text.
        images: allowed image sources in the content policy.
        variables: further variables of the template.

    Raises:
        ConfigError: `post_to` is not an http or https URL.
    """
    loader = FileSystemLoader([template.parent, TEMPLATE_FOLDER])
    environment = Environment(
        loader=loader, autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True
    )
    full_script = f"{(TEMPLATE_FOLDER / 'questionnaire.js').read_text(encoding='utf-8')}\n{script}"
    text = environment.get_template(template.name).render(
        look=Markup((TEMPLATE_FOLDER / "questionnaire.css").read_text(encoding="utf-8")),
        script=Markup(full_script),
        policy=content_policy(full_script, img_src=images, connect_src=f"blob: {find_origin(post_to)}".rstrip()),
        study=Markup(json.dumps({**study, "postTo": post_to}).replace("<", "\\u003c")),
        shown=shown,
        **variables,
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
