"""Completion in the shell, as the pages say: the start file's line, and what is offered."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

PEARLBVP = Path(sys.executable).parent / "pearlbvp"


def completed(**variables):
    run = subprocess.run([PEARLBVP], env=os.environ | variables, capture_output=True, text=True, check=False)
    assert run.stderr == ""
    return run.stdout


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_the_line_of_a_start_file(shell):
    assert "_PEARLBVP_COMPLETE=" in completed(_PEARLBVP_COMPLETE=f"{shell}_source")


def test_commands_and_options_are_offered():
    asked = {"_PEARLBVP_COMPLETE": "bash_complete"}
    assert completed(COMP_WORDS="pearlbvp reg", COMP_CWORD="1", **asked) == "plain,region\n"
    assert "plain,--mode\n" in completed(COMP_WORDS="pearlbvp branch pearl --m", COMP_CWORD="3", **asked)
