"""The dry-run report as one page that needs nothing beside itself."""

import base64
from collections.abc import Mapping
from functools import cache
from pathlib import Path

from jinja2 import Environment, FileSystemLoader, StrictUndefined, Template
from markupsafe import Markup, escape

from kinesic.controller.performance import Performance
from kinesic.expressivity.style.style import MODALITIES, RANGES
from kinesic.report.checks.servos import CONTINUOUS
from kinesic.report.conditioning import story, strays
from kinesic.report.plots.hands import hands
from kinesic.report.plots.joints import joints, still_hinges
from kinesic.report.plots.margins import margins
from kinesic.report.plots.score import score
from kinesic.report.plots.svg import spark
from kinesic.report.replay import replay_data
from kinesic.report.report import Json
from kinesic.report.servo_load import draw_load, loads
from kinesic.report.tiles import SEVERITY, format_number, tiles

FILM_TYPES = {".webp": "image/webp", ".png": "image/png", ".gif": "image/gif"}
SOUND_TYPES = {".wav": "audio/wav"}
PARTS = {"l_hand": "left hand", "r_hand": "right hand"}
FIRST_LOADS = 6  # hinges that are shown at once
FIRST_CHAPTERS = 6  # behaviours likewise
OUTCOMES = {"dropped": 0, "substituted": 1, "realised": 2}
HERE = Path(__file__).parent / "templates"
SCRIPTS = ("shapes.js", "scene.js", "film.js", "replay.js")


def write_page(
    performance: Performance,
    data: Mapping[str, Json],
    *,
    film: Path | None,
    path: Path,
    no_film: str = "not recorded",
    face: Path | None = None,
    no_face: str = "not recorded",
    voice: Path | None = None,
) -> None:
    """Writes the report for people.

    Args:
        performance: what was planned and performed, for the figures.
        data: what `report` says of it, for the words and tables.
        film: animated picture of the performance (.webp, .png or .gif), which becomes a part of the page.
        path: of the page.
        no_film: why there is none.
        face: animated picture of the face (.webp), on performance time, which the replay shows in step.
        no_face: why there is none.
        voice: what is heard (.wav), on performance time, whose clock the replay then follows.

    Raises:
        ValueError: a film or the sound is of another type.
    """
    chapters, strained = story(performance), loads(performance)
    text = _template().render(
        data=data,
        verdict=verdict(data),
        look=Markup((HERE / "page.css").read_text(encoding="utf-8")),
        player=Markup("\n".join((HERE / name).read_text(encoding="utf-8") for name in SCRIPTS)),
        replay=replay_data(performance),
        tiles=tiles(_rows(data, "checks")),
        checks=sorted(_rows(data, "checks"), key=lambda row: SEVERITY[str(row["status"])]),
        behaviours=sorted(_rows(data, "behaviours"), key=lambda row: OUTCOMES[str(row["outcome"])]),
        chapters=(chapters[:FIRST_CHAPTERS], chapters[FIRST_CHAPTERS:]),
        strays=strays(performance),
        parts=PARTS,
        modalities=MODALITIES,
        parameters=list(RANGES),
        loads=(strained[:FIRST_LOADS], strained[FIRST_LOADS:]),
        continuous=CONTINUOUS,
        draw=draw_load(performance),
        film=None if film is None else _embedded(film, FILM_TYPES),
        no_film=no_film,
        face=None if face is None else _embedded(face, {".webp": FILM_TYPES[".webp"]}),
        no_face=no_face,
        voice=None if voice is None else _embedded(voice, SOUND_TYPES),
        zero=performance.plan.trajectory.zero,
        score=score(performance),
        joints=list(joints(performance)),
        still=still_hinges(performance),
        hands=hands(performance),
        margins=margins(performance),
    )
    path.write_bytes(text.encode("utf-8", errors="replace"))


@cache
def _template() -> Template:
    """The page, ready to be filled; read once."""
    environment = Environment(
        loader=FileSystemLoader(HERE), autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True
    )
    environment.filters |= {"number": format_number, "shift": shift, "spark": spark}
    environment.filters |= {"breakable": breakable, "departure": style_departures}
    return environment.get_template("page.jinja")


def verdict(data: Mapping[str, Json]) -> str:
    """The report in one line: whether all is well, of what, and what is not.

    Args:
        data: what `report` says.
    """
    checks = _rows(data, "checks")
    failed = [row for row in checks if row["status"] == "fail"]
    dropped = [row for row in _rows(data, "behaviours") if row["outcome"] == "dropped"]
    timing = data["timing"]
    duration = format_number(timing["duration_s"]) if isinstance(timing, dict) else "?"
    counts = (
        (sum(row["status"] == "warn" for row in checks), "missed goal"),
        (len(dropped), "dropped behaviour"),
        (len(_rows(data, "warnings")), "warning"),
    )
    notes = ", ".join(f"{count} {noun}{'s' if count > 1 else ''}" for count, noun in counts if count)
    fails = ", ".join(
        f"{row['name']} {format_number(row['value'])} (limit {format_number(row['limit'])})" for row in failed
    )
    what = f"{data['input']} on {data['robot']}, {duration} s"
    return f"{'fail' if failed else 'ok'}: {what}, {fails or 'nothing fails'}{'; ' if notes else ''}{notes}"


def shift(seconds: float) -> str:
    """A difference of times in whole milliseconds, with its sign."""
    return f"{1000 * seconds:+.0f}\u2009ms".replace("-", "\u2212")


def style_departures(row: Mapping[str, Json], style: Mapping[str, Json]) -> str:
    """The numbers with which a behaviour departs from its style, by who said them.

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


def breakable(name: str) -> Markup:
    """A name that a narrow column may break after its underscores."""
    return Markup(escape(name).replace("_", Markup("_<wbr>")))


def _rows(data: Mapping[str, Json], name: str) -> list[dict[str, Json]]:
    """A table of the report."""
    table = data[name]
    return [row for row in table if isinstance(row, dict)] if isinstance(table, list) else []


def _embedded(file: Path, types: Mapping[str, str]) -> str:
    """A file as a data URI."""
    if file.suffix not in types:
        raise ValueError(f"{file} cannot be shown in a page; known: {', '.join(types)}")
    return f"data:{types[file.suffix]};base64,{base64.b64encode(file.read_bytes()).decode()}"
