"""Arguments that `kinesic studio` refuses, and the files of its page."""

import json
import pickle
import re
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import pytest

from kinesic.body.config import CONFIGS, ConfigError
from kinesic.cli.live import studio as studio_verb
from kinesic.cli.live.access_options import AccessOptions
from kinesic.cli.live.folder_gestures import read_folder
from kinesic.cli.live.studio import StudioPlanning, open_studio
from kinesic.cli.options import Performers, Planning
from kinesic.serve.address import Address
from kinesic.session.setup import set_up
from kinesic.studio.page import page_files


@pytest.mark.parametrize(
    ("file", "folder", "listen", "why"),
    [
        ("a.txt", None, "127.0.0.1:0", "NAME.bml"),
        ("gone.bml", None, "127.0.0.1:0", "no such file"),
        ("a.bml", "other", "127.0.0.1:0", "outside the folder"),
        (None, "gone", "127.0.0.1:0", "no such folder"),
        (None, None, "none", "needs an address"),
    ],
)
def test_invalid_studio_arguments_are_refused(tmp_path, file, folder, listen, why):
    (tmp_path / "a.bml").write_text("<bml/>")
    (tmp_path / "other").mkdir()
    with pytest.raises(ConfigError, match=why):
        open_studio(
            None if file is None else tmp_path / file,
            Planning("upper22", "neutral", {}),
            AccessOptions(listen, None, (), texts=False),
            Performers(frozenset({"twin"}), ()),
            None if folder is None else tmp_path / folder,
            sound=False,
            browser=False,
            rules=(),
        )


@pytest.fixture
def snapshot(tmp_path):
    """Planning snapshot of a studio with its robot, style and targets in one folder."""
    (tmp_path / "mine.toml").write_text('[robot]\nname = "mine"\nextends = "upper22"\n')
    (tmp_path / "manner.toml").write_text((CONFIGS / "styles" / "calm.toml").read_text())
    (tmp_path / "targets.toml").write_text("cup = [0.3, 0.0, 1.0]\n")
    planning = Planning(
        str(tmp_path / "mine.toml"), str(tmp_path / "manner.toml"), {"targets": tmp_path / "targets.toml"}
    )
    return replace(StudioPlanning.of(planning), folder=tmp_path)


def test_studio_snapshot_keeps_robot_style_and_targets_if_their_files_change(snapshot):
    folder, before = snapshot.folder, snapshot.set_up()
    (folder / "mine.toml").write_text('[robot]\nname = "mine"\nextends = "upper36"\n[collision]\nclearance = 0.0\n')
    (folder / "manner.toml").write_text("nothing")
    (folder / "targets.toml").unlink()
    unpickled = pickle.loads(pickle.dumps(snapshot)).set_up()  # as in another process
    for after in (snapshot.set_up(), unpickled):
        assert len(after.robot.skeleton.rest) == 22
        assert after.robot.min_clearance == before.robot.min_clearance > 0.0
        assert after.style == before.style
        assert after.targets["cup"].tolist() == [0.3, 0.0, 1.0]
    assert len(pickle.dumps(snapshot)) < 64_000  # fits into a pipe's buffer


def test_valid_gestures_of_the_studio_folder_are_loaded_and_invalid_files_reported(snapshot):
    gesture = 'category = "beat"\n[[gesture]]\nid = "{}"\nkeys = [{{ right = {{ at = [0.5, {}, 0.5] }} }}]\n'
    (snapshot.folder / "good.toml").write_text(gesture.format("good", 0.3))
    (snapshot.folder / "far.toml").write_text(gesture.format("far", "1e308"))
    (snapshot.folder / "digits.toml").write_text("category = " + "1" * 5000)
    (snapshot.folder / "dotted.toml").write_text(".".join(["a"] * 450_000) + " = 1")
    (snapshot.folder / "large.toml").write_text("#" * 1_000_001)
    (snapshot.folder / "link.toml").symlink_to(snapshot.folder / "good.toml")
    lexicon = snapshot.set_up().lexicon
    assert "good" in lexicon.forms_by_id
    assert "far" not in lexicon.forms_by_id
    faults = "\n".join(read_folder(snapshot.folder).faults)
    for name, why in (("far", "arm lengths"), ("digits", "digits"), ("dotted", "32 parts"), ("large", "at most 1 MB")):
        assert re.search(rf"{name}\.toml: .*{why}", faults), faults
    for name in ("good", "mine", "manner", "link"):
        assert f"{name}.toml" not in faults, faults


