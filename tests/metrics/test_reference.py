"""Stored and computed arrays of a dry run."""

from dataclasses import fields

import numpy as np
import pytest

from kinesic.body.command import Command, SetpointRows
from kinesic.body.robot import SIDES, Robot
from kinesic.metrics.arrival import compute_part_paths
from kinesic.metrics.dry_run import DryRun
from kinesic.metrics.reference import Reference
from kinesic.sim.twin import Twin


def test_dry_run_stores_only_measured_arrays_and_recomputes_planned_ones(calm: DryRun) -> None:
    shape = calm.measured.angles.shape
    kept = {field.name: getattr(calm.measured, field.name) for field in fields(calm.measured)}
    goals = [rows.counts for rows in kept.values() if isinstance(rows, SetpointRows)]
    assert [rows.dtype for rows in goals] == [np.int16] * 2
    assert sum(rows.nbytes for rows in goals) == calm.measured.setpoints.nbytes / 2
    assert [name for name, rows in kept.items() if getattr(rows, "shape", ()) == shape] == ["angles", "velocities"]
    planned = Reference(calm.plan, calm.reference.times, calm.reference.duties)
    assert np.ptp(planned.angles) > 0.0
    assert [name for name, rows in vars(planned).items() if getattr(rows, "shape", ()) == shape] == ["duties"]


def test_reference_sampled_in_windows_equals_the_reference_sampled_at_once(
    calm: DryRun, monkeypatch: pytest.MonkeyPatch
) -> None:
    whole = Reference(calm.plan, calm.reference.times, calm.reference.duties)
    expected = {name: getattr(whole, name) for name in ("angles", "velocities", "accelerations", "moving")}
    some = np.array([0, 5, 20])
    some_velocities, torques = whole.velocities_of(some), whole.holding_torques[1]
    for name, commands in (("MAX_CACHED_COMMANDS", 64), ("COMMANDS_PER_WINDOW", 16)):
        monkeypatch.setattr(f"kinesic.metrics.reference.{name}", commands)
    parts = Reference(calm.plan, calm.reference.times, calm.reference.duties)
    for name, samples in expected.items():
        assert samples.shape[0] == len(parts.times), name
        assert np.array_equal(getattr(parts, name), samples), name
    assert np.array_equal(parts.velocities_of(some), some_velocities)
    assert np.array_equal(parts.holding_torques[1], torques)
    assert [name for name, rows in vars(parts).items() if getattr(rows, "shape", ()) == parts.duties.shape] == [
        "duties",
        "moving",
    ]


@pytest.mark.parametrize("window", [16, 10_000])
def test_planned_paths_are_those_of_the_wrists_head_and_torso(
    calm: DryRun, monkeypatch: pytest.MonkeyPatch, window: int
) -> None:
    monkeypatch.setattr("kinesic.metrics.reference.MAX_CACHED_COMMANDS", window)
    monkeypatch.setattr("kinesic.metrics.reference.COMMANDS_PER_WINDOW", window)
    reference = Reference(calm.plan, calm.reference.times, calm.reference.duties)
    robot, angles = calm.plan.setup.robot, calm.plan.trajectory.sample(calm.reference.times)[0]
    origins = robot.skeleton.frames(angles).origins
    for side in SIDES:
        np.testing.assert_allclose(reference.hands[side], origins[:, robot.arm(side).wrist], atol=1e-9)
    expected = compute_part_paths(angles, robot, reference.hands)
    assert reference.paths.keys() == expected.keys()
    for part, path in expected.items():
        np.testing.assert_allclose(reference.paths[part], path, atol=1e-9)


@pytest.mark.parametrize(("count", "batches"), [(4096, 1), (4097, 5)])
def test_reference_motion_of_over_4096_samples_is_sampled_in_batches(calm: DryRun, count: int, batches: int) -> None:
    times = np.linspace(0.0, calm.plan.trajectory.duration, count)
    duties = np.broadcast_to(0.0, (count, calm.reference.duties.shape[1]))
    rows = [rows for rows, _ in Reference(calm.plan, times, duties).motions()]
    assert len(rows) == batches
    assert sum(len(times[part]) for part in rows) == count


@pytest.mark.parametrize("rounds", [True, False])
def test_setpoints_too_large_for_integer_ticks_are_stored_as_floats(rounds: bool) -> None:
    robot = Robot.load()
    twin, still, sent = Twin(robot, rounds=rounds), np.zeros(len(robot.drives)), [0.1, 1e3, 0.2]
    recorder = twin.recorder(len(sent))
    for k, goal in enumerate(sent):
        twin.write(Command(0.01 * k, still, still, still, still + goal))
        twin.record(recorder)
    seen, tick = recorder.measurements(), robot.drives.tick
    assert seen.sent.counts.dtype == np.float64
    expected = np.outer(sent, np.ones(len(tick)))
    np.testing.assert_array_equal(seen.setpoints, np.rint(expected / tick) * tick if rounds else expected)


@pytest.mark.parametrize("far", [1, 4])
def test_setpoints_beyond_the_int16_range_widen_their_storage_once(far: int) -> None:
    robot = Robot.load()
    twin, still, sent = Twin(robot), np.zeros(len(robot.drives)), np.full(6, 0.1)
    sent[far] = 1e3
    recorder, rows = twin.recorder(len(sent)), []
    for k, goal in enumerate(sent):
        twin.write(Command(0.01 * k, still, still, still, still + goal))
        twin.record(recorder)
        rows.append(recorder._counts["sent"])
    assert [row.dtype == np.float64 for row in rows] == [k >= far for k in range(len(sent))]
    assert all(row is rows[far] for row in rows[far:]), "all rows are copied at every later window"
    tick = robot.drives.tick
    np.testing.assert_array_equal(recorder.measurements().setpoints, np.rint(np.outer(sent, 1 / tick)) * tick)


def test_holding_torque_is_computed_for_the_whole_motion(calm: DryRun):
    times, shares = calm.reference.holding_torques
    assert times[0] == 0.0
    assert times[-1] >= calm.plan.trajectory.duration
    known, rest = calm.plan.setup, calm.plan.trajectory.angles(np.zeros(1))
    held = np.abs(known.dynamics.torques(rest, np.zeros_like(rest), np.zeros_like(rest))) / known.robot.drives.stall
    assert np.allclose(shares[0], held[0])
    assert len(shares) == len(times)
