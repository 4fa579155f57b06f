"""Verb `kinesic export`."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from kinesic.body.config import ConfigError
from kinesic.cli import export as verb
from kinesic.cli import kinesic
from kinesic.cli.options import Planning

BML = '<bml id="b"><head id="n" lexeme="NOD" start="0"/></bml>'


@pytest.fixture(autouse=True)
def document(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A document in the current folder."""
    monkeypatch.chdir(tmp_path)
    path = tmp_path / "nod.bml"
    path.write_text(BML)
    return path


def export(*arguments: str) -> int:
    return kinesic(["export", *arguments], standalone_mode=False)


def test_exported_recording_is_named_after_the_document(capsys):
    pytest.importorskip("foxglove", reason="the extra mcap is not installed")
    assert export("nod.bml", "--to", "mcap") == 0
    assert capsys.readouterr().out == "recording: nod.mcap\n"
    assert Path("nod.mcap").read_bytes().startswith(b"\x89MCAP0")
    with pytest.raises(ConfigError, match=r"nod\.mcap"):
        export("nod.bml", "--to", "mcap")
    assert export("nod.bml", "--to", "mcap", "--performed", "--force") == 0
    assert b"/measured/joint_states" in Path("nod.mcap").read_bytes()


@pytest.mark.parametrize(("kind", "right"), [("mcap", "x.mcap"), ("rerun", "x.rrd"), ("lerobot", "x")])
def test_export_refuses_a_wrong_file_suffix_and_suggests_the_right_one(kind: str, right: str):
    with pytest.raises(ConfigError, match=f"name it {right}"):
        export("nod.bml", "--to", kind, "--out", "x.glb")


def test_export_writes_joint_trajectories_and_other_motion_files(capsys):
    for kind, name, start in (("ros", "nod.mcap", b"\x89MCAP0"), ("json", "nod.json", b"{"), ("bvh", "nod.bvh", b"HI")):
        assert export("nod.bml", "--to", kind) == 0
        assert capsys.readouterr().out == f"motion: {name}\n"
        assert Path(name).read_bytes().startswith(start)
        with pytest.raises(ConfigError, match=name):
            export("nod.bml", "--to", kind)
    with pytest.raises(
        ConfigError, match="--performed needs --to mcap or rerun or lerobot; --to csv writes the planned motion"
    ):
        export("nod.bml", "--to", "csv", "--performed")


@pytest.fixture
def steps(monkeypatch) -> list[object]:
    """List the steps of an export in order, without planning."""
    done: list[object] = []

    @contextmanager
    def show_stages() -> Iterator[Callable[[str], None]]:
        yield done.append

    def save(kind: str) -> Callable[..., None]:
        return lambda *arguments, force: done.append((kind, *arguments, force))

    monkeypatch.setattr(Planning, "set_up", lambda planning: "setup")
    monkeypatch.setattr(verb, "import_at_once", done.append)
    monkeypatch.setattr(verb, "check_file", lambda path, force: done.append(("check", path, force)))
    monkeypatch.setattr(verb, "show_stages", show_stages)
    monkeypatch.setattr(verb, "plan_input", lambda file, setup: f"plan of {file} with {setup}")
    monkeypatch.setattr(verb, "dry_run", lambda plan: f"run of {plan}")
    monkeypatch.setattr(verb.ExportedMotion, "of_plan", lambda plan: f"planned: {plan}")
    monkeypatch.setattr(verb.ExportedMotion, "of_performance", lambda run: f"performed: {run}")
    monkeypatch.setattr(verb, "save_mcap", save("mcap"))
    monkeypatch.setattr(verb, "save_rerun", save("rerun"))
    monkeypatch.setattr(verb, "save_lerobot", save("lerobot"))
    monkeypatch.setattr(verb, "check_folder", lambda path, force: done.append(("check folder", path, force)))
    monkeypatch.setattr(verb, "error_console", lambda: "screen")
    monkeypatch.setattr(verb, "print_notices", lambda plan, screen: done.append((plan, screen)))
    return done


PLAN_TEXT = "plan of nod.bml with setup"


@pytest.mark.parametrize("force", [False, True])
def test_planned_motion_is_exported_as_a_rerun_recording(steps, capsys, force):
    planning = Planning("upper22", "neutral", {})
    assert verb.export_motion("nod.bml", planning, "rerun", False, None, force) == 0
    path = Path("nod.rrd")
    assert steps == [
        "rerun",
        ("check", path, force),
        "planning",
        "writing",
        ("rerun", f"planned: {PLAN_TEXT}", path, force),
        (PLAN_TEXT, "screen"),
    ]
    assert capsys.readouterr().out == "recording: nod.rrd\n"


def test_dataset_for_lerobot_is_a_folder_named_after_the_document(steps, capsys):
    assert verb.export_motion("nod.bml", Planning("upper22", "neutral", {}), "lerobot", True, None, False) == 0
    assert steps[:2] == ["duckdb", ("check folder", Path("nod"), False)]
    assert ("lerobot", [f"performed: run of {PLAN_TEXT}"], Path("nod"), False) in steps
    assert capsys.readouterr().out == "dataset: nod\n"


def test_exported_performed_motion_is_that_of_the_twin(steps):
    path = Path("own.MCAP")
    assert verb.export_motion("nod.bml", Planning("upper22", "neutral", {}), "mcap", True, path, False) == 0
    assert steps == [
        "foxglove",
        ("check", path, False),
        "planning",
        "performing in the twin",
        "writing",
        ("mcap", f"performed: run of {PLAN_TEXT}", path, False),
        (PLAN_TEXT, "screen"),
    ]


@pytest.mark.parametrize(("name", "written"), [("-", "motion.mcap"), (f"{'a' * 120}.bml", f"{'a' * 100}.mcap")])
def test_recording_has_a_default_name_of_at_most_100_characters(steps, capsys, monkeypatch, name, written):
    monkeypatch.setattr(verb, "document_name", lambda file: "" if file == "-" else file)
    verb.export_motion(name, Planning("upper22", "neutral", {}), "mcap", False, None, False)
    assert capsys.readouterr().out == f"recording: {written}\n"
