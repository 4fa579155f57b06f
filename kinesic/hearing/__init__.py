"""Hearing: voice activity, the robot's own echo and barge-in, from samples of a microphone."""
