"""Check of the joint mapping of imported robots before they perform."""

from kinesic.body.choices import MappingTrust
from kinesic.body.config import ConfigError
from kinesic.body.robot import Robot

MIN_MAPPING_CONFIDENCE = 0.6  # confidence in the joint mapping below which a robot does not perform


def check_mapping(robot: Robot, trust: MappingTrust) -> None:
    """Refuse a robot with a doubtful joint mapping, unless any is trusted.

    Raises:
        ConfigError: the confidence in the mapping is too low.
    """
    if trust == "any" or (doubt := describe_mapping_doubt(robot)) is None:
        return
    raise ConfigError(
        f"{robot.path}: {doubt}. Compare its hinges with the robot (`kinesic robots show`), correct them by "
        "`kinesic robots import --map JOINT=HINGE`, or set confidence = 1.0 in [robot.imported]; "
        "--mapping any performs it nevertheless"
    )


def describe_mapping_doubt(robot: Robot) -> str | None:
    """Describe a doubtful joint mapping, or return None."""
    confidence = robot.mapping_confidence
    if confidence is None or confidence >= MIN_MAPPING_CONFIDENCE:
        return None
    return f"confidence {confidence:.2f} of its joint mapping is below {MIN_MAPPING_CONFIDENCE:g}"
