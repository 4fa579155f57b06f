"""Inline notebook frame with a replay on a self-contained page."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from html import escape

from jinja2 import Environment, FileSystemLoader, StrictUndefined, Template
from markupsafe import Markup

from kinesic.report.content_policy import content_policy
from kinesic.report.report import Json
from kinesic.report.scene import SCENE_SCRIPTS, TEMPLATES_FOLDER, read_scripts

MAX_DISPLAY_SIZE = 1_500_000  # [bytes] largest HTML of one object in a notebook; larger ones omit the voice
MAX_DISPLAY_FRAMES = 800  # largest number of replay frames in a notebook, 16 s at the full rate
STAGE_HEIGHT = 470  # [pixels] height of the drawn robot with its playback controls
STILL_HEIGHT = 340  # [pixels] height of a still display, which has no playback controls
ROW_HEIGHT = 20  # [pixels] height of a timeline row
TIMELINE_MARGIN = 82  # [pixels] height of the time axis and the legend below the timeline
FRAME_SCRIPTS = (*SCENE_SCRIPTS, "film.js", "replay.js")  # script files of the frame, in loading order


@dataclass(frozen=True, kw_only=True)
class FrameContent:
    """Content of one inline frame: replay, timeline and voice."""

    title: str
    replay: Mapping[str, Json]  # data of the player
    scores: Sequence[Markup] = ()  # timeline for wide and for narrow frames
    rows: int = 0  # of the timeline
    zero: float = 0.0  # [s] performance time of block time 0
    compared: bool = False  # whether the replay also has the planned and the requested motion
    still: bool = False  # whether nothing moves: no time line and no controls
    voice: str | None = None  # data URI of a WAV file

    @property
    def height(self) -> int:
        """Height of the frame [pixels]."""
        if self.still:
            return STILL_HEIGHT
        return STAGE_HEIGHT + (ROW_HEIGHT * self.rows + TIMELINE_MARGIN if self.scores else 0)


def make_frame(content: FrameContent) -> str:
    """Return an inline frame that contains a complete page.

    The frame is sandboxed: its script cannot reach the notebook. A voice is left out if the display becomes too large.
    """
    page = _render(content, content.voice)
    if content.voice is not None and len(page) > MAX_DISPLAY_SIZE:
        page = _render(content, None)
    style = f"width:100%;height:{content.height}px;border:0;display:block"
    title = escape(content.title)
    return f'<iframe title="{title}" sandbox="allow-scripts" style="{style}" srcdoc="{page}"></iframe>'


def _render(content: FrameContent, voice: str | None) -> str:
    """Return the page of an iframe, escaped for its `srcdoc`."""
    player = read_scripts(FRAME_SCRIPTS)
    page = _template().render(
        content=content,
        voice=voice,
        is_muted=voice is None and content.voice is not None,
        compared=content.compared,
        remedy="",
        look=Markup((TEMPLATES_FOLDER / "page.css").read_text(encoding="utf-8")),
        player=Markup(player),
        policy=content_policy(f"\n{player}\n", img_src="data: blob:", media_src="data:"),
    )
    return escape(page, quote=True)


@cache
def _template() -> Template:
    """Return the cached HTML template of an inline notebook frame."""
    environment = Environment(
        loader=FileSystemLoader(TEMPLATES_FOLDER),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    return environment.get_template("frame.jinja")
