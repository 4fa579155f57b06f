"""Which twins: by name, or a TOML file of factors."""

from pathlib import Path

from kinesic.sim.servo_factors import NOMINAL, PESSIMISTIC, Factors

NAMED = {"nominal": (NOMINAL,), "pessimistic": (PESSIMISTIC,), "both": (NOMINAL, PESSIMISTIC)}
HELP = "nominal, pessimistic, both (checks of the nominal one, errors of both), or a TOML file of factors."


def read_twins(name: str) -> tuple[Factors, ...]:
    """The factors on the servos' and masses' nominal values; the first twin's are checked.

    Raises:
        ConfigError: no such file, or not factors.
    """
    return NAMED[name] if name in NAMED else (Factors.read(Path(name)),)
