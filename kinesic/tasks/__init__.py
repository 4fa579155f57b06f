"""Execution of tasks in local processes or on a cluster, each once."""
