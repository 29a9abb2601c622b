"""Pictures of results. Reads tables and solutions, computes nothing."""
