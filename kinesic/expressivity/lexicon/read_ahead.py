"""Reads all gestures that come with kinesic when it is imported: once, for all processes that are forks of this one."""

from kinesic.expressivity.lexicon.entries import own_gestures

READ = tuple(entry.sense for entry in own_gestures().entries)
