"""Hearing from microphone samples: voice activity, own echo and barge-in."""
