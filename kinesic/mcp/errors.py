"""Errors of tool calls."""


class RefusedError(ValueError):
    """Refusal of a call before anything moves, with reason and remedy."""


class RobotError(RuntimeError):
    """Missing answer or failed connection of the robot's server, with the remedy."""
