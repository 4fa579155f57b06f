"""Gestures of the lexicon: isolated, as key postures, and as a vocabulary."""
