"""Checks, report.json and report pages of performances, and batch reports."""
