"""Loading, use and storage of learned servo factors."""

from pathlib import Path
from types import SimpleNamespace

import pytest
from msgspec.structs import replace

from kinesic.body.config import ConfigError
from kinesic.cli.options import ServoOptions
from kinesic.cli.servos.memory import LEARNED_FACTORS_FILE, NO_SERVO_MEMORY, ServoMemory, check_single_robot
from kinesic.sim.servo_factors import NOMINAL_FACTORS, PESSIMISTIC_FACTORS, Factors

WEAK_FACTORS = replace(NOMINAL_FACTORS, latency=0.011)
WEAKER_FACTORS = replace(NOMINAL_FACTORS, latency=0.022)


@pytest.fixture
def learned(tmp_path: Path) -> Path:
    path = tmp_path / "learned.toml"
    path.write_text(WEAK_FACTORS.text())
    return path


@pytest.fixture
def twin(tmp_path: Path) -> Path:
    path = tmp_path / "twin.toml"
    path.write_text(WEAKER_FACTORS.text())
    return path


def list_values(memory: ServoMemory) -> tuple[tuple[Factors, ...], Factors, Path | None, bool]:
    return memory.twins, memory.estimate, memory.path, memory.learns


def test_default_servo_factors_are_those_of_the_data_sheets() -> None:
    assert list_values(ServoMemory.of(ServoOptions(None, None))) == ((NOMINAL_FACTORS,), NOMINAL_FACTORS, None, True)
    assert list_values(NO_SERVO_MEMORY) == ((NOMINAL_FACTORS,), NOMINAL_FACTORS, None, True)


def test_built_in_twins_leave_the_estimated_servo_factors_at_the_data_sheet_values() -> None:
    assert list_values(ServoMemory.of(ServoOptions("both", None))) == (
        (NOMINAL_FACTORS, PESSIMISTIC_FACTORS),
        NOMINAL_FACTORS,
        None,
        True,
    )


def test_servo_factors_of_a_twin_file_also_set_the_estimated_factors(twin: Path) -> None:
    assert list_values(ServoMemory.of(ServoOptions(str(twin), None))) == ((WEAKER_FACTORS,), WEAKER_FACTORS, None, True)


@pytest.mark.parametrize("twin_name", [None, "pessimistic"])
def test_learning_of_servo_factors_can_be_switched_off(twin_name: str | None) -> None:
    expected = (PESSIMISTIC_FACTORS,) if twin_name else (NOMINAL_FACTORS,)
    assert list_values(ServoMemory.of(ServoOptions(twin_name, "none"))) == (expected, NOMINAL_FACTORS, None, False)


def test_learned_servo_factors_are_the_robot_estimate_and_the_factors_of_the_default_twin(
    learned: Path, twin: Path
) -> None:
    assert list_values(ServoMemory.of(ServoOptions(None, str(learned)))) == (
        (WEAK_FACTORS,),
        WEAK_FACTORS,
        learned,
        True,
    )
    assert list_values(ServoMemory.of(ServoOptions("pessimistic", str(learned)))) == (
        (PESSIMISTIC_FACTORS,),
        WEAK_FACTORS,
        learned,
        True,
    )
    assert list_values(ServoMemory.of(ServoOptions(str(twin), str(learned)))) == (
        (WEAKER_FACTORS,),
        WEAK_FACTORS,
        learned,
        True,
    )


def test_option_learn_accepts_a_missing_file_but_refuses_a_folder_or_an_invalid_file(tmp_path: Path) -> None:
    path = tmp_path / "new.toml"
    assert list_values(ServoMemory.of(ServoOptions(None, str(path)))) == (
        (NOMINAL_FACTORS,),
        NOMINAL_FACTORS,
        path,
        True,
    )
    assert not path.exists()
    with pytest.raises(ConfigError):
        ServoMemory.of(ServoOptions(None, str(tmp_path / "missing" / "new.toml")))
    with pytest.raises(ConfigError):
        ServoMemory.of(ServoOptions(None, str(tmp_path)))
    path.write_text("nonsense = 1")
    with pytest.raises(ConfigError):
        ServoMemory.of(ServoOptions(None, str(path)))


class FakeIdentification(SimpleNamespace):
    """Identification result with a fixed text."""

    def __str__(self) -> str:
        return "latency 22 ms"


FAKE_IDENTIFICATION = FakeIdentification(why="", estimate=WEAKER_FACTORS)


def test_learned_servo_factors_are_written_to_the_file_of_option_learn(learned: Path, tmp_path: Path) -> None:
    memory = ServoMemory.of(ServoOptions(None, str(learned)))
    assert memory.keep(FAKE_IDENTIFICATION, tmp_path / "report") == learned
    assert Factors.read(learned) == WEAKER_FACTORS
    assert learned.read_text().splitlines()[0] == "# latency 22 ms"


def test_learned_factors_are_written_to_the_report_folder_by_default(tmp_path: Path) -> None:
    assert NO_SERVO_MEMORY.keep(FAKE_IDENTIFICATION, tmp_path) == tmp_path / LEARNED_FACTORS_FILE
    assert Factors.read(tmp_path / LEARNED_FACTORS_FILE) == WEAKER_FACTORS
    assert NO_SERVO_MEMORY.keep(FAKE_IDENTIFICATION) is None


def test_learned_file_is_unchanged_if_the_identification_failed(learned: Path) -> None:
    before = learned.read_text()
    memory = ServoMemory.of(ServoOptions(None, str(learned)))
    assert memory.keep(FakeIdentification(why="too few commands", estimate=WEAKER_FACTORS)) is None
    assert learned.read_text() == before


@pytest.mark.parametrize("learn", [None, "none"])
def test_several_robots_may_store_learned_factors_in_report_folders(learn: str | None) -> None:
    check_single_robot(ServoOptions(None, learn))


def test_file_of_learned_servo_factors_is_refused_for_several_robots() -> None:
    with pytest.raises(ConfigError, match=r"--learn a\.toml: .*one robot"):
        check_single_robot(ServoOptions(None, "a.toml"))
