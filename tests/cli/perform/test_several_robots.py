"""Performance by several robots with `kinesic perform --robot A,B`."""

import json

import numpy as np
import pytest
from PIL import Image

from kinesic.cli.several_robots import _CombinedFilm, part_size
from kinesic.files.film_settings import FilmSettings

NOD = b'<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b"><head id="h" lexeme="NOD" start="0.2"/></bml>'


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    report_folder = tmp_path_factory.mktemp("several")
    (report_folder / "nod.bml").write_bytes(NOD)
    return report_folder


def test_perform_with_several_robots_writes_one_report_folder_per_robot(kinesic_in, folder):
    ended = kinesic_in(folder, "perform", "nod.bml", "--robot", "upper22,human", "--out", "both", "--no-film")
    assert ended.code == 0, ended.err
    reports = [json.loads((folder / "both" / name / "report.json").read_text()) for name in ("upper22", "human")]
    assert [report["robot"] for report in reports] == ["upper22", "human"]
    assert all(report["timing"]["zero_s"] >= 0.0 for report in reports)
    assert not (folder / "both" / "film.webp").exists()
    again = kinesic_in(folder, "perform", "nod.bml", "--robot", "upper22,human", "--out", "both", "--no-film")
    assert again.code == 2
    assert "--force" in again.err


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("nod.bml", "--robot", "upper22,humon"), "no robot humon; did you mean human?"),
        (("nod.bml", "--robot", "human,human"), "each robot may be named once"),
        (("nod.bml", "--robot", "upper22,human", "--on", "servos"), "name one robot for --on servos or face"),
        (("nod.bml", "--robot", "upper22,human", "--json"), "--json reports one robot"),
        (("-", "--robot", "upper22,human"), "several robots need a file"),
        (("nod.bml", "--robot", "upper22,human", "--learn", "a.toml"), "learned factors belong to one robot"),
    ],
)
def test_options_unsupported_by_several_robots_are_refused(kinesic_in, folder, arguments, message: str):
    ended = kinesic_in(folder, "perform", *arguments)
    assert ended.code == 2
    assert message in ended.err


def test_option_json_is_accepted_if_perform_names_only_one_robot(kinesic_in, folder):
    ended = kinesic_in(folder, "perform", "missing.bml", "--robot", "upper22", "--json")
    assert ended.code == 2
    assert "missing.bml" in ended.err
    assert "one robot" not in ended.err


def test_combined_film_of_two_robots_aligns_their_block_starts(tmp_path):
    """Combine two films that change their colour at block time zero."""
    for name, zero, width, colour in (("a", 0.5, 16, (250, 0, 0)), ("b", 0.25, 30, (0, 0, 250))):
        (tmp_path / name).mkdir()
        timing = {"timing": {"zero_s": zero, "duration_s": 1.0}}
        (tmp_path / name / "report.json").write_text(json.dumps(timing))
        black, bright = Image.new("RGB", (width, 12)), Image.new("RGB", (width, 12), colour)
        durations = [round(1000 * zero), 1000 - round(1000 * zero)]
        black.save(
            tmp_path / name / "film.webp", save_all=True, append_images=[bright], duration=durations, lossless=True
        )
    pictures = np.array(
        list(_CombinedFilm([tmp_path / "a", tmp_path / "b"], FilmSettings(size=(32, 18), rate=30.0)).pictures)
    )
    assert pictures.shape[1:3] == (12, 16 + 16), "the wider film shows its middle"
    left, right = pictures[:, :, :16].max(axis=(1, 2, 3)) > 99, pictures[:, :, 16:].max(axis=(1, 2, 3)) > 99
    assert (left == right).all()
    assert not left[14]
    assert left[15:].all()
    assert len(pictures) == 38  # The second film is delayed by 0.25 s and ends at 1.25 s.


@pytest.mark.parametrize(
    ("film", "count", "part"),
    [
        ((960, 540), 2, (480, 360)),
        ((1280, 720), 2, (640, 480)),
        ((1280, 240), 2, (320, 240)),
        ((900, 900), 3, (300, 225)),
    ],
)
def test_films_side_by_side_fit_into_the_requested_film_size(film, count, part):
    assert part_size(film, count) == part


def test_combined_film_is_not_written_through_a_symlink(kinesic_in, tmp_path):
    (tmp_path / "nod.bml").write_bytes(NOD)
    (tmp_path / "mine.webp").write_bytes(b"mine")
    (tmp_path / "both").mkdir()
    (tmp_path / "both" / "film.webp").symlink_to(tmp_path / "mine.webp")
    ended = kinesic_in(tmp_path, "perform", "nod.bml", "--robot", "upper22,human", "--out", "both", "--force")
    assert ended.code == 2
    assert "links are never followed" in ended.err
    assert (tmp_path / "mine.webp").read_bytes() == b"mine"


def test_robot_folders_stay_inside_the_output_folder(kinesic_in, tmp_path):
    (tmp_path / "nod.bml").write_bytes(NOD)
    (tmp_path / "...toml").write_text('[robot]\nname = "mine"\nextends = "upper22"\n')
    ended = kinesic_in(tmp_path, "perform", "nod.bml", "--robot", "...toml,upper22", "--out", "a/b", "--no-film")
    assert ended.code == 0, ended.err
    assert sorted(path.name for path in (tmp_path / "a" / "b").iterdir()) == ["robot", "upper22"]
    assert [path.name for path in (tmp_path / "a").iterdir()] == ["b"]
