"""The front door: what a user of `import kinesic` meets."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import kinesic
from kinesic import performer as front_door
from kinesic.body.command import Command
from kinesic.controller.perform import dry_run
from kinesic.controller.play import command_times
from kinesic.planning.bap import read_bap
from kinesic.sim.servo_factors import NOMINAL, Factors

NOD = (
    '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b">'
    '<head id="nod" lexeme="NOD" stroke="0.8"/><gesture id="odd" lexeme="xyzzy" stroke="1"/></bml>'
)


class Mine:
    """A sink that keeps what it gets."""

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


def test_a_plan_prints_in_a_line(plan):
    line = f"plan of block b on upper22 (joyful): {plan.duration:.2f} s, 2 behaviours, 1 dropped behaviour, 1 notice"
    assert str(plan) == line
    assert repr(plan) == f"<{line}>"


def test_a_plan_answers_for_times_and_sync_points(plan):
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
def test_a_wrong_sync_point_is_told_those_near_to_it(plan, name, said):
    with pytest.raises(KeyError, match=said):
        plan.syncs[name]


@pytest.mark.parametrize("which", ["plan", "run"])
def test_a_motion_is_saved_in_three_formats(which, request, performer, tmp_path: Path):
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


def test_a_saved_motion_is_performed(performer, plan, tmp_path: Path):
    again = performer.plan(plan.save(tmp_path / "nod.bap"))
    assert again.timeline.block.source == str(tmp_path / "nod.bap")
    assert again.duration > 0.5 * plan.duration


def test_a_run_tells_whether_all_is_well(run):
    assert run.ok
    assert {check.name for check in run.checks if check.status not in ("pass", "warn")} == {"meaning.performed"}
    assert str(run).startswith("poor: <text> on upper22")
    assert repr(run) == f"<performance of {run.plan} in the nominal twin>"


def test_a_run_that_fails_a_check_is_not_ok(run):
    touching = replace(run.measured.clearance, distances=np.full_like(run.measured.clearance.distances, -0.01))
    failed = replace(run, measured=replace(run.measured, clearance=touching))
    assert not failed.ok
    assert str(failed).startswith("fail: <text> on upper22")


def test_a_run_says_when_sync_points_were_met(run):
    met = run.syncs["nod:stroke"]
    assert met.planned == run.plan.syncs["nod:stroke"].planned
    assert abs(met.performed - met.planned) < 0.05
    np.testing.assert_allclose(run.at("nod:stroke").angles, run.plan.at("nod:stroke").angles, atol=0.02)
    with pytest.raises(KeyError, match="did you mean nod"):
        run.at("nodd:stroke")


def test_it_performs_as_before(run, plan):
    before = dry_run(plan)
    np.testing.assert_array_equal(run.measured.angles, before.measured.angles)
    assert run.reference.plan is plan


def test_a_report_is_written_and_only_a_report_is_replaced(run, tmp_path: Path):
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


def test_a_document_is_reported_in_one_step(performer, tmp_path: Path):
    run = performer.report(NOD, tmp_path / "nod", film=False)
    assert run.ok
    assert (tmp_path / "nod" / "report.html").exists()


def test_sinks_get_every_command_and_are_closed(performer, plan):
    first, second = Mine(), Mine()
    run = performer.perform(plan, sinks=[first, second])
    assert [command.time for command in first.commands] == command_times(plan.duration).tolist()
    assert len(second.commands) == len(first.commands)
    assert (first.closed, second.closed) == (1, 1)
    np.testing.assert_array_equal([command.angles for command in first.commands], run.reference.angles)
    assert any(command.face for command in first.commands)  # it blinks


def test_a_sink_that_cannot_close_is_refused_before_anything_is_planned(performer):
    with pytest.raises(TypeError, match=r"a sink needs write\(command\) and close\(\); list lacks write"):
        performer.perform("nowhere.bml", sinks=[[]])


def test_several_twins_are_told_side_by_side(performer, plan):
    run = performer.perform(plan, twin="both")
    assert {*run.data["twins"]} == {"nominal", "pessimistic"}


def test_servos_without_ports_are_refused_before_anything_performs(performer, plan):
    mine = Mine()
    with pytest.raises(kinesic.BusError, match=r"upper22 needs body=PATH"):
        performer.perform(plan, on="servos", sinks=[mine])
    assert not mine.commands


@pytest.mark.parametrize("saved", ["plan", "run"])
def test_saving_replaces_what_was_saved_nothing_of_somebody_and_through_no_link(saved: str, request, tmp_path: Path):
    motion = request.getfixturevalue(saved)
    path, link = tmp_path / "motion.csv", tmp_path / "link.csv"
    path.write_text("dear")
    with pytest.raises(kinesic.ConfigError, match=r"no motion that kinesic wrote; force=True replaces it"):
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


def test_a_report_replaces_no_folder_of_somebody(run, tmp_path: Path):
    (tmp_path / "report.json").write_text("dear")
    with pytest.raises(kinesic.ConfigError, match="not marked as kinesic's own"):
        run.report(tmp_path, film=False)
    assert (tmp_path / "report.json").read_text() == "dear"


@pytest.fixture
def servo_runs(monkeypatch) -> list[kinesic.Performance]:
    """What would have been performed on servos that are all there."""
    performed: list[kinesic.Performance] = []
    monkeypatch.setattr(front_door, "_check_ports", lambda robot, ports: None)
    monkeypatch.setattr(front_door, "_perform_on_servos", lambda run, ports: performed.append(run))
    return performed


def test_servos_do_not_move_where_a_check_of_the_twin_fails(performer, servo_runs):
    wave = '<bml id="b"><gesture id="g" lexeme="greet_wave" mode="RIGHT_HAND" stroke="1.5"/></bml>'
    failed = performer.perform(wave, on="servos", twin=Factors(stall=0.05, gain=0.05))
    assert not failed.ok
    assert servo_runs == []
    assert failed.servos is None


def test_servos_perform_once_what_the_twin_did_well(performer, plan, servo_runs):
    run = performer.perform(plan, on="servos")
    assert run.ok
    assert [each.plan for each in servo_runs] == [plan]
    servo_runs.clear()
    performer.perform(plan)
    assert servo_runs == []


def test_goals_in_the_twin_lead_by_what_its_own_servos_are_believed_to_be(performer, plan):
    late = Factors(latency=0.05)
    own, usual = performer.perform(plan, twin=late), performer.perform(plan, twin=late, believed=NOMINAL)
    assert not np.array_equal(own.measured.angles, usual.measured.angles)
    np.testing.assert_array_equal(
        performer.perform(plan, twin=late, believed=late).measured.angles, own.measured.angles
    )
    both = performer.perform(plan, twin="pessimistic", believed=NOMINAL)
    np.testing.assert_array_equal(performer.perform(plan, twin="pessimistic").measured.angles, both.measured.angles)


def test_goals_are_led_and_corrected_as_requested(performer, plan):
    mine, plain = Mine(), Mine()
    performer.perform(plan, sinks=[mine])
    performer.perform(plan, sinks=[plain], feedforward="none")
    setpoints = np.array([command.goals for command in plain.commands])
    np.testing.assert_allclose(setpoints, [command.angles for command in plain.commands], atol=1e-12)
    assert any(np.abs(command.goals - command.angles).max() > 1e-4 for command in mine.commands)
    runs = [performer.perform(plan, feedforward="none", correction=correction) for correction in (True, False)]
    assert not np.array_equal(runs[0].measured.angles, runs[1].measured.angles)


def test_a_sink_without_close_is_refused(performer, plan):
    class Half:
        def write(self, command: Command, /) -> None:
            raise AssertionError("it gets no command")

    with pytest.raises(TypeError, match="Half lacks close"):
        performer.perform(plan, sinks=[Half()])
