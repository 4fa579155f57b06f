"""What `kinesic bench` measures: one file or folder per part."""

from collections.abc import Mapping

# Each part by its modules, each of which has a function `bench`; those of another part are not imported.
PARTS: Mapping[str, tuple[str, ...]] = {
    "ik": ("ik",),
    "expressivity": ("expressivity",),
    "naturalness": ("naturalness",),
    "plan": ("plan.first_command", "plan"),
    "twin": ("twin",),
    "speed": ("speed",),
    "growth": ("growth",),
    "cluster": ("cluster", "store"),
    "bus": ("bus", "bus.faults"),
    "bml": ("bml", "bml.speech", "bml.merging", "bml.server", "bml.emergency_stop"),
    "face": ("face",),
    "meaning": ("meaning",),
    "studio": ("studio",),
}
