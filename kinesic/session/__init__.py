"""Planning setups and plans, built from names, files and options."""
