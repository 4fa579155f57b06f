"""The virtual robot: a MuJoCo twin of the same skeleton."""
