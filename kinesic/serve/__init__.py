"""Live server that performs BML documents as they arrive."""
