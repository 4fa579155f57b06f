"""Tasks in, results out: works through tasks in processes of this machine or on a cluster, each once."""
