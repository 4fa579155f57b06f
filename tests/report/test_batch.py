import json
import os
import sys
from pathlib import Path

import msgspec
import pytest

from kinesic.report.batch import DocumentTask, DocumentVerdict, documents, judge_document
from kinesic.report.checks import Check
from kinesic.report.output import default_folder
from kinesic.session.setup import set_up
from kinesic.tasks.journal import Journal

CHECK = Check("limits.speed", "pass", 0.5, 1.0, "ratio", "l_elbow_flexion at 1.00 s")
VERDICTS = {
    "a": DocumentVerdict("a.bml", "performed", 0, (("gesture", "realised"),), (CHECK,), report="out/a.json"),
    "b": DocumentVerdict("b\nline.bml", "refused", 0, error="b.bml:1:1: no \u2028 element"),
}


@pytest.fixture
def journal(tmp_path):
    return Journal(tmp_path / "finished.jsonl", DocumentVerdict)


def test_recorded_verdicts_of_a_batch_are_read_back(journal):
    assert journal.read() == {}
    for key, verdict in VERDICTS.items():
        journal.append(key, verdict)
    assert journal.read() == VERDICTS


@pytest.mark.parametrize("cut", [1, 2, 30, 90])
def test_incomplete_batch_record_is_ignored(journal, tmp_path, cut):
    journal.append("a", VERDICTS["a"])
    journal.append("b", VERDICTS["b"])
    path = tmp_path / "finished.jsonl"
    path.write_bytes(path.read_bytes()[:-cut])
    assert journal.read() == {"a": VERDICTS["a"]}


@pytest.mark.parametrize("line", [b"{}\n", b"null\n", b"\n", b'{"key": "c", "entry": {"file": 3}}\n', b"\xff\n"])
def test_unreadable_batch_record_is_ignored(journal, tmp_path, line):
    journal.append("a", VERDICTS["a"])
    with (tmp_path / "finished.jsonl").open("ab") as file:
        file.write(line)
    journal.append("b", VERDICTS["b"])
    assert journal.read() == VERDICTS


def test_rewritten_batch_journal_contains_only_the_given_records(journal, tmp_path):
    for key, verdict in VERDICTS.items():
        journal.append(key, verdict)
    journal.rewrite({"b": VERDICTS["b"]})
    assert journal.read() == {"b": VERDICTS["b"]}
    assert [path.name for path in tmp_path.iterdir()] == ["finished.jsonl"]


def test_documents_in_a_folder_are_recognised_by_suffix_or_content(tmp_path):
    texts = {
        "a.bml": "anything",
        "b.xml": "<anything/>",
        "c.mary": '<?xml version="1.0"?>\n<!-- <fml> -->\n<!DOCTYPE bml>\n<bml id="b"/>',
        "d": '\ufeff<BML id="b"/>',
        "e.txt": "<x:fml-apml xmlns:x='y'></x:fml-apml>",
        "f.html": "<html><bml/></html>",
        "g.py": "text = '<bml/>'",
        "h.txt": "<bmlx/>",
    }
    for name, text in texts.items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    os.mkfifo(tmp_path / "i.pipe")
    assert [path.name for path in documents((tmp_path,))] == ["a.bml", "b.xml", "c.mary", "d", "e.txt"]
    assert documents((tmp_path / "f.html",)) == [tmp_path / "f.html"]


@pytest.mark.parametrize(("size", "is_document"), [(4095, True), (4096, True), (4097, False), (9000, False)])
def test_file_is_recognised_as_bml_only_if_its_first_tag_ends_within_four_kilobytes(
    tmp_path, size: int, is_document: bool
):
    (tmp_path / "story.txt").write_text("<bml>".rjust(size) + "</bml>", encoding="ascii")
    assert documents((tmp_path,)) == [tmp_path / "story.txt"] * is_document


def test_report_name_of_a_long_document_name_is_valid(tmp_path):
    for name in ("a" * 251 + ".bml", "\N{GRINNING FACE}" * 62 + ".bml", "...bml"):
        (tmp_path / name).write_text("<bml/>")
        report = DocumentTask.of(tmp_path / name, "").name
        assert "/" not in report
        (tmp_path / f"{report}.crash.txt").write_text("")


def test_folder_name_of_a_long_document_name_is_valid(tmp_path):
    for name in ("a" * 251 + ".bml", "\N{GRINNING FACE}" * 62 + ".bml", "...bml"):
        folder = default_folder(f"/somewhere/{name}")
        assert folder.parent == Path("out")
        assert folder.name not in (".", "..")
        (tmp_path / folder).mkdir(parents=True)


@pytest.mark.skipif(sys.platform != "linux", reason="other systems refuse file names that are not UTF-8")
@pytest.mark.parametrize("text", ['<bml id="b"><head id="h" lexeme="NOD"/></bml>', "<bml", None])
def test_document_whose_file_name_is_not_utf8_is_judged_and_recorded(journal, tmp_path, text):
    path = tmp_path / os.fsdecode(b"b\xff.bml")
    if text is not None:
        path.write_text(text)
    task = DocumentTask.of(path, "settings")
    verdict, data = judge_document(path, set_up(), content=task.content)
    journal.append(task.key, verdict)
    assert journal.read() == {task.key: verdict}
    assert verdict.file == f"{tmp_path}/b\\udcff.bml"
    assert verdict.outcome == ("performed" if text and text.endswith(">") else "refused")
    assert msgspec.json.decode(json.dumps(data)) == data
    assert task.key != DocumentTask.of(tmp_path / os.fsdecode(b"b\xfe.bml"), "settings").key