def test_studio_page_data_contains_the_robot_its_gestures_and_example_documents():
    setup = set_up("upper36")
    files = page_files(setup.robot, setup.lexicon, document="mine.bml")
    assert {"/", "/studio.js", "/studio.css", "/panels.css", "/figures.json", "/icon.svg", "/studio.json"} == set(files)
    page_data = json.loads(files["/studio.json"].body)
    robot = page_data["robot"]
    assert len(robot["hinges"]) == len(robot["rest"]) == len(robot["lower"]) == len(robot["upper"]) == 36
    assert [robot["names"][robot["hands"][side]][0] for side in "lr"] == ["l", "r"]
    assert page_data["document"] == "mine.bml"
    assert page_data["examples"][0]["name"] == "welcome"
    assert len(page_data["examples"]) >= 9
    assert len({gesture["id"] for gesture in page_data["gestures"]}) > 200


ACCESS_OPTIONS = AccessOptions("127.0.0.1:0", "secret", (), texts=False)
PERFORMERS = Performers(frozenset({"twin"}), ())


@pytest.fixture
def served(monkeypatch) -> list[dict[str, object]]:
    """List the arguments with which each studio page is served."""
    pages: list[dict[str, object]] = []

    def serve(*arguments: object, **options: object) -> int:
        pages.append({"arguments": arguments, **options})
        return 5

    setup = SimpleNamespace(robot="robot", lexicon="lexicon")
    monkeypatch.setattr(StudioPlanning, "of", lambda planning: StudioPlanning("robot", "style", None, {}))
    monkeypatch.setattr(StudioPlanning, "set_up", lambda snapshot: setup)
    monkeypatch.setattr(studio_verb, "page_files", lambda *arguments, **options: (arguments, options))
    monkeypatch.setattr(studio_verb, "open_and_serve", serve)
    monkeypatch.setattr(studio_verb, "show_page", lambda *arguments: pages.append({"arguments": arguments}) or 6)
    monkeypatch.setattr(studio_verb, "ask_robot", lambda address, token: f"robot at {address} with {token}")
    monkeypatch.setattr(studio_verb, "set_up_like", lambda *arguments: setup if arguments[1:] == REMOTE_ROBOT else None)
    return pages


REMOTE_ROBOT = ("robot at 127.0.0.1:9 with secret", Address("127.0.0.1", 9))


def open_page(
    file: Path | None, folder: Path | None = None, *, browser: bool = False, connect: str | None = None
) -> int:
    planning = Planning("upper22", "calm", {})
    return open_studio(file, planning, ACCESS_OPTIONS, PERFORMERS, folder, True, browser, ("rule",), connect)


def test_studio_serves_the_folder_of_its_document(served, tmp_path):
    (tmp_path / "a.bml").write_text("<bml/>")
    assert open_page(tmp_path / "a.bml") == 5
    (page,) = served
    snapshot, *others = page["arguments"]
    assert others == [ACCESS_OPTIONS, PERFORMERS, True, ("rule",)]
    assert (snapshot.folder, page["folder"], page["armed"]) == (tmp_path, tmp_path, False)
    assert page["files"] == (("robot", "lexicon"), {"style": "calm", "document": "a.bml"})


@pytest.mark.parametrize("folder", [None, "documents"])
def test_studio_without_a_document_serves_the_current_or_a_given_folder(served, tmp_path, monkeypatch, capsys, folder):
    monkeypatch.chdir(tmp_path)
    place = tmp_path / (folder or "")
    place.mkdir(exist_ok=True)
    (place / "wrong.toml").write_text("category = " + "1" * 5000)
    open_page(None, None if folder is None else Path(folder))
    (page,) = served
    assert page["folder"] == place
    assert page["files"][1]["document"] is None
    printed = capsys.readouterr()
    assert printed.out == ""
    assert printed.err.startswith("skipped: ")
    assert "wrong.toml" in printed.err


@pytest.mark.parametrize("browser", [False, True])
def test_studio_prints_its_address_and_opens_the_browser_only_on_request(
    served, tmp_path, monkeypatch, capsys, browser
):
    shown: list[str] = []
    monkeypatch.setattr(studio_verb, "open_in_browser", shown.append)
    open_page(None, tmp_path, browser=browser)
    served[0]["announce"](Address("127.0.0.1", 88))
    printed = capsys.readouterr()
    assert (printed.out, printed.err) == ("", "the studio: http://127.0.0.1:88/\n")
    assert shown == ["http://127.0.0.1:88/"] * browser


def test_studio_with_a_remote_server_shows_the_robot_of_the_remote_server(served):
    assert open_page(None, connect="127.0.0.1:9") == 6
    (page,) = served
    own, robot, files, _ = page["arguments"]
    assert (own, robot) == (Address("127.0.0.1", 0), Address("127.0.0.1", 9))
    assert files == (("robot", "lexicon"), {"style": "calm"})
