"""FML-APML: what a document says is meant, and the BML that is written for it."""
