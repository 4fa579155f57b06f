"""Parse the built-in gestures at import, once for all forked processes."""

from kinesic.expressivity.lexicon.entries import builtin_gestures

SENSES_READ = tuple(entry.sense for entry in builtin_gestures().entries)
NAMES_READ = builtin_gestures().names
