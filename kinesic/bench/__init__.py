"""Benchmarks of `kinesic bench`, one module or package per part."""

from collections.abc import Mapping

# Modules of each part; each module has a function `bench`. Only the modules of the requested part are imported.
BENCH_PARTS: Mapping[str, tuple[str, ...]] = {
    "ik": ("ik",),
    "expressivity": ("expressivity",),
    "naturalness": ("naturalness",),
    "capture": ("capture",),
    "plan": ("plan.first_command", "plan", "plan.styles"),
    "contact": ("contact",),
    "twin": ("twin",),
    "speed": ("speed",),
    "growth": ("growth",),
    "cluster": ("cluster", "store"),
    "bus": ("bus", "bus.faults"),
    "bml": ("bml", "bml.speech", "bml.merging", "bml.server", "bml.emergency_stop"),
    "face": ("face",),
    "hearing": ("hearing",),
    "meaning": ("meaning",),
    "conversation": ("conversation",),
    "studio": ("studio",),
}
