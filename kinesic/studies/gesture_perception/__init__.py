"""Perception study of gestures: design, web page, answers and analysis.

Recognition of one of six meanings, and preference between performances.
"""
