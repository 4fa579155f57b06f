"""Reasons for which the planner rejects a block."""

from kinesic.serve.shared_scene import Verdict

DEFECT_TYPES = (
    ArithmeticError,
    AssertionError,
    AttributeError,
    LookupError,
    MemoryError,
    RuntimeError,
    TypeError,
    ValueError,
)  # exceptions that indicate a programming error
REJECTION_REASONS = {
    Verdict.STOPPED: ("stopped", "an emergency stop came; resume first"),
    Verdict.LATE: ("planning", "planning was too late for every start time, the machine is too busy; send it again"),
    Verdict.UNSTEADY: ("planning", "it would cause a step in the running motion; send it again"),
}  # quota rule and reason for rejecting a block
