"""Writes the page of a study: one file that leads a participant through it, keeps the answers and needs no server."""

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

HERE = Path(__file__).parent
NOTHING: Mapping[str, Json] = MappingProxyType({})


def write_questionnaire(
    path: Path,
    study: Mapping[str, Json],
    *,
    template: Path,
    script: str,
    post_to: str,
    shown: int,
    images: str = "'none'",
    told: Mapping[str, Json] = NOTHING,
) -> None:
    """Writes the page of a study.

    Args:
        path: of the page.
        study: what its script reads: `name`, under which a browser keeps the answers; `columns` of the answers; `most`
            that one participant may be shown; and what the study's own script needs.
        template: that extends `questionnaire.jinja`.
        script: the study's own, which runs after `questionnaire.js`.
        post_to: URL that each participant's answers are sent to as CSV; empty: they are only offered as a file.
        shown: how much one participant is shown, as the welcome says.
        images: where they may come from.
        told: what else the template reads.

    Raises:
        ConfigError: `post_to` is no http or https URL.
    """
    loader = FileSystemLoader([template.parent, HERE])
    environment = Environment(
        loader=loader, autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True
    )
    whole = f"{(HERE / 'questionnaire.js').read_text(encoding='utf-8')}\n{script}"
    text = environment.get_template(template.name).render(
        look=Markup((HERE / "questionnaire.css").read_text(encoding="utf-8")),
        script=Markup(whole),
        policy=content_policy(whole, img_src=images, connect_src=f"blob: {find_origin(post_to)}".rstrip()),
        study=Markup(json.dumps({**study, "postTo": post_to}).replace("<", "\\u003c")),
        shown=shown,
        **told,
    )
    path.write_text(text, encoding="utf-8")


def find_origin(url: str) -> str:
    """Finds the server of an http or https URL, such as `https://example.org:8080`; of an empty one, nothing.

    Raises:
        ConfigError: it is another kind of URL.
    """
    if not url:
        return ""
    found = re.match(r"(https?://(?:[\w.-]+|\[[0-9a-f:.]+\])(?::\d+)?)(?:[/?]|$)", url, re.ASCII | re.IGNORECASE)
    if found is None:
        raise ConfigError(f"--post-to {url}: must be a URL such as https://example.org/answers")
    return found.group(1)
