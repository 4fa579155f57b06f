"""Comparison of whole-body motion with people: measures, postures and classifiers."""
