"""What `kinesic bench` measures: one file per part."""
