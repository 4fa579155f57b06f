"""Says in which manner each behaviour is performed, by eight numbers for each modality."""
