"""Conversational behaviour of a robot between blocks: people, turns and gaze."""
