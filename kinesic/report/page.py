"""Writes the dry-run report as one page that needs nothing beside itself."""

import base64
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from jinja2 import Environment, FileSystemLoader, StrictUndefined, Template
from markupsafe import Markup, escape

from kinesic.controller.performance import Performance
from kinesic.expressivity.style.style import MODALITIES, RANGES
from kinesic.report.checks.servos import CONTINUOUS, draw_load, loads
from kinesic.report.conditioning import find_deviations, story
from kinesic.report.content_policy import content_policy
from kinesic.report.document_lines import document_lines
from kinesic.report.plots.hands import hands
from kinesic.report.plots.joints import HingeCurves, joints, still_hinges
from kinesic.report.plots.margins import margins
from kinesic.report.plots.score import BROAD, NARROW, score
from kinesic.report.plots.spark import spark
from kinesic.report.replay import replay_data
from kinesic.report.report import Json
from kinesic.report.scene import SCENE_SCRIPTS, TEMPLATES, read_scripts
from kinesic.report.shapes import shapes_made
from kinesic.report.transcript import transcribe
from kinesic.report.verdict import format_number, gravity_of, rows_of, verdict

FILM_TYPES = {".webp": "image/webp", ".png": "image/png", ".gif": "image/gif", ".mp4": "video/mp4"}
SOUND_TYPES = {".wav": "audio/wav"}
PARTS = {"l_hand": "left hand", "r_hand": "right hand"}
FIRST_LOADS = 6  # hinges that are shown at once
SEEN = 0.5  # [deg] from which on a part of the body is told to move
FIRST_CHAPTERS = 6  # behaviours likewise
OUTCOMES = {"dropped": 0, "substituted": 1, "partly": 2, "realised": 3}
SCRIPTS = (*SCENE_SCRIPTS, "film.js", "replay.js")
TITLES = {
    "meaning": "Meaning",
    "amplitude": "Amplitude",
    "limits": "Limits",
    "collision": "Clearance",
    "timing": "Timing",
    "tracking": "Tracking",
    "measured": "On the robot",
    "servo": "Servos",
}  # else the word itself
SMALLER = {"s": ("ms", 1000.0), "m": ("mm", 1000.0)}  # for values below 1
SYMBOLS = {"deg": "\u00b0", "times": "\u00d7"}
TIGHT = {"\u00b0"}  # units that stand at the figure


@dataclass(frozen=True, kw_only=True)
class Recordings:
    """What was recorded of a performance, on performance time."""

    film: Path | None = None  # film of the twin: .webp, .png, .gif or .mp4
    why_no_film: str = "not recorded"
    face: Path | None = None  # animated picture of the face, .webp, which the replay shows on the head, in step
    why_no_face: str = "not recorded"
    voice: Path | None = None  # what is heard, .wav, whose clock the replay then follows


NO_RECORDINGS = Recordings()


def write_page(
    performance: Performance, data: Mapping[str, Json], recordings: Recordings = NO_RECORDINGS, *, path: Path
) -> None:
    """Writes the report for people.

    Args:
        performance: what was planned and performed, for the figures.
        data: what `report` says of it, for the words and tables.
        recordings: become parts of the page.
        path: of the page.

    Raises:
        ValueError: a film or the sound is of another type.
    """
    chapters, strained, rows = story(performance), loads(performance), rows_of(data, "behaviours")
    player, curves = read_scripts(SCRIPTS), HingeCurves.of(performance)
    text = _template().render(
        data=data,
        verdict=verdict(data),
        look=Markup((TEMPLATES / "page.css").read_text(encoding="utf-8")),
        player=Markup(player),
        policy=content_policy(f"\n{player}\n", img_src="data: blob:", media_src="data:"),
        replay=replay_data(performance),
        tiles=tiles(rows_of(data, "checks")),
        checks=sorted(rows_of(data, "checks"), key=gravity_of),
        behaviours=sorted(rows, key=lambda row: OUTCOMES[str(row["outcome"])]),
        fates={row["id"]: row for row in rows},
        transcript=transcribe(performance.plan),
        document=document_lines(performance.plan.timeline.block),
        chapters=(chapters[:FIRST_CHAPTERS], chapters[FIRST_CHAPTERS:]),
        deviations=find_deviations(performance),
        parts=PARTS,
        modalities=MODALITIES,
        parameters=list(RANGES),
        loads=(strained[:FIRST_LOADS], strained[FIRST_LOADS:]),
        continuous=CONTINUOUS,
        draw=draw_load(performance),
        film=_embedded(recordings.film, FILM_TYPES),
        no_film=recordings.why_no_film,
        face=_embedded(recordings.face, {".webp": FILM_TYPES[".webp"]}),
        no_face=recordings.why_no_face,
        voice=_embedded(recordings.voice, SOUND_TYPES),
        zero=performance.plan.trajectory.zero,
        scores=[drawn for layout in (BROAD, NARROW) if (drawn := score(performance, layout))],
        joints=list(joints(performance, curves)),
        still=still_hinges(performance, curves),
        hands=hands(performance),
        margins=margins(performance),
    )
    path.write_bytes(text.encode("utf-8", errors="replace"))


