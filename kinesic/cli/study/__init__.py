"""`kinesic study`: studies of perception, from their pages to what their answers say."""
