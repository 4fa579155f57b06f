"""Servo parameters learned in earlier performances: load, use and store them."""

from dataclasses import dataclass
from pathlib import Path

from kinesic.body.config import ConfigError
from kinesic.cli.options import ServoOptions
from kinesic.controller.learned_gains import Identification
from kinesic.files.output_file import check_file, write_text
from kinesic.sim.servo_factors import NOMINAL_FACTORS, TWIN_FACTORS, Factors, read_twins

NO_LEARNING = "none"  # value of --learn that switches learning off
LEARNED_FACTORS_FILE = "learned.toml"  # default file of learned servo factors, in the report folder


@dataclass(frozen=True, eq=False)
class ServoMemory:
    """Servo factors of the twins and the robot, and the learned file."""

    twins: tuple[Factors, ...]
    estimate: Factors
    path: Path | None  # file of learned factors; None: in the report folder
    learns: bool = True

    @classmethod
    def of(cls, options: ServoOptions) -> "ServoMemory":
        """Read the servo factors that --twin and --learn name.

        The feed-forward uses the factors of --learn; otherwise those of a file of --twin, which is the twin of this
        very robot; otherwise the data sheets. Unless --twin is given, the twin uses the same factors.

        Raises:
            ConfigError: a file is missing or invalid, or learned factors could not be written.
        """
        twin, learn = options.twin, options.learn
        if learn == NO_LEARNING:
            return cls(read_twins(twin or "nominal"), NOMINAL_FACTORS, None, learns=False)
        if learn is None:
            twins = read_twins(twin or "nominal")
            return cls(twins, NOMINAL_FACTORS if twin is None or twin in TWIN_FACTORS else twins[0], None)
        path = Path(learn)
        check_file(path, force=True)
        estimate = Factors.read(path) if path.exists() else NOMINAL_FACTORS
        return cls((estimate,) if twin is None else read_twins(twin), estimate, path)

    def keep(self, identification: Identification, folder: Path | None = None) -> Path | None:
        """Write the learned factors and return the path.

        The result is None if nothing was learned or there is no file to write.

        Args:
            identification: factors identified from the servos.
            folder: report folder, used unless a file was named.
        """
        path = self.path or (None if folder is None else folder / LEARNED_FACTORS_FILE)
        if path is None or identification.why:
            return None
        write_text(path, f"# {identification}\n{identification.estimate.text()}", force=True, durable=True)
        return path


NO_SERVO_MEMORY = ServoMemory((NOMINAL_FACTORS,), NOMINAL_FACTORS, None)


def check_single_robot(options: ServoOptions) -> None:
    """Refuse a file of learned factors for several robots.

    Raises:
        ConfigError: --learn names a file.
    """
    if options.learn not in (None, NO_LEARNING):
        raise ConfigError(f"--learn {options.learn}: learned factors belong to one robot; name one robot")
