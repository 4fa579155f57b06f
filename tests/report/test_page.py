"""Report page with its tiles and numbers."""

import base64
import json
import re
from html.parser import HTMLParser
from pathlib import Path
from xml.sax.saxutils import quoteattr

import pytest

from kinesic.controller.dry_run import dry_run
from kinesic.metrics.dry_run import DryRun
from kinesic.planning.setup import Setup
from kinesic.report.page import (
    PAGE_SCRIPTS,
    Recordings,
    breakable,
    format_shift,
    style_departures,
    write_page,
)
from kinesic.report.report import Json, report
from kinesic.report.scene import read_scripts
from kinesic.report.verdict import format_number, verdict
from kinesic.session.plan import plan

HOSTILE_TEXT = '<script>alert("$x_1^$")</script>&--> \u6b22\u8fce'
FETCH_PATTERN = re.compile(r'(?:src|href)="(?!data:|#)|url\((?!#)|@import|fetch\(|XMLHttpRequest|import\(')
BLOCK = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="block">{}</bml>'


class Outline(HTMLParser):
    """Tags of a page with attributes and text."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.tags: list[tuple[str, dict[str, str | None]]] = []
        self.words: list[str] = []
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append((tag, dict(attrs)))

    def handle_data(self, data: str) -> None:
        self.words.append(data)


@pytest.fixture(scope="module")
def data(hurried: DryRun) -> dict[str, Json]:
    return report(hurried, source="hurried.bml")


@pytest.fixture(scope="module")
def text(hurried: DryRun, data: dict[str, Json], tmp_path_factory: pytest.TempPathFactory) -> str:
    return page(hurried, data, tmp_path_factory.mktemp("page"))


def page(performance: DryRun, data: dict[str, Json], folder: Path, film: Path | None = None) -> str:
    path = folder / "report.html"
    write_page(performance, data, Recordings(film=film), path=path)
    return path.read_text(encoding="utf-8")


def test_report_page_shows_transcript_then_verdict_then_metrics_and_films(text: str, data: dict[str, Json]) -> None:
    places = [
        text.index(mark)
        for mark in ('<p class="transcript"', "<h1>", 'class="tiles"', 'id="stage"', 'class="plot broad"', "<h2>")
    ]
    assert places == sorted(places)
    assert verdict(data) in "".join(Outline(text).words)


def test_report_page_lists_strokes_under_words_with_links_to_their_times(text: str) -> None:
    transcript = text[text.index('<p class="transcript"') : text.index("<h1>")]
    words = Outline(transcript).words
    assert [word for word in words if word in ("Hello", "there,", "welcome")] == ["Hello", "there,", "welcome"]
    assert re.search(r'welcome<a href="#stage" data-at="\d+\.\d{3}" class="realised">NOD</a>', transcript)
    assert "xyzzy" not in transcript


def test_report_page_shows_document_lines_with_the_outcomes_of_their_behaviours(known: Setup, tmp_path: Path) -> None:
    gestures = [
        f'<gesture id="{id}" lexeme="{name}"/>' for id, name in zip("abc", ("beat", "xyzzy", "point_box"), strict=True)
    ]
    lines = ('<bml id="b">', *gestures, "</bml>")
    performance = dry_run(plan("\n".join(lines), known))
    text = page(performance, report(performance, source="x.bml"), tmp_path)
    shown = re.findall(r"<pre>(.*?)</pre></td><td>(.*?)</td>", text)
    assert [line.replace("&#34;", '"').replace("&lt;", "<").replace("&gt;", ">") for line, _ in shown] == list(lines)
    fates = ["".join(Outline(fate).words) for _, fate in shown]
    assert (fates[0], fates[1], fates[4]) == ("", "realised", "")
    assert fates[3].startswith("substituted by this_index")
    assert fates[2].startswith("dropped")
    assert "xyzzy" in fates[2]


def test_report_page_contains_all_tables(text: str, data: dict[str, Json]) -> None:
    words = "".join(Outline(text).words)
    for row in (*data["checks"], *data["behaviours"], *data["warnings"]):
        shown = [value for value in row.values() if not isinstance(value, bool | dict | list | None)]
        assert all(format_number(value) in words for value in shown)
    for name in data["tracking"]["per_joint"]:
        assert name in words
    assert "No film: not recorded" in words


def test_report_page_names_the_hands_of_gestures(text: str, data: dict[str, Json]) -> None:
    rows = data["behaviours"]
    assert isinstance(rows, list)
    hands = [row["hands"] for row in rows if isinstance(row, dict) and row["type"] == "gesture"]
    assert any(hands)
    for sides in hands:
        assert isinstance(sides, list)
        names = f", {' and '.join(map(str, sides))} hand{'s' * (len(sides) > 1)}" if sides else ""
        assert f"<td>gesture{names}</td>" in text


def test_most_severe_checks_are_listed_first_on_the_report_page(text: str) -> None:
    outline = Outline(text[text.index("All ") :])
    statuses = [word for word in outline.words if word in ("fail", "warn", "pass")]
    assert statuses == sorted(statuses, key=("fail", "warn", "pass").index)
    assert text.index("xyzzy") < text.index("realised as requested")


def test_report_page_lists_changes_made_to_fit_limits(text: str) -> None:
    story = text[text.index("Changes made to fit limits") : text.index("<h2>Servos")]
    assert "rushed" in story
    assert re.search(r"hand \d+&#8239;% slower stroke", story)
    assert re.search(r"(speed|acceleration|jerk|duty|position) of ", story)


def test_empty_section_of_the_report_page_is_one_sentence(calm: DryRun, tmp_path: Path) -> None:
    text = page(calm, report(calm, source="calm.bml"), tmp_path)
    story = text[text.index("Changes made to fit limits") : text.index("<h2>Servos")]
    assert "None: every sync point is at its requested time" in story
    assert "<table>" not in story


def test_report_page_loads_no_other_files(text: str) -> None:
    tags = Outline(text).tags
    assert not FETCH_PATTERN.search(re.sub(r"<svg.*?</svg>", "", text, flags=re.DOTALL))
    assert not {"link", "iframe", "object", "embed"} & {tag for tag, _ in tags}
    assert not [attributes for tag, attributes in tags if tag in ("script", "img") and "src" in attributes]
    values = [value for _, attributes in tags for name, value in attributes.items() if not name.startswith("xmlns")]
    assert not [value for value in values if value and "//" in value]
    assert len(text) < 1_500_000


def test_report_page_has_the_elements_that_its_player_script_looks_up(text: str) -> None:
    script = read_scripts(PAGE_SCRIPTS)
    given = {attributes["data-part"] for _, attributes in Outline(text).tags if "data-part" in attributes}
    assert set(re.findall(r'part\("([^"]+)"\)', script)) == given
    ids = {attributes["id"] for _, attributes in Outline(text).tags if "id" in attributes}
    assert set(re.findall(r'getElementById\("([^"]+)"\)', script)) <= ids


def test_equal_performances_give_equal_report_pages(
    hurried: DryRun, data: dict[str, Json], text: str, tmp_path: Path
) -> None:
    assert page(hurried, data, tmp_path) == text


@pytest.fixture(scope="module")
def media(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder with films of twin and face, and a voice."""
    folder = tmp_path_factory.mktemp("media")
    for name in ("film.webp", "face.webp", "speech.wav"):
        (folder / name).write_bytes(name.encode())
    return folder


