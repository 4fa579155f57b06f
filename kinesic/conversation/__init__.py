"""Behaviour of a robot between blocks of a conversation: people, turns and gaze."""
