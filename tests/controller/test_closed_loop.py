"""Compare the compiled loop with the Python loop."""

from dataclasses import replace

import numpy as np
import pytest

from kinesic.body.command import COMMAND_RATE, Command
from kinesic.controller import closed_loop
from kinesic.controller.closed_loop import perform_in_twins
from kinesic.controller.dry_run import dry_runs
from kinesic.controller.feedforward import FeedForward
from kinesic.sim.servo_factors import NOMINAL_FACTORS, PESSIMISTIC_FACTORS, Factors
from kinesic.sim.stepping import simulation
from kinesic.sim.stepping.addresses import _find_timestep_offset, function_address, timestep_address
from kinesic.sim.stepping.recorder import Recorder
from kinesic.sim.twin import MAX_PHYSICS_STEP, Twin

LATE_AND_LOOSE = Factors(gain=0.7, latency=0.013, play=0.004)  # servos with weak P gain, latency and backlash


@pytest.fixture
def in_python(monkeypatch):
    def run(*given, **options):
        with monkeypatch.context() as patch:
            patch.setattr(Twin, "parts", lambda self: None)
            return dry_runs(*given, **options)

    return run


@pytest.fixture
def warm_motors(calm):
    """Return a robot with thermal data for the elbow servos."""
    robot = calm.plan.setup.robot
    mounts = (
        replace(mount, drive=replace(mount.drive, servo=replace(mount.drive.servo, thermal=(5.0, 20.0))))
        if "elbow_flexion" in name
        else mount
        for name, mount in zip(robot.skeleton.names, robot.mounts, strict=True)
    )
    return replace(robot, mounts=tuple(mounts))


@pytest.mark.parametrize("correction", [True, False])
def test_dry_run_with_the_compiled_loop_equals_that_with_the_python_loop(calm, in_python, correction):
    twins = (NOMINAL_FACTORS, PESSIMISTIC_FACTORS, LATE_AND_LOOSE)
    fast, slow = (run(calm.plan, twins, correction=correction, watch=False) for run in (dry_runs, in_python))
    for one, other in zip(fast, slow, strict=True):
        for name in ("times", "angles", "velocities", "torques", "duties", "setpoints"):
            np.testing.assert_allclose(
                getattr(one.measured, name), getattr(other.measured, name), rtol=0, atol=1e-9, err_msg=name
            )
        np.testing.assert_allclose(one.measured.clearance.distances, other.measured.clearance.distances, atol=1e-9)
        assert one.measured.power.energy == pytest.approx(other.measured.power.energy, abs=1e-9)


def test_twin_advances_equally_after_the_compiled_and_the_python_loop(calm, in_python, monkeypatch):
    made: list[Twin] = []
    build = Twin.__init__

    def remember(self, *given, **options):
        build(self, *given, **options)
        made.append(self)

    monkeypatch.setattr(Twin, "__init__", remember)
    monkeypatch.setattr(simulation, "_find_simulation_pool", lambda *given, **options: [])  # each keeps its own
    for run in (dry_runs, in_python):
        run(calm.plan, (LATE_AND_LOOSE,), watch=False)
    still = np.zeros_like(calm.reference.angles[0])
    end = float(calm.reference.times[-1])
    for twin in made:
        for k in range(1, 6):
            twin.write(Command(end + 0.01 * k, still, still, still, calm.reference.angles[0]))
    fast, slow = made
    assert fast.physics[1] is not slow.physics[1]
    np.testing.assert_allclose(fast.positions(), slow.positions(), rtol=0, atol=1e-9)
    assert np.ptp(fast.measurements().angles[-6:], axis=0).max() > 0.001


def test_dry_run_progress_of_two_twins_starts_at_zero_and_does_not_decrease(calm):
    shares: list[float] = []
    dry_runs(calm.plan, (NOMINAL_FACTORS, PESSIMISTIC_FACTORS), watch=False, progress=shares.append)
    assert shares == sorted(shares)
    assert shares[0] == 0.0
    assert 0.5 < shares[-1] < 1.0


def test_exception_in_the_progress_callback_ends_the_dry_run(calm):
    def interrupt(share: float) -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        dry_runs(calm.plan, (NOMINAL_FACTORS,), progress=interrupt)


def test_simulated_sagging_supply_disables_the_compiled_loop(calm):
    robot = calm.plan.setup.robot
    assert Twin(robot).parts() is not None
    assert Twin(robot, factors=Factors(resistance=0.2)).parts() is None


def test_missing_mujoco_function_address_disables_the_compiled_loop(calm, monkeypatch):
    model = Twin(calm.plan.setup.robot)._model
    assert function_address("mj_step")
    assert function_address("mj_stride") is None
    address = timestep_address(model)
    assert address == model._address + _find_timestep_offset()
    monkeypatch.setattr("kinesic.sim.twin.function_address", lambda name: None)
    assert Twin(calm.plan.setup.robot).parts() is None


