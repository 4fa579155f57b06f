"""Written files of a performance: first the report, later the films."""

import base64
import json
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

from kinesic.body.config import ConfigError
from kinesic.controller.dry_run import dry_run
from kinesic.files.film_settings import FilmSettings
from kinesic.metrics.dry_run import DryRun
from kinesic.report import output
from kinesic.report.films import FACE_RATE, TwinFilm
from kinesic.report.output import NOT_REQUESTED, NOT_YET, add_films, default_folder, face_film, rewrite, write_report
from kinesic.report.report import Json, report
from kinesic.session.plan import plan
from kinesic.session.setup import set_up

SPOKEN_BLOCK = (
    '<bml id="b"><speech id="s"><text>Well, hello.</text></speech><faceLexeme id="f" lexeme="smile" start="0.2"/></bml>'
)


@pytest.fixture(scope="module")
def data(calm: DryRun) -> dict[str, Json]:
    return report(calm, source="calm.bml")


@pytest.fixture(scope="module")
def smiling(known) -> DryRun:
    """Return a performance with a face and a sound."""
    return dry_run(plan(SPOKEN_BLOCK, known, source="smile.bml"))


def page(folder: Path) -> str:
    return (folder / "report.html").read_text(encoding="utf-8")


@dataclass
class Drawing:
    """Test double of drawing processes that finish or fail at once."""

    why: str = ""
    jobs: dict | None = None
    processes: object = None

    def draw(self, jobs, processes, progress):
        self.jobs, self.processes = dict(jobs), processes
        progress(1.0)
        for path in jobs if not self.why else ():
            path.write_bytes(b"film " + path.name.encode())
        return dict.fromkeys(jobs, self.why)


@pytest.fixture
def drawing(monkeypatch) -> Drawing:
    result = Drawing()
    monkeypatch.setattr(output, "draw_films", result.draw)
    return result


@pytest.mark.parametrize("film", [False, True])
def test_report_page_and_measurements_are_written_into_a_new_folder(calm, data, tmp_path: Path, film: bool):
    folder = tmp_path / "out" / "calm"
    written = write_report(calm, data, folder, film=film)
    assert sorted(path.name for path in folder.iterdir() if not path.name.startswith(".")) == [
        "measured.npz",
        "report.html",
        "report.json",
    ]
    assert json.loads(written.report.read_text(encoding="utf-8")) == json.loads(json.dumps(data))
    assert "\n " in written.report.read_text(encoding="utf-8")
    assert (written.report, written.page, written.measured) == (
        folder / "report.json",
        folder / "report.html",
        folder / "measured.npz",
    )
    assert (written.film, written.face, written.voice) == (None, None, None)
    assert written.why_no_film == written.why_no_face == (NOT_YET if film else NOT_REQUESTED)
    with np.load(written.measured) as log:
        assert len(log["times"]) == len(calm.measured.times)


def test_existing_report_is_replaced_only_with_force_and_survives_write_errors(calm, data, tmp_path: Path, monkeypatch):
    folder = tmp_path / "calm"
    write_report(calm, data, folder)
    with pytest.raises(ConfigError):
        write_report(calm, data, folder)
    write_report(calm, data | {"input": "again.bml"}, folder, force=True)
    assert json.loads((folder / "report.json").read_text())["input"] == "again.bml"

    def fail(*given, **named):
        raise OSError("disk full")

    monkeypatch.setattr(output, "write_page", fail)
    with pytest.raises(ConfigError, match=r"calm/report\.html: disk full"):
        write_report(calm, data, folder, force=True)
    assert json.loads((folder / "report.json").read_text())["input"] == "again.bml"
    assert page(folder).startswith("<!DOCTYPE html>")
    with pytest.raises(ConfigError, match=r"none/report\.html: disk full"):
        write_report(calm, data, tmp_path / "none")
    assert [path.name for path in tmp_path.iterdir()] == ["calm"]


def test_speech_sound_is_written_next_to_the_report(smiling, tmp_path: Path, monkeypatch):
    heard = object()
    monkeypatch.setattr(output, "sound", lambda plan: heard)
    monkeypatch.setattr(output, "write_wav", lambda found, path: path.write_text(f"wav {found is heard}"))
    written = write_report(smiling, report(smiling, source="smile.bml"), tmp_path / "smile")
    assert written.voice == tmp_path / "smile" / "speech.wav"
    assert written.voice.read_text() == "wav True"
    monkeypatch.setattr(output, "sound", lambda plan: None)
    silent = write_report(smiling, report(smiling, source="smile.bml"), tmp_path / "silent")
    assert silent.voice is None
    assert not (tmp_path / "silent" / "speech.wav").exists()


