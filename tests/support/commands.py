"""Calls of the command line in the tests' own process."""

import pytest

from pearlbvp.cli import main


def run(capsys, *arguments):
    """Exit status, standard output and standard error of a call, without the word about compilation."""
    with pytest.raises(SystemExit) as left:
        main([str(word) for word in arguments])
    captured = capsys.readouterr()
    said = [line for line in captured.err.splitlines(keepends=True) if not line.startswith("pearlbvp: compiling")]
    return left.value.code, captured.out, "".join(said)


def is_png(path):
    """Whether a file is a picture in PNG format."""
    return path.read_bytes().startswith(b"\x89PNG\r\n")
