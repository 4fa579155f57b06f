"""Tests of texts that are too long for one plan."""

import json
from collections.abc import Callable
from pathlib import Path

import pytest

from kinesic.cli import text_parts as verb
from kinesic.intent import text_parts
from kinesic.report.batch import DocumentVerdict
from kinesic.report.text_parts import PerformedPart

from ..conftest import Ended

TEXT = "No, we have three boats. They lay there.\n\nOne of them is very big. It is new.\n"  # 17 words, two parts
SILENT = ("--no-film", "--voice", "durations", "--idle", "0")


@pytest.fixture(autouse=True)
def _short_parts(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(text_parts, "MAX_TEXT_WORDS", 12)
    monkeypatch.setattr(text_parts, "MIN_PART_WORDS", 6)
    monkeypatch.setattr(text_parts, "MAX_PART_WORDS", 10)


@pytest.fixture
def chapter(tmp_path: Path) -> Path:
    (tmp_path / "chapter.txt").write_text(TEXT)
    return tmp_path / "chapter.txt"


def test_long_text_is_performed_with_a_report_for_each_part_and_a_summary(
    kinesic: Callable[..., Ended], chapter: Path
) -> None:
    ended = kinesic("perform", chapter, *SILENT, "--out", "out")
    assert ended.code == 0, ended.err
    summary = json.loads(Path("out/parts.json").read_text())
    rows = summary["parts"]
    assert [row["folder"] for row in rows] == ["part-1", "part-2"]
    assert (summary["complete"], summary["ok"], summary["count"], summary["words"]) == (True, True, 2, 17)
    assert rows[1]["start_s"] == pytest.approx(rows[0]["duration_s"])
    reports = [json.loads(Path(f"out/{row['folder']}/report.json").read_text()) for row in rows]
    assert [report["input"] for report in reports] == [f"{chapter}, part {number} of 2" for number in (1, 2)]
    assert ended.out.splitlines()[0] == "part 1 of 2: 8 words, 0:04 min, out/part-1/report.html"
    assert ended.out.splitlines()[-1] == "summary: out/parts.json"
    assert kinesic("perform", chapter, *SILENT, "--out", "out").code == 2  # exists; needs --force


def test_interrupted_long_text_keeps_the_reports_of_performed_parts(
    kinesic: Callable[..., Ended], chapter: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    performed: list[str] = []

    def perform(plan: object, options: object, folder: Path, *others: object) -> PerformedPart:
        if performed:
            raise KeyboardInterrupt
        performed.append(folder.name)
        return PerformedPart(8, 4.0, 0, DocumentVerdict(folder.name, "performed", 0))

    monkeypatch.setattr(verb, "_perform_part", perform)
    ended = kinesic("perform", chapter, *SILENT, "--out", "out", "--json")
    assert ended.code == 130
    assert "kinesic: stopped after 1 of 2 parts" in ended.err
    summary = json.loads(ended.out)
    assert summary == json.loads(Path("out/parts.json").read_text())
    assert (summary["complete"], len(summary["parts"])) == (False, 1)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (("--on", "face"), "2 parts are performed only in the twin: `kinesic say - --on face < FILE` streams them"),
        (("--out", "scene.glb"), "scene.glb: a scene holds one part of a text, not 2: give --out FOLDER"),
        (("--learn", "factors.toml"), "--learn factors.toml: servo factors are learned from one plan, not 2 parts"),
    ],
)
def test_options_of_one_plan_are_refused_for_a_long_text(
    kinesic: Callable[..., Ended], chapter: Path, options: tuple[str, ...], message: str
) -> None:
    ended = kinesic("perform", chapter, *SILENT, *options)
    assert ended.code == 2
    assert message in ended.err


def test_plan_prints_the_timeline_of_every_part_of_a_long_text(kinesic: Callable[..., Ended], chapter: Path) -> None:
    ended = kinesic("plan", chapter, "--voice", "durations", "--idle", "0")
    assert ended.code == 0, ended.err
    assert [line[:11] for line in ended.out.splitlines() if line.startswith("part ")] == ["part 1 of 2", "part 2 of 2"]
    assert '"One of them is very big.' in ended.out
    motion = kinesic("plan", chapter, "--out", "motion.npz")
    assert motion.code == 2
    assert "motion.npz: a motion holds one part of a text, not 2: divide" in motion.err


def test_say_divides_a_long_text_on_the_command_line(
    kinesic: Callable[..., Ended], monkeypatch: pytest.MonkeyPatch
) -> None:
    texts: list[tuple[int, str]] = []
    monkeypatch.setattr(
        "kinesic.cli.perform.perform_parts", lambda parts, _, source: texts.append((len(parts), source)) or 0
    )
    assert kinesic("say", TEXT).code == 0
    assert texts == [(2, "said")]
