"""Supervisor process between planner and servos.

It follows commands, holds, folds and releases the robot even if the planner fails.
"""
