"""Decisions of `kinesic perform --on servos`, without real or virtual servos."""

import json
from contextlib import nullcontext
from pathlib import Path
from types import SimpleNamespace

import pytest

from kinesic.cli import perform
from kinesic.cli.servos.memory import ServoMemory
from kinesic.controller.dry_run import dry_runs
from kinesic.metrics.dry_run import DryRun
from kinesic.report import output
from kinesic.report.report import report
from kinesic.session.plan import plan
from kinesic.sim.servo_factors import NOMINAL_FACTORS

NOD = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b"><head id="h" lexeme="NOD" stroke="0.8"/></bml>'
ON_SERVOS = ("perform", "nod.bml", "--no-film", "--out", "out", "--on", "servos", "--port", "/dev/nothing")


@pytest.fixture(scope="module")
def runs() -> tuple[DryRun, ...]:
    return dry_runs(plan(NOD), (NOMINAL_FACTORS,))


class Drive:
    """Test double of the servos that records performances and parameter identification."""

    def __init__(self, performance: DryRun) -> None:
        self.ending, self.times, self.performance = "ended", [0.0, 0.01, 0.02], performance
        self.driven: list[tuple[object, ...]] = []
        self.learned_from: list[object] = []
        self.kept: list[Path | None] = []
        self.printed: list[tuple[object, ...]] = []

    def perform(self, performance, paths, folder, *, quiet, listener):
        self.driven.append((performance, paths, folder, quiet, listener))
        return self

    def identify(self, log, robot, believed):
        self.learned_from.append(log)
        return SimpleNamespace(log=log)

    def keep(self, identification, folder=None):
        self.kept.append(folder)
        return Path("kept.toml")

    def print(self, identification, path, *, to_stderr):
        self.printed.append((path, to_stderr))


