"""Which twin: by name, or a TOML file of factors."""

from pathlib import Path

from kinesic.sim.factors import NOMINAL, PESSIMISTIC, Factors

NAMED = {"nominal": NOMINAL, "pessimistic": PESSIMISTIC}


def read_twin(name: str) -> Factors:
    """The factors on the servos' and masses' nominal values.

    Raises:
        ConfigError: no such file, or not factors.
    """
    return NAMED[name] if name in NAMED else Factors.read(Path(name))
