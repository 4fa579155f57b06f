"""Execution of independent tasks in local processes or on a dask cluster."""