def test_films_are_added_to_the_report_and_its_page(smiling, drawing, tmp_path: Path):
    said, shares, processes = report(smiling, source="smile.bml"), [], object()
    written = write_report(smiling, said, tmp_path / "smile")
    settings = FilmSettings(rate=25.0, face="rendered")
    whole = add_films(written, smiling, said, processes, settings=settings, progress=shares.append)
    folder = tmp_path / "smile"
    assert (whole.film, whole.face) == (folder / settings.name, folder / "face.webp")
    assert whole.film.read_bytes() == f"film {settings.name}".encode()
    assert whole.face.read_bytes() == b"film face.webp"
    assert (whole.why_no_film, whole.why_no_face) == ("", "")
    assert (whole.report, whole.page, whole.measured) == (written.report, written.page, written.measured)
    for path in (whole.film, whole.face):
        assert base64.b64encode(path.read_bytes()).decode() in page(folder)
    assert shares == [1.0]
    assert drawing.processes is processes
    face, film = drawing.jobs.values()
    assert {path.name for path in drawing.jobs} == {settings.name, "face.webp"}
    assert film.after == next(iter(drawing.jobs))
    assert film.sound == written.voice
    assert face.rate == min(25.0, FACE_RATE)
    assert whole.face_on_head


def test_robot_film_does_not_wait_for_the_separate_face_film_by_default(smiling, drawing, tmp_path: Path):
    said = report(smiling, source="smile.bml")
    whole = add_films(write_report(smiling, said, tmp_path / "smile"), smiling, said, object())
    assert whole.face == tmp_path / "smile" / "face.webp"
    assert not whole.face_on_head
    assert [job.after for job in drawing.jobs.values()] == [None, None]
    assert 'class="filmed"' in page(tmp_path / "smile")


def test_report_states_why_a_film_could_not_be_drawn(smiling, drawing, tmp_path: Path):
    drawing.why = "no OpenGL here"
    said = report(smiling, source="smile.bml")
    written = write_report(smiling, said, tmp_path / "smile")
    whole = add_films(written, smiling, said, object())
    assert (whole.film, whole.face) == (None, None)
    assert whole.why_no_film == whole.why_no_face == "no OpenGL here"
    assert not list((tmp_path / "smile").glob("*.webp"))
    assert "no OpenGL here" in page(tmp_path / "smile")


def test_face_of_a_robot_without_a_screen_is_filmed_only_if_the_plan_moves_the_face(
    calm, smiling, data, drawing, tmp_path: Path, monkeypatch
):
    assert face_film(calm.plan).robot is None  # its face is on a screen, and so always filmed
    monkeypatch.setattr(output, "build_face_screen", lambda robot: None)
    monkeypatch.setattr(output, "needs_face", lambda plan: plan is not calm.plan)
    assert face_film(calm.plan) is None
    film = face_film(smiling.plan)
    assert film.robot is smiling.plan.setup.robot
    assert film.rate == FACE_RATE
    assert face_film(smiling.plan, 10.0).rate == 10.0
    whole = add_films(write_report(calm, data, tmp_path / "calm"), calm, data, object())
    assert (whole.face, whole.why_no_face) == (None, "nothing is requested of it")
    assert whole.film is not None
    assert len(drawing.jobs) == 1


@pytest.mark.soak
def test_human_is_filmed_without_its_skin_if_scipy_is_missing(drawing, tmp_path: Path, monkeypatch):
    monkeypatch.setitem(sys.modules, "scipy", None)
    nodding = dry_run(plan('<bml id="b"><head id="h" lexeme="NOD" stroke="0.5"/></bml>', set_up("human")))
    said = report(nodding, source="nod.bml")
    add_films(write_report(nodding, said, tmp_path / "nod"), nodding, said, object())
    (film,) = (job for job in drawing.jobs.values() if isinstance(job, TwinFilm))
    assert film.robot.skin is None


def test_written_report_is_rewritten_in_place_with_new_data(calm, data, tmp_path: Path):
    written = write_report(calm, data, tmp_path / "calm")
    before = page(tmp_path / "calm")
    rewrite(written, calm, data | {"input": "other.bml"})
    assert json.loads(written.report.read_text(encoding="utf-8"))["input"] == "other.bml"
    assert page(tmp_path / "calm") != before


def test_report_file_paths_in_another_folder_keep_their_file_names(smiling, drawing, tmp_path: Path):
    said = report(smiling, source="smile.bml")
    whole = add_films(write_report(smiling, said, tmp_path / "smile"), smiling, said, object())
    moved = whole.within(Path("elsewhere"))
    for name in ("report", "page", "measured", "film", "face"):
        assert getattr(moved, name) == Path("elsewhere") / getattr(whole, name).name
    assert moved.voice == (whole.voice and Path("elsewhere") / whole.voice.name)
    empty = write_report(smiling, said, tmp_path / "again", film=False).within(Path("elsewhere"))
    assert (empty.film, empty.face) == (None, None)


def test_report_folder_is_named_after_the_source_and_the_date():
    assert default_folder("a/hello.bml").parent == Path("out")
    assert default_folder("a/hello.bml").name.startswith("hello-20")
    assert default_folder("-").name.startswith("--20")
    assert default_folder("").name.startswith("stdin-20")
