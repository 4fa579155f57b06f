"""Perception study of the face (thesis 4.4): stimuli, page and analysis."""
