"""Checks of servo load, torque and temperature."""

from dataclasses import replace

import numpy as np
import pytest

from kinesic.body.arrays import sealed
from kinesic.metrics.dry_run import DryRun
from kinesic.report.checks.check import format_time
from kinesic.report.checks.servos import CONTINUOUS_TORQUE_RATIO, draw_load, loads, power_checks
from kinesic.report.plots.spark import TIME_BINS, spark
from tests.performances import bearing


def test_joint_with_the_highest_servo_load_is_listed_first(hurried: DryRun) -> None:
    data = loads(hurried)
    assert sorted(load.hinge for load in data) == sorted(hurried.plan.setup.robot.skeleton.names)
    assert [load.strain for load in data] == sorted((load.strain for load in data), reverse=True)
    assert all(0.0 <= load.rms <= load.torque for load in data)


def test_duty_metrics_of_a_joint_equal_those_of_its_samples(hurried: DryRun) -> None:
    measured, robot = hurried.measured, hurried.plan.setup.robot
    duties = np.full_like(measured.duties, 0.6)
    duties[:, 3] = 0.0
    duties[10:15, 3] = -1.5
    data = loads(replace(hurried, measured=bearing(measured, duties)))
    first, by_name = data[0], {load.hinge: load for load in data}
    assert first.hinge != robot.skeleton.names[3], "torque strains longer than duty"
    load = by_name[robot.skeleton.names[3]]
    assert load.duty == pytest.approx(1.5)
    assert load.duty_at in measured.times[10:15]
    assert load.saturated == pytest.approx(0.05)
    assert (first.rms, first.strain) == (pytest.approx(0.6), pytest.approx(0.6 / CONTINUOUS_TORQUE_RATIO))


@pytest.mark.parametrize(("duty", "seconds"), [(1.0, 0.0), (-1.0, 0.0), (1.001, 0.05), (-1.001, 0.05)])
def test_servo_counts_as_saturated_while_the_demanded_duty_exceeds_full_duty(
    hurried: DryRun, duty: float, seconds: float
) -> None:
    measured = hurried.measured
    duties = np.full_like(measured.duties, 0.2)
    duties[10:15, 3] = duty
    name = hurried.plan.setup.robot.skeleton.names[3]
    (load,) = (load for load in loads(replace(hurried, measured=bearing(measured, duties))) if load.hinge == name)
    assert load.saturated == pytest.approx(seconds)


def test_supply_draw_has_the_peak_and_energy_of_the_measured_power(hurried: DryRun) -> None:
    power = hurried.measured.power
    load = draw_load(hurried)
    assert 0.0 < load.mean < load.peak == power.peak.max()
    assert load.energy == power.energy


def test_small_servo_duty_plot_shows_a_peak_that_lasts_one_sample(hurried: DryRun) -> None:
    load = replace(loads(hurried)[0], duties=np.r_[np.zeros(5000), 1.25, np.zeros(5000)])
    drawn = spark(load)
    assert drawn.count("L") == TIME_BINS
    assert " 0L" in drawn
    assert "<svg" in spark(replace(load, duties=np.zeros(1)))


def test_load_of_a_joint_names_its_servo_model_and_the_number_of_its_servos(hurried: DryRun) -> None:
    robot = hurried.plan.setup.robot
    names = {load.hinge: load.servo for load in loads(hurried)}
    for hinge, drive in zip(robot.skeleton.names, robot.drives, strict=True):
        assert names[hinge] == (drive.servo.name if drive.count == 1 else f"{drive.count} x {drive.servo.name}")
    counts = {drive.count for drive in robot.drives}
    assert 1 in counts


def test_torque_metrics_of_a_joint_equal_those_of_its_samples(hurried: DryRun) -> None:
    measured, names = hurried.measured, hurried.plan.setup.robot.skeleton.names
    duties = np.full_like(measured.duties, 0.1)
    duties[20, 5] = -0.7
    by_name = {load.hinge: load for load in loads(replace(hurried, measured=bearing(measured, duties)))}
    load = by_name[names[5]]
    assert load.torque == pytest.approx(0.7)
    assert load.torque_at == load.duty_at == measured.times[20]
    assert load.rms == pytest.approx(np.sqrt(np.mean(duties[:, 5] ** 2)))
    np.testing.assert_allclose(load.duties, np.abs(duties[:, 5]), atol=1e-9)


def test_warmest_winding_is_named_with_its_temperature_rise(hurried: DryRun) -> None:
    count = len(hurried.measured.times)
    rises = {"a": np.full(count, 3.0), "b": np.linspace(0.0, 8.0, count), "c": np.linspace(9.0, 1.0, count) - 2.0}
    power = replace(hurried.measured.power, warming={name: sealed(rise) for name, rise in rises.items()})
    warm = replace(hurried, measured=replace(hurried.measured, power=power))
    load = draw_load(warm)
    assert (load.warmest, load.warming) == ("b", 8.0)
    check = {check.name: check for check in power_checks(warm)}["power.warming"]
    assert check.value == 8.0
    assert check.where == f"b {format_time(hurried.measured.times[-1])}"
    cold = draw_load(replace(hurried, measured=replace(hurried.measured, power=replace(power, warming={}))))
    assert (cold.warmest, cold.warming) == ("", 0.0)
