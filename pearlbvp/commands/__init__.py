"""The commands, a file each: they parse arguments, call a study, and write what it returns."""