@pytest.fixture(scope="module")
def sources(hurried: DryRun, data: dict[str, Json], media: Path) -> list[tuple[str, str | None]]:
    """Return tag and source of each picture and sound of a page."""
    path = media / "x.html"
    everything = Recordings(film=media / "film.webp", face=media / "face.webp", voice=media / "speech.wav")
    write_page(hurried, data, everything, path=path)
    tags = Outline(path.read_text(encoding="utf-8")).tags
    return [(tag, attributes["src"]) for tag, attributes in tags if tag in ("img", "audio")]


def embedded(path: Path, kind: str) -> str:
    return f"data:{kind};base64,{base64.b64encode(path.read_bytes()).decode()}"


def test_film_is_embedded_in_the_report_page(
    hurried: DryRun, data: dict[str, Json], media: Path, sources: list[tuple[str, str | None]]
) -> None:
    assert ("img", embedded(media / "film.webp", "image/webp")) in sources
    with pytest.raises(ValueError, match=r"film\.avi cannot be shown"):
        page(hurried, data, media, media / "film.avi")


def test_film_with_sound_is_embedded_as_a_video_in_the_report_page(
    hurried: DryRun, data: dict[str, Json], tmp_path: Path
) -> None:
    (tmp_path / "film.mp4").write_bytes(b"film")
    outline = Outline(page(hurried, data, tmp_path, tmp_path / "film.mp4"))
    shown = [tag for tag, found in outline.tags if (found.get("src") or "").startswith("data:video/mp4;base64,")]
    assert shown == ["video"]


