"""Performer: the main Python interface."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import kinesic
from kinesic import performer as front_door
from kinesic.body.command import Command
from kinesic.controller.dry_run import dry_run
from kinesic.planning.files.bap import read_bap
from kinesic.sim.servo_factors import NOMINAL_FACTORS, Factors

NOD = (
    '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b">'
    '<head id="nod" lexeme="NOD" stroke="0.8"/><gesture id="odd" lexeme="xyzzy" stroke="1"/></bml>'
)


class Mine:
    """Sink that records its commands."""

    def __init__(self) -> None:
        self.commands: list[Command] = []
        self.closed = 0

    def write(self, command: Command, /) -> None:
        self.commands.append(command)

    def close(self) -> None:
        self.closed += 1


@pytest.fixture(scope="module")
def performer() -> kinesic.Performer:
    return kinesic.Performer("upper22", style="joyful")


@pytest.fixture(scope="module")
def plan(performer) -> kinesic.Plan:
    return performer.plan(NOD)


@pytest.fixture(scope="module")
def run(performer, plan) -> kinesic.Performance:
    return performer.perform(plan)


def test_str_and_repr_of_a_plan_are_one_line_with_duration_and_counts_of_behaviours(plan):
    line = f"plan of block b on upper22 (joyful): {plan.duration:.2f} s, 2 behaviours, 1 dropped behaviour, 1 notice"
    assert str(plan) == line
    assert repr(plan) == f"<{line}>"


def test_plan_returns_sync_points_by_name_and_postures_by_sync_point_or_time(plan):
    sync = plan.syncs["nod:stroke"]
    assert (sync.behaviour, sync.sync, sync.name) == ("nod", "stroke", "nod:stroke")
    assert plan.syncs[plan.syncs.index(sync)] is sync
    here, there = plan.at("nod:stroke"), plan.at(plan.trajectory.zero + sync.planned)
    np.testing.assert_array_equal(here.angles, there.angles)
    assert np.abs(here.angles).max() > 0.0


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("nod:strok", "behaviour nod has no sync point strok; did you mean stroke"),
        ("nud:stroke", "no behaviour nud has sync points; did you mean nod"),
        ("nod", "behaviour nod has no sync point ; known: end, ready"),
    ],
)
def test_unknown_sync_point_error_suggests_similar_names(plan, name, said):
    with pytest.raises(KeyError, match=said):
        plan.syncs[name]


@pytest.mark.parametrize("which", ["plan", "run"])
def test_motion_of_a_plan_or_performance_is_saved_as_npz_csv_and_bap(which, request, performer, tmp_path: Path):
    motion = request.getfixturevalue(which)
    with np.load(motion.save(tmp_path / "motion.npz")) as file:
        times, angles = file["times"], file["angles"]
        assert file["names"].tolist() == list(performer.robot.skeleton.names)
    states = np.array([motion.at(float(time)).angles for time in times])
    np.testing.assert_allclose(angles, states, atol=1e-12)
    rows = motion.save(str(tmp_path / "motion.csv")).read_text(encoding="utf-8").splitlines()
    assert len(rows) == len(times) + 1
    frames = read_bap(motion.save(tmp_path / "motion.bap"), performer.robot)
    assert abs(frames.times[-1] - times[-1]) < 0.05
    with pytest.raises(kinesic.ConfigError, match=r"cannot write .txt; known: .npz, .csv, .bap"):
        motion.save(tmp_path / "motion.txt")


def test_plan_saved_as_a_bap_file_can_be_planned_again(performer, plan, tmp_path: Path):
    again = performer.plan(plan.save(tmp_path / "nod.bap"))
    assert again.timeline.block.source == str(tmp_path / "nod.bap")
    assert again.duration > 0.5 * plan.duration


def test_performance_with_a_poor_but_no_failed_check_is_ok(run):
    assert run.ok
    assert {check.name for check in run.checks if check.status not in ("pass", "warn")} == {"meaning.performed"}
    assert str(run).startswith("poor: <text> on upper22")
    assert repr(run) == f"<performance of {run.plan} in the nominal twin>"


def test_performance_with_a_failed_check_is_not_ok(run):
    touching = replace(run.measured.clearance, distances=np.full_like(run.measured.clearance.distances, -0.01))
    failed = replace(run, measured=replace(run.measured, clearance=touching))
    assert not failed.ok
    assert str(failed).startswith("fail: <text> on upper22")


def test_performance_result_contains_measured_times_of_sync_points(run):
    met = run.syncs["nod:stroke"]
    assert met.planned == run.plan.syncs["nod:stroke"].planned
    assert abs(met.performed - met.planned) < 0.05
    np.testing.assert_allclose(run.at("nod:stroke").angles, run.plan.at("nod:stroke").angles, atol=0.02)
    with pytest.raises(KeyError, match="did you mean nod"):
        run.at("nodd:stroke")


def test_performer_perform_gives_the_same_measurements_as_a_dry_run(run, plan):
    before = dry_run(plan)
    np.testing.assert_array_equal(run.measured.angles, before.measured.angles)
    assert run.reference.plan is plan


def test_performance_report_replaces_an_earlier_report_but_no_folder_with_user_files(run, tmp_path: Path):
    folder = tmp_path / "nod"
    written = run.report(folder, film=False)
    assert written.page.read_text(encoding="utf-8").startswith("<!DOCTYPE html>")
    data = json.loads(written.report.read_text(encoding="utf-8"))
    assert data["ok"] is run.ok
    assert [check["name"] for check in data["checks"]] == [check.name for check in run.checks]
    run.report(folder, film=False)
    (folder / "mine.txt").write_text("mine", encoding="utf-8")
    with pytest.raises(kinesic.ConfigError, match=r"holds mine.txt, which no report has written"):
        run.report(folder, film=False)
    assert (folder / "mine.txt").exists()


def test_performer_reports_a_document_in_one_call(performer, tmp_path: Path):
    run = performer.report(NOD, tmp_path / "nod", film=False)
    assert run.ok
    assert (tmp_path / "nod" / "report.html").exists()


def test_sinks_given_to_the_performer_get_each_command_and_are_closed_once(performer, plan):
    first, second = Mine(), Mine()
    run = performer.perform(plan, sinks=[first, second])
    assert [command.time for command in first.commands] == plan.command_times.tolist()
    assert len(second.commands) == len(first.commands)
    assert (first.closed, second.closed) == (1, 1)
    np.testing.assert_array_equal([command.angles for command in first.commands], run.reference.angles)
    assert any(command.face for command in first.commands)  # the face blinks


def test_sink_without_write_is_refused_before_planning(performer):
    with pytest.raises(TypeError, match=r"a sink needs write\(command\) and close\(\); list lacks write"):
        performer.perform("nowhere.bml", sinks=[[]])


def test_performance_in_both_twins_returns_data_of_both(performer, plan):
    run = performer.perform(plan, twin="both")
    assert {*run.data["twins"]} == {"nominal", "pessimistic"}


def test_performance_on_servos_without_ports_is_refused_before_motion(performer, plan):
    mine = Mine()
    with pytest.raises(kinesic.BusError, match=r"upper22 needs body=PATH"):
        performer.perform(plan, on="servos", sinks=[mine])
    assert not mine.commands


@pytest.mark.parametrize("saved", ["plan", "run"])
def test_saved_motion_replaces_user_files_only_with_force_and_follows_no_symlink(saved: str, request, tmp_path: Path):
    motion = request.getfixturevalue(saved)
    path, link = tmp_path / "motion.csv", tmp_path / "link.csv"
    path.write_text("dear")
    with pytest.raises(kinesic.ConfigError, match=r"is no motion written by kinesic; use force=True"):
        motion.save(path)
    assert path.read_text() == "dear"
    assert motion.save(path, force=True) == motion.save(path) == path
    whole = path.read_text()
    assert whole.startswith("time_s,")
    link.symlink_to(path)
    with pytest.raises(kinesic.ConfigError, match="is a link"):
        motion.save(link)
    with pytest.raises(kinesic.ConfigError, match=r"cannot write \.txt"):
        motion.save(tmp_path / "motion.txt")
    assert path.read_text() == whole


def test_performance_report_is_refused_in_a_folder_with_a_report_file_of_the_user(run, tmp_path: Path):
    (tmp_path / "report.json").write_text("dear")
    with pytest.raises(kinesic.ConfigError, match="not marked as kinesic's own"):
        run.report(tmp_path, film=False)
    assert (tmp_path / "report.json").read_text() == "dear"


def test_performance_report_into_a_symlink_is_refused_without_naming_the_files_behind_it(run, tmp_path: Path):
    (tmp_path / "outside").mkdir()
    (tmp_path / "outside" / "letter.txt").write_text("dear")
    (tmp_path / "nod").symlink_to(tmp_path / "outside")
    with pytest.raises(kinesic.ConfigError, match="is a link") as refusal:
        run.report(tmp_path / "nod", film=False)
    assert "letter" not in str(refusal.value)


def test_performance_report_into_a_folder_that_vanishes_during_the_check_is_written(run, tmp_path: Path, monkeypatch):
    folder = tmp_path / "nod"
    folder.mkdir()
    is_dir = Path.is_dir

    def remove_after_check(path: Path) -> bool:
        was_there = is_dir(path)
        if path == folder and was_there:
            folder.rmdir()
        return was_there

    monkeypatch.setattr(Path, "is_dir", remove_after_check)
    assert run.report(folder, film=False).page.exists()


@pytest.fixture
def servo_runs(monkeypatch) -> list[kinesic.Performance]:
    """List the performances that would have moved real servos."""
    performed: list[kinesic.Performance] = []
    monkeypatch.setattr(front_door, "_check_ports", lambda robot, ports: None)
    monkeypatch.setattr(front_door, "_perform_on_servos", lambda run, ports: performed.append(run))
    return performed


def test_performer_does_not_run_servos_after_a_failed_check_in_the_twin(performer, servo_runs):
    wave = '<bml id="b"><gesture id="g" lexeme="greet_wave" mode="RIGHT_HAND" stroke="1.5"/></bml>'
    failed = performer.perform(wave, on="servos", twin=Factors(stall=0.02, gain=0.02))
    assert not failed.ok
    assert servo_runs == []
    assert failed.servos is None


def test_performer_runs_servos_once_and_only_if_requested_after_a_successful_twin_run(performer, plan, servo_runs):
    run = performer.perform(plan, on="servos")
    assert run.ok
    assert [servo_run.plan for servo_run in servo_runs] == [plan]
    servo_runs.clear()
    performer.perform(plan)
    assert servo_runs == []


def test_feedforward_uses_the_servo_factors_of_a_user_twin_but_data_sheet_values_for_a_built_in_twin(performer, plan):
    late = Factors(latency=0.05)
    own, usual = performer.perform(plan, twin=late), performer.perform(plan, twin=late, believed=NOMINAL_FACTORS)
    assert not np.array_equal(own.measured.angles, usual.measured.angles)
    np.testing.assert_array_equal(
        performer.perform(plan, twin=late, believed=late).measured.angles, own.measured.angles
    )
    both = performer.perform(plan, twin="pessimistic", believed=NOMINAL_FACTORS)
    np.testing.assert_array_equal(performer.perform(plan, twin="pessimistic").measured.angles, both.measured.angles)


def test_feedforward_and_correction_options_change_setpoints_and_motion(performer, plan):
    mine, plain = Mine(), Mine()
    performer.perform(plan, sinks=[mine])
    performer.perform(plan, sinks=[plain], feedforward="none")
    setpoints = np.array([command.setpoints for command in plain.commands])
    np.testing.assert_allclose(setpoints, [command.angles for command in plain.commands], atol=1e-12)
    assert any(np.abs(command.setpoints - command.angles).max() > 1e-4 for command in mine.commands)
    runs = [performer.perform(plan, feedforward="none", correction=correction) for correction in (True, False)]
    assert not np.array_equal(runs[0].measured.angles, runs[1].measured.angles)


def test_sink_without_close_is_refused(performer, plan):
    class Half:
        def write(self, command: Command, /) -> None:
            raise AssertionError("it gets no command")

    with pytest.raises(TypeError, match="Half lacks close"):
        performer.perform(plan, sinks=[Half()])