@pytest.fixture
def drive(runs: tuple[DryRun, ...], tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Drive:
    (tmp_path / "nod.bml").write_text(NOD, encoding="utf-8")
    made = Drive(runs[0])
    monkeypatch.setattr(perform, "_perform_in_twins", lambda *_, **__: runs)
    monkeypatch.setattr(output, "write_page", lambda *_, path: path.touch())
    monkeypatch.setattr(perform, "perform_on_servos", made.perform)
    monkeypatch.setattr(perform, "follow_servos", lambda plan, preview: ("follow", plan, preview))
    monkeypatch.setattr(perform, "live_log", lambda run: ("log of the servos", run))
    monkeypatch.setattr(perform, "live_checks", lambda run: ())
    monkeypatch.setattr(perform, "identify_servos", made.identify)
    monkeypatch.setattr(perform, "print_learned_factors", made.print)
    monkeypatch.setattr(perform, "add_identification", lambda data, identification: data)
    monkeypatch.setattr(ServoMemory, "keep", lambda _, identification, folder=None: made.keep(identification, folder))

    def write(servo_run, data, written, identification):
        return servo_run, data | {"learned": identification is not None}, Path("servos.npz")

    monkeypatch.setattr(perform, "write_servo_run", lambda *given: write(*given)[1:])
    return made


def test_plan_that_passes_all_twin_checks_is_performed_on_servos(kinesic, drive: Drive, runs: tuple[DryRun, ...]):
    ended = kinesic(*ON_SERVOS)
    assert ended.code == 0, ended.err
    ((performance, paths, folder, quiet, listener),) = drive.driven
    assert performance is runs[0]
    assert paths == {"body": Path("/dev/nothing")}
    assert (folder, quiet, listener) == (Path("out"), False, ("follow", runs[0].plan, None))
    assert "servos: servos.npz" in ended.out
    assert "the servos did not move" not in ended.err


def test_servos_are_not_driven_after_a_failed_check(kinesic, drive: Drive, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(perform, "report", lambda *given, **named: report(*given, **named) | {"ok": False})
    ended = kinesic(*ON_SERVOS)
    assert ended.code == 1
    assert "the servos did not move: a check of the twin failed" in ended.err
    assert drive.driven == []
    assert drive.printed == []


def test_perform_exits_with_3_if_the_servos_fail(kinesic, drive: Drive):
    drive.ending = "failed"
    assert kinesic(*ON_SERVOS).code == 3


def test_servo_parameters_are_learned_from_the_log_of_the_servos(kinesic, drive: Drive):
    ended = kinesic(*ON_SERVOS, "--json")
    assert json.loads(ended.out)["learned"]
    assert drive.learned_from == [("log of the servos", drive)]
    assert drive.kept == [Path("out")]
    assert drive.printed == [(Path("kept.toml"), True)]
    assert drive.driven[0][3]
    assert "servos: servos.npz" in ended.err


@pytest.mark.parametrize(("options", "samples"), [(("--learn", "none"), 3), ((), 1)])
def test_servo_parameters_are_not_learned_from_one_sample_or_with_learn_none(
    kinesic, drive: Drive, options: tuple[str, ...], samples: int
):
    drive.times = drive.times[:samples]
    ended = kinesic(*ON_SERVOS, "--json", *options)
    assert not json.loads(ended.out)["learned"]
    assert drive.learned_from == drive.kept == drive.printed == []


def test_two_samples_suffice_to_learn_servo_parameters(kinesic, drive: Drive):
    drive.times = drive.times[:2]
    assert json.loads(kinesic(*ON_SERVOS, "--json").out)["learned"]


def test_servo_parameters_are_learned_from_the_twin_only_if_option_learn_names_a_file(
    kinesic, drive: Drive, runs: tuple[DryRun, ...]
):
    twin_only = ("perform", "nod.bml", "--no-film", "--force", "--out", "out")
    assert kinesic(*twin_only).code == 0
    assert drive.learned_from == []
    assert kinesic(*twin_only, "--learn", "learned.toml").code == 0
    assert len(drive.learned_from) == len(drive.kept) == 1
    assert drive.printed == [(Path("kept.toml"), False)]
    assert drive.driven == []


def test_performance_on_servos_learns_parameters_from_the_servo_log_alone(kinesic, drive: Drive):
    assert kinesic(*ON_SERVOS, "--learn", "learned.toml").code == 0
    assert drive.learned_from == [("log of the servos", drive)]


def test_existing_report_folder_is_refused_before_servos_move(kinesic, drive: Drive, tmp_path: Path):
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / "notes.txt").write_text("mine")
    ended = kinesic(*ON_SERVOS)
    assert ended.code == 2
    assert drive.driven == []


def test_perform_on_the_face_without_servos_plays_the_plan_in_a_window(
    kinesic, drive: Drive, runs: tuple[DryRun, ...], monkeypatch
):
    played: list[tuple[object, ...]] = []
    monkeypatch.setattr(perform, "preview_window", lambda *_, **__: nullcontext("window"))
    monkeypatch.setattr(perform, "play_whole", lambda *given: played.append(given))
    assert kinesic("perform", "nod.bml", "--no-film", "--out", "out", "--on", "face").code == 0
    assert played == [(runs[0].plan, "window")]


@pytest.mark.parametrize("count", [1, 2])
def test_tracking_errors_of_several_twins_are_printed_side_by_side(runs, capsys, count):
    (run,) = runs
    perform._print_report(count * (run,), None, report(run, source="nod.bml", seed=0))
    headings = [line.split() for line in capsys.readouterr().out.splitlines() if line.split()[:1] == ["error"]]
    assert headings == [["error", run.twin_name, run.twin_name]] * (count - 1)


@pytest.mark.parametrize("servo_log", [None, Path("out/servos.npz")])
def test_perform_prints_written_paths_and_why_the_face_film_is_missing(capsys, servo_log):
    """Print paths with and without a log of the servos."""
    files = {name: Path("out", name) for name in ("report", "page", "measured")}
    written = output.WrittenPaths(**files, film=Path("out/film.webp"), why_no_face="no face")
    perform._print_paths(written, servo_log, to_stderr=False)
    names = ["film", "face", "measured", *(["servos"] if servo_log else []), "report", "page"]
    lines = capsys.readouterr().out.splitlines()
    assert [line.partition(":")[0] for line in lines] == names
    assert lines[:2] == ["film: out/film.webp", "face: none (no face)"]
