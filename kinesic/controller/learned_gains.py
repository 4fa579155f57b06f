"""Identification of servo gains and delay from recorded motion.

A performance that starts with the gains of an earlier one is accurate from its first motion on. Estimates are bounded:
feed-forward offsets are at least half and at most twice those of the data sheets, and the delay is at most 50 ms.
"""

from dataclasses import dataclass

import msgspec
import numpy as np

from kinesic.body.arrays import Flags, Floats, sealed
from kinesic.body.robot import Robot
from kinesic.body.servo import tracking_lags
from kinesic.controller.observer_step import LOAD_ERROR_RANGE
from kinesic.sim.fitting.fit import Fit, fit_factors
from kinesic.sim.fitting.parameters import MAX_LATENCY, ServoParameter
from kinesic.sim.log import Log
from kinesic.sim.servo_factors import NOMINAL_FACTORS, DriveFactors, Factors

# Servo parameters identified from a few seconds of motion; the setpoint correction adapts to other deviations.
FITTED_PARAMETERS: tuple[ServoParameter, ...] = ("latency", "gain")
# Bounds of an estimated P gain, as factors of the data sheet's value.
GAIN_FACTOR_RANGE = (1.0 / (1.0 + LOAD_ERROR_RANGE[1]), 1.0 / (1.0 + LOAD_ERROR_RANGE[0]))
MOVING_FRACTION = 0.05  # setpoint velocity / no-load velocity above which a servo counts as moving
INITIAL_REST = 0.2  # [s] length of the log, before the first motion, that the fit uses
IDENTIFICATION_TIME = 8.0  # [s] length of the log after INITIAL_REST that the fit uses
MIN_MOTION_TIME = 0.4  # [s] shortest duration of motion from which an estimate is made
GAIN_TOLERANCE = 0.02  # smallest relative change by clipping at which a gain is reported as clipped to its bounds
MAX_RESIDUAL = np.radians(1.5)  # [rad] RMS error after the fit above which the estimate is discarded


@dataclass(frozen=True, eq=False)
class LearnedGains:
    """Learned relative corrections of feed-forward offsets, and the bus delay.

    In joint order; 0 leaves the offset of the data sheet.
    """

    load: Floats  # (n,) correction of the torque offsets, or (m, n) for m times
    lead: Floats  # (n,) correction of the velocity offsets, or (m, n) for m times
    delay: float | Floats = 0.0  # [s] delay until setpoints reach the servos, or (m,) for m times

    @classmethod
    def of_twin(cls, robot: Robot, twin: Factors) -> "LearnedGains":
        """Compute the corrections from servo factors fitted to a real robot.

        Args:
            robot: with the servos of the data sheets.
            twin: deviation of the servos from them.
        """
        sheet, factors = robot.drives, twin.applied(robot).drives
        load = sheet.gain * sheet.stall / (factors.gain * factors.stall) - 1.0
        lead = tracking_lags(factors) / tracking_lags(sheet) - 1.0
        return cls(
            sealed(np.clip(load, *LOAD_ERROR_RANGE)),
            sealed(np.clip(lead, *LOAD_ERROR_RANGE)),
            min(twin.latency, MAX_LATENCY),
        )

    def towards(self, other: "LearnedGains", shares: Floats) -> "LearnedGains":
        """Interpolate from these gains (0) to other gains (1) by fractions (m,)."""
        rows = shares[:, None]
        return LearnedGains(
            sealed(self.load + rows * (other.load - self.load)),
            sealed(self.lead + rows * (other.lead - self.lead)),
            sealed(self.delay + shares * (other.delay - self.delay)),
        )


@dataclass(frozen=True)
class Identification:
    """Servo parameters identified from a motion, with the errors before and after."""

    estimate: Factors  # new estimate; the earlier one where the motion gives no evidence
    before: float = 0.0  # [rad] RMS error of a twin with the earlier estimate
    after: float = 0.0  # [rad] RMS error of a twin with the new estimate
    why: str = ""  # reason for keeping the earlier estimate; empty otherwise
    bounded: bool = False  # whether an estimate was clipped to its bounds

    def __str__(self) -> str:
        """Describe the identified servo parameters in one line."""
        if self.why:
            return f"nothing learned: {self.why}"
        before, after = np.degrees([self.before, self.after])
        bound = "; the estimate is at its bounds: fit the servos (kinesic twin fit)" if self.bounded else ""
        fell = f"the twin's error fell from {before:.2f} to {after:.2f} deg{bound}"
        return f"learned: {describe_estimate(self.estimate)}; {fell}"


