"""What is known of a robot's servos from earlier performances: where it is read, used and written."""

from dataclasses import dataclass
from pathlib import Path

from kinesic.body.config import ConfigError
from kinesic.cli.options import ServoOptions
from kinesic.controller.learned_gains import Lesson
from kinesic.files.output_file import check_file, write_text
from kinesic.sim.servo_factors import NOMINAL, TWINS, Factors, read_twins

NOTHING = "none"
FILE = "learned.toml"  # beside a report of servos, where no other file is named


@dataclass(frozen=True, eq=False)
class ServoMemory:
    """How the twins' servos are, how a robot's servos are believed to be, and where what they tell is kept."""

    twins: tuple[Factors, ...]
    believed: Factors
    path: Path | None  # of what is learned; None: beside the report
    learns: bool = True

    @classmethod
    def of(cls, options: ServoOptions) -> "ServoMemory":
        """Reads what options name.

        Goals lead by the file of --learn; else by that of --twin, as the twin of this very robot; else as data sheets
        say. Unless another is named, the twin is as servos are believed to be.

        Raises:
            ConfigError: a file is missing or wrong, or what is learned could not be written.
        """
        twin, learn = options.twin, options.learn
        if learn == NOTHING:
            return cls(read_twins(twin or "nominal"), NOMINAL, None, learns=False)
        if learn is None:
            twins = read_twins(twin or "nominal")
            return cls(twins, NOMINAL if twin is None or twin in TWINS else twins[0], None)
        path = Path(learn)
        check_file(path, force=True)
        believed = Factors.read(path) if path.exists() else NOMINAL
        return cls((believed,) if twin is None else read_twins(twin), believed, path)

    def keep(self, lesson: Lesson, folder: Path | None = None) -> Path | None:
        """Writes what was learned; returns where it stands, None where there is nothing or no place.

        Args:
            lesson: what servos have told.
            folder: of a report, in which it stands unless a file was named.
        """
        path = self.path or (None if folder is None else folder / FILE)
        if path is None or lesson.why:
            return None
        write_text(path, f"# {lesson}\n{lesson.believed.text()}", force=True, durable=True)
        return path


UNKNOWN = ServoMemory((NOMINAL,), NOMINAL, None)


def check_alone(options: ServoOptions) -> None:
    """Refuses one file for several robots.

    Raises:
        ConfigError: --learn names one.
    """
    if options.learn not in (None, NOTHING):
        raise ConfigError(f"--learn {options.learn}: what servos tell is of one robot: name one")
