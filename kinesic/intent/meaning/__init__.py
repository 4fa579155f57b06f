"""Gestures by meaning: cues, structure of sentences, scores."""
