"""Gesture lexicon: reading gestures, hand shapes, paths and meanings from files."""