@cache
def _template() -> Template:
    """The page, ready to be filled; read once."""
    environment = Environment(
        loader=FileSystemLoader(TEMPLATES),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters |= {"number": format_number, "shift": format_shift, "spark": spark}
    environment.filters |= {
        "breakable": breakable,
        "departure": style_departures,
        "body": body_beside,
        "shapes": shapes_made,
    }
    return environment.get_template("page.jinja")


def format_shift(seconds: float) -> str:
    """Formats a difference of times in whole milliseconds, with its sign."""
    return f"{1000 * seconds:+.0f}\u2009ms".replace("-", "\u2212")


def body_beside(row: Mapping[str, Json]) -> str:
    """Says what the rest of the body does beside the hands of one behaviour; empty when it does nothing.

    Args:
        row: of the report's behaviours.
    """
    body = row["body"]
    if not isinstance(body, dict):
        return ""
    angles = ((part, body[f"{part}_deg"]) for part in ("head", "trunk", "shoulders"))
    moved = [f"{part} {angle:.0f}°" for part, angle in angles if isinstance(angle, float) and abs(angle) >= SEEN]
    faces, left = body["face"], body["gave_way"]
    shown = list(faces) if isinstance(faces, dict) else []
    gave = [f"{part} left to others" for part in left] if isinstance(left, list) else []
    return ", ".join([*moved, *shown, *gave])


def style_departures(row: Mapping[str, Json], style: Mapping[str, Json]) -> str:
    """Lists the numbers with which a behaviour departs from its style, by who said them.

    Args:
        row: of the behaviour.
        style: of the performance, as the report has it.
    """
    manner = row["manner"]
    if not isinstance(manner, dict):
        return ""
    values, sources, own = manner["values"], manner["sources"], style[str(manner["modality"])]
    if not (isinstance(values, dict) and isinstance(sources, dict) and isinstance(own, dict)):
        return ""
    said: dict[str, list[str]] = {}
    for name, value in values.items():
        if value != own[name]:
            said.setdefault(str(sources[name]), []).append(f"{name} {format_number(value)}".replace("-", "\u2212"))
    return "; ".join(f"{', '.join(numbers)} ({source})" for source, numbers in said.items())


WHOLE_AT_ONE = (
    "collision.pace",
    "collision.performed",
    "meaning.performed",
)  # 1, which is their limit, where all is well


@dataclass(frozen=True)
class Tile:
    """One group of checks."""

    title: str
    status: str
    name: str  # of the check that matters most
    value: str
    unit: str
    limit: str  # with its unit and the side it is on
    where: str
    others: int  # checks in the group beside it


def tiles(checks: Sequence[Mapping[str, Json]]) -> list[Tile]:
    """Makes one tile for each group of checks, by the part of their names before the dot, as they come.

    Args:
        checks: rows of the report.
    """
    groups: dict[str, list[Mapping[str, Json]]] = {}
    for row in checks:
        groups.setdefault(str(row["name"]).split(".")[0], []).append(row)
    return [_tile(TITLES.get(name, name.capitalize()), rows) for name, rows in groups.items()]


def _tile(title: str, rows: list[Mapping[str, Json]]) -> Tile:
    worst = min(rows, key=lambda row: (gravity_of(row), -_nearness(row)))
    unit = str(worst["unit"])
    value, shown = quantity(worst["value"], unit)
    limit, beside = quantity(worst["limit"], unit)
    if value == limit and worst["status"] != "pass":
        value = f"{worst['value']:.7g}"  # so that it shows on which side it is
    side = "at least" if worst["at_least"] else "at most"
    return Tile(
        title=title,
        status=str(worst["status"]),
        name=str(worst["name"]).split(".", 1)[-1].replace("_", " "),
        value=value,
        unit=shown,
        limit=f"{side} {limit}{'' if beside in TIGHT else ' '}{beside}".rstrip(),
        where=str(worst["where"]),
        others=len(rows) - 1,
    )


def _nearness(row: Mapping[str, Json]) -> float:
    """Share of a limit that is used up: 1 is the limit; 0 for what is whole unless something went wrong."""
    if row["name"] in WHOLE_AT_ONE:
        return 0.0
    value, limit = row["value"], row["limit"]
    if not isinstance(value, int | float) or not isinstance(limit, int | float) or not value or not limit:
        return 0.0
    return limit / value if row["at_least"] else value / limit


def quantity(value: Json, unit: str) -> tuple[str, str]:
    """Formats a value and its unit as people write them."""
    if isinstance(value, int | float) and unit in SMALLER and abs(value) < 1.0:
        unit, scale = SMALLER[unit]
        value = scale * value
    if isinstance(value, float) and unit == "ratio":
        return f"{value:.2f}", ""
    brief = f"{value:.2g}" if isinstance(value, float) and abs(value) < 0.1 else format_number(value)
    return brief.replace("-", "\u2212"), SYMBOLS.get(unit, unit)


def breakable(name: str) -> Markup:
    """Lets a narrow column break a name after its underscores."""
    return Markup(escape(name).replace("_", Markup("_<wbr>")))


def _embedded(file: Path | None, types: Mapping[str, str]) -> str | None:
    """A file as a data URI, if there is one."""
    if file is None:
        return None
    if file.suffix not in types:
        raise ValueError(f"{file} cannot be shown in a page; known: {', '.join(types)}")
    return f"data:{types[file.suffix]};base64,{base64.b64encode(file.read_bytes()).decode()}"
