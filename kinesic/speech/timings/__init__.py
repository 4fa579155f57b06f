"""Readers of files with the times of spoken words or phonemes."""
