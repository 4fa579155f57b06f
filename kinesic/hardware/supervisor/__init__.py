"""The process between a planner and the servos: it follows, holds, folds and releases, whatever happens."""