def reduce_stiffness(robot: Robot, believed: Factors) -> Robot:
    """Return the robot with servo stiffness reduced to the estimate.

    The correction is designed for this robot. It is never stiffer than the data sheets: a correction for stiffer servos
    is stable in fewer cases.
    """
    rows = {
        name: DriveFactors(gain=float(np.clip(believed.servos.get(name, believed).gain, GAIN_FACTOR_RANGE[0], 1.0)))
        for name in _models(robot)
    }
    return Factors(servos=rows).applied(robot)


def _models(robot: Robot) -> tuple[str, ...]:
    return tuple(dict.fromkeys(drive.servo.name for drive in robot.drives))


def describe_estimate(believed: Factors) -> str:
    """Describe a servo estimate: factors on data sheet values, and latency."""
    rows = {name: _format_factors(factors) for name, factors in sorted(believed.servos.items())} or {
        "all servos": _format_factors(believed)
    }
    if len(set(rows.values())) == 1:
        rows = {"all servos": next(iter(rows.values()))}
    shown = ", ".join(f"{shares} ({name})" for name, shares in rows.items())
    return f"{shown}, {1000 * believed.latency:.0f} ms late"


def _format_factors(factors: DriveFactors) -> str:
    """Format the P gain factor, and other factors that differ from 1."""
    others = (("stall torque", factors.stall), ("no-load speed", factors.no_load))
    parts = [
        f"P gain x {factors.gain:.2f}",
        *(f"{name} x {factor:.2f}" for name, factor in others if f"{factor:.2f}" != "1.00"),
    ]
    return " ".join(parts)


def identify_servos(log: Log, robot: Robot, believed: Factors = NOMINAL_FACTORS) -> Identification:
    """Identify P gains and delay of servos from recorded motion.

    The first seconds of the motion are used. Any correction of the setpoints may have been active. Values without
    evidence, such as the gain of servos without motion and load, keep the earlier estimate.

    Args:
        log: of a performance that began at rest.
        robot: with the servos of the data sheets.
        believed: earlier estimate of the servos.
    """
    moving, spans = _find_motion(log, robot), np.diff(log.times)
    if (moved := float(spans[moving].sum())) < MIN_MOTION_TIME:
        return Identification(
            believed, why=f"servos moved for {moved:.1f} s, at least {MIN_MOTION_TIME:g} s are needed"
        )
    begin = int(np.searchsorted(log.times, log.times[int(moving.argmax())] - INITIAL_REST))
    end = int(np.searchsorted(log.times, log.times[begin] + INITIAL_REST + IDENTIFICATION_TIME))
    part = Log(log.times[begin:end], log.setpoints[begin:end], log.angles[begin:end])
    fit = fit_factors(part, believed.applied(robot), free=FITTED_PARAMETERS)
    if fit.error_after > MAX_RESIDUAL:
        left = f"{np.degrees(fit.error_after):.1f} deg of error remain"
        return Identification(
            believed, fit.error_before, fit.error_after, f"gain and delay do not explain the motion: {left}"
        )
    if all(estimate.why for estimate in fit.estimates):
        return Identification(
            believed, fit.error_before, fit.error_after, "the motion determines neither gain nor delay"
        )
    return _combine_gains(fit, robot, believed)


def _find_motion(log: Log, robot: Robot) -> Flags:
    """Return per log interval whether any setpoint moves, (m - 1,)."""
    speeds = np.abs(np.diff(log.setpoints, axis=0)) / np.diff(log.times)[:, None]
    moving: Flags = np.any(speeds > MOVING_FRACTION * robot.drives.no_load, axis=1)
    return moving


def _combine_gains(fit: Fit, robot: Robot, believed: Factors) -> Identification:
    """Apply fitted gain factors and latency to the earlier estimate, within bounds."""
    late = next(estimate for estimate in fit.estimates if estimate.unknown.figure == "latency")
    servos, bounded = {}, False
    for name in _models(robot):
        factors = believed.servos.get(name, believed)
        gain = factors.gain * fit.factors.servos.get(name, NOMINAL_FACTORS).gain
        kept = float(np.clip(gain, *GAIN_FACTOR_RANGE))
        bounded = bounded or abs(kept - gain) > GAIN_TOLERANCE * gain
        figures = {figure: getattr(factors, figure) for figure in DriveFactors.__struct_fields__}
        servos[name] = DriveFactors(**{**figures, "gain": kept})
    latency = believed.latency if late.why else min(fit.factors.latency, MAX_LATENCY)
    joined = msgspec.structs.replace(believed, servos=servos, latency=latency)
    return Identification(joined, fit.error_before, fit.error_after, bounded=bounded)
