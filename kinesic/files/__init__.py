"""Safe file output that follows no links and replaces only kinesic's files."""
