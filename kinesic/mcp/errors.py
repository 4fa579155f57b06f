"""Errors of tool calls."""


class RefusedError(ValueError):
    """Refusal of a call, with reason and remedy, before anything moves."""


class RobotError(RuntimeError):
    """Failure of the server to answer, with the remedy."""
