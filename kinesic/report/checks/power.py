"""What the performance takes from the supply, and how warm the windings get, where the robot tells enough."""

from kinesic.controller.performance import Performance
from kinesic.report.checks.check import Check, at, goal

WARMING = 40.0  # [K] from a warm housing of 40 C to the 80 C at which servos switch off


def power_checks(performance: Performance) -> list[Check]:
    """Current against the supply, none for a robot without one; warming of the servos whose figures are known."""
    measured, supply = performance.measured, performance.plan.facts.robot.supply
    power, found = measured.power, []
    if supply is not None:
        highest = int(power.peak.argmax())
        where = at(measured.times[highest])
        found.append(goal("power.peak", float(power.peak[highest]), supply.amps, "A", where))
        found.append(goal("power.mean", float(power.mean.mean()), supply.amps, "A", f"{power.energy:.0f} J in all"))
    if power.warming:
        hottest = max(power.warming, key=lambda name: float(power.warming[name].max()))
        rise = power.warming[hottest]
        where = f"{hottest} {at(measured.times[rise.argmax()])}"
        found.append(goal("power.warming", float(rise.max()), WARMING, "K", where))
    return found