def test_dry_run_results_do_not_depend_on_the_number_of_commands_per_window(calm, warm_motors, monkeypatch):
    plan = replace(calm.plan, setup=replace(calm.plan.setup, robot=warm_motors))
    twins = (NOMINAL_FACTORS, LATE_AND_LOOSE)
    whole = dry_runs(plan, twins, watch=False)
    monkeypatch.setattr(closed_loop, "COMMANDS_PER_WINDOW", 40)
    for one, other in zip(whole, dry_runs(plan, twins, watch=False), strict=True):
        assert np.array_equal(one.reference.duties, other.reference.duties)
        _assert_the_same(one.measured, other.measured)


def _assert_the_same(whole, parts):
    for name in ("times", "angles", "velocities", "torques", "duties", "setpoints"):
        assert np.array_equal(getattr(whole, name), getattr(parts, name)), name
    assert all(np.array_equal(whole.hands[side], parts.hands[side]) for side in "lr")
    assert whole.clearance.distances.min() == parts.clearance.distances.min()
    assert (parts.clearance.distances <= whole.clearance.distances).all(), "until the least is known, more is measured"
    assert np.array_equal(whole.power.mean, parts.power.mean)
    assert np.array_equal(whole.power.peak, parts.power.peak)
    assert parts.power.energy == pytest.approx(whole.power.energy, rel=1e-13)
    assert parts.power.volts == whole.power.volts
    rises = whole.power.warming["l_elbow_flexion"]
    assert rises.max() > 0.003
    np.testing.assert_allclose(parts.power.warming["l_elbow_flexion"], rises, rtol=1e-13)


def test_compiled_loop_stores_physics_steps_of_one_command_window_at_a_time(calm, monkeypatch):
    kept = []
    add = Recorder.add
    monkeypatch.setattr(Recorder, "add", lambda self, log: kept.append(len(log.steps().spans)) or add(self, log))
    monkeypatch.setattr(closed_loop, "COMMANDS_PER_WINDOW", 40)
    dry_runs(calm.plan, (NOMINAL_FACTORS, PESSIMISTIC_FACTORS), watch=False)
    assert len(kept) == 2 * -(-len(calm.reference.times) // 40)
    assert max(kept) <= 1 + 40 * np.ceil(1 / COMMAND_RATE / MAX_PHYSICS_STEP)


@pytest.fixture
def perform(calm):
    """Perform commands at some times in a new twin and return the twin."""
    known, trajectory = calm.plan.setup, calm.plan.trajectory
    leading = FeedForward(known.robot, known.dynamics)

    def run(times):
        twin = Twin(known.robot, start=trajectory.at(0.0).angles)
        for _ in perform_in_twins(
            trajectory,
            times,
            lambda part: leading.compute_setpoints(trajectory, part),
            [twin],
            None,
            lambda share: None,
        ):
            pass
        return twin

    return run


def test_twin_measurements_do_not_depend_on_the_number_of_commands_per_window(calm, perform, monkeypatch):
    whole = perform(calm.reference.times).measurements()
    monkeypatch.setattr(closed_loop, "COMMANDS_PER_WINDOW", 64)
    parts = perform(calm.reference.times).measurements()
    for name in ("times", "angles", "velocities", "torques", "duties", "setpoints"):
        assert np.array_equal(getattr(whole, name), getattr(parts, name)), name


def test_compiled_loop_performs_a_single_command(calm, perform):
    assert perform(calm.reference.times[:1]).measurements().angles.shape == (1, len(calm.plan.trajectory.controls[0]))


@pytest.mark.parametrize("times", [[0.0, 0.01, 0.0], [0.0, float("nan")], [0.0, float("inf")]])
def test_dry_run_refuses_decreasing_or_non_finite_command_times(perform, times):
    with pytest.raises(ValueError, match="finite and not decrease"):
        perform(np.array(times))


def test_twin_recorder_requires_exactly_the_announced_number_of_commands(calm):
    twin, still = Twin(calm.plan.setup.robot), [np.zeros_like(calm.reference.angles[0])] * 4
    recorder = twin.recorder(2)
    with pytest.raises(ValueError, match="no command was written"):
        twin.record(recorder)
    twin.write(Command(0.0, *still))
    twin.record(recorder)
    with pytest.raises(ValueError, match="1 of 2 commands"):
        recorder.measurements()
    twin.write(Command(0.01, *still))
    twin.write(Command(0.02, *still))
    with pytest.raises(ValueError, match="room for 2"):
        twin.record(recorder)