def test_sound_and_face_film_are_embedded_in_the_report_page(
    hurried: DryRun, data: dict[str, Json], media: Path, sources: list[tuple[str, str | None]]
) -> None:
    assert ("img", embedded(media / "face.webp", "image/webp")) in sources
    assert ("audio", embedded(media / "speech.wav", "audio/wav")) in sources
    assert len(sources) == len(set(sources)) == 3
    with pytest.raises(ValueError, match=r"speech\.mp3 cannot be shown"):
        write_page(hurried, data, Recordings(voice=media / "speech.mp3"), path=media / "y.html")


def test_report_page_names_voice_servo_parameters_and_missing_face_film(text: str, data: dict[str, Json]) -> None:
    (spoken,) = data["speech"]
    assert spoken["voice"]
    assert spoken["phonemes"]
    words = "".join(Outline(text).words)
    assert f"Speech s: voice {spoken['voice']}, without sound" in words
    assert "No film of the face: not recorded" in words
    assert "Servo parameters assumed for the setpoints: as in the data sheets." in words


def test_markup_in_behaviour_ids_is_escaped_on_the_report_page(known: Setup, tmp_path: Path) -> None:
    gesture = f'<gesture id={quoteattr(HOSTILE_TEXT)} lexeme="beat" start="0" stroke="0.1"/>'
    performance = dry_run(plan(BLOCK.format(gesture), known))
    text = page(performance, report(performance, source=HOSTILE_TEXT), tmp_path)
    assert "<script>alert" not in text
    assert HOSTILE_TEXT in "".join(Outline(text).words)
    replay = json.loads(re.findall(r'id="replay">(.*?)</script>', text, re.DOTALL)[0])
    assert {mark["behaviour"] for mark in replay["marks"]} == {HOSTILE_TEXT}


def test_colour_variables_of_plots_are_defined_by_the_report_page(text: str) -> None:
    used = set(re.findall(r"var\((--\w+)\)", text))
    assert used <= set(re.findall(r"(--\w+):", text))
    figures = "".join(re.findall(r"<svg.*?</svg>", text, flags=re.DOTALL))
    assert not re.findall(r"(?:fill|stroke): #(?!ffffff|000000)\w{6}", figures)


def test_empty_block_has_a_report_page(known: Setup, tmp_path: Path) -> None:
    performance = dry_run(plan(BLOCK.format(""), known))
    text = page(performance, report(performance, source="empty.bml"), tmp_path)
    assert "The block is empty." in text
    assert "Nothing is performed." in text
    assert "Changes made to fit limits" not in text


def test_report_page_shows_time_shifts_with_a_sign_and_breaks_long_names_at_underscores() -> None:
    assert [format_shift(seconds) for seconds in (0.0834, -0.0152)] == ["+83\u2009ms", "\u221215\u2009ms"]
    assert breakable("l_<b>") == "l_<wbr>&lt;b&gt;"


def test_report_page_lists_expressivity_parameters_that_differ_from_the_style(known: Setup, tmp_path: Path) -> None:
    bml = BLOCK.format('<head id="h" lexeme="NOD" start="0" kinesic:power="-0.5" kinesic:spatial="0"/>')
    performance = dry_run(plan(bml.replace("<bml", '<bml kinesic:temporal="0.25"'), known))
    data = report(performance, source="x.bml")
    (row,) = data["behaviours"]
    assert style_departures(row, data["style"]) == "temporal 0.25 (block); power \u22120.5 (behaviour)"
    assert style_departures({**row, "manner": None}, data["style"]) == ""
    assert '<th class="wide">style</th>' in page(performance, data, tmp_path)


def test_behaviour_table_has_no_style_column_if_all_behaviours_have_the_style(text: str) -> None:
    assert '<th class="wide">style</th>' not in text
