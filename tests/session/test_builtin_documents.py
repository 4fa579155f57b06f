from pathlib import Path

import pytest

from kinesic.bml.block import BmlError
from kinesic.session.builtin_documents import builtin_documents, locate_document, suggest_document
from kinesic.session.options import INTERACTIVE_DEFAULTS
from kinesic.session.plan import plan_document
from kinesic.session.setup import set_up


def test_built_in_documents_are_found_by_name(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert {"night", "story", "welcome"} <= builtin_documents().keys()
    assert locate_document("welcome").read_bytes().lstrip().startswith(b"<")
    assert locate_document(Path("welcome")) == builtin_documents()["welcome"]


def test_existing_file_is_preferred_to_a_built_in_document_but_a_folder_is_not(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("welcome").write_text("mine")
    Path("story").mkdir()
    assert locate_document("welcome") == Path("welcome")
    assert locate_document("story") == builtin_documents()["story"]


@pytest.mark.parametrize(
    "name", ["welcome.bml", "./x/welcome", "../welcome", "/welcome", "", ".", "Welcome", "welcome\0"]
)
def test_paths_and_unknown_names_are_not_resolved_to_built_in_documents(name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert locate_document(name) == Path(name)


@pytest.mark.parametrize(
    ("name", "hint"),
    [
        ("welcom", "; did you mean the built-in welcome?"),
        ("STORY.bml", "; did you mean the built-in story?"),
        ("xyzzy", "; built-in documents: night, story, welcome"),
        ("xyzzy.bml", ""),
        ("welcome.toml", ""),
        ("there/welcome", ""),
    ],
)
def test_missing_file_error_suggests_built_in_documents(name, hint):
    assert suggest_document(name) == hint


def test_plan_document_accepts_the_name_of_a_built_in_document_and_suggests_a_name_for_a_misspelling(
    tmp_path, monkeypatch
):
    monkeypatch.chdir(tmp_path)
    setup = set_up()
    with pytest.raises(BmlError, match="welcom: No such file or directory; did you mean the built-in welcome"):
        plan_document("welcom", setup)
    (tmp_path / "nod.bml").write_text('<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b"/>')
    monkeypatch.setattr("kinesic.session.builtin_documents.DOCUMENT_FOLDER", tmp_path)
    monkeypatch.chdir("/")
    assert str(plan_document("nod", setup)).startswith("plan of nod on upper22")


@pytest.mark.parametrize("voice", ["durations", "auto"])
@pytest.mark.parametrize("robot", ["upper22", "upper36"])
def test_welcome_document_is_planned_without_notices_of_shifted_times(robot, voice):
    plan = plan_document("welcome", set_up(robot, **{**INTERACTIVE_DEFAULTS, "voice": voice}))
    assert [notice.text for notice in plan.notices if "requested at" in notice.text] == []
