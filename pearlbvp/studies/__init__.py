"""What users come for, one file a question; each returns a pandas DataFrame. Knows nothing of argument parsing."""
