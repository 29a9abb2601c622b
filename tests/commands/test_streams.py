"""Standard streams that are closed, full, or gone: results go where they can, messages are dropped, nothing ends in a trace."""

import signal
import subprocess
import sys

import pandas as pd
import pytest
from support.commands import is_png

PROGRAM = f"{sys.executable} -m pearlbvp "
BRANCH = "branch pearl --c0 0 --length 10 --max-points 3 --until v=2"
"""A table, a file, a picture, and a message why it ends."""


def shell(words):
    return subprocess.run(["bash", "-c", words], capture_output=True, text=True, check=False)


@pytest.mark.parametrize("closed", [">&-", "2>&-", "2>/dev/full", ">&- 2>&-", ">&- 2>&- <&-"])
def test_files_that_were_asked_for_are_written_whatever_the_streams_are(tmp_path, closed):
    files = f"--out {tmp_path / 't.csv'} --save {tmp_path / 'b.h5'} --plot {tmp_path / 'b.png'}"
    done = shell(f"{PROGRAM} {BRANCH} {files} {closed}")
    assert done.returncode == 1, done.stderr  # as with all streams open: v = 2 is not reached
    assert "Traceback" not in done.stderr
    assert len(pd.read_csv(tmp_path / "t.csv")) == 3
    assert is_png(tmp_path / "b.png")
    shown = shell(f"{PROGRAM} show {tmp_path / 'b.h5'}")
    assert shown.stdout == (tmp_path / "t.csv").read_text()


@pytest.mark.parametrize(("closed", "why"), [(">&-", "it is closed; open it"), (">/dev/full", "space")])
def test_a_table_that_cannot_be_written_is_an_error_and_loses_no_file(tmp_path, closed, why):
    done = shell(f"{PROGRAM} {BRANCH} --save {tmp_path / 'b.h5'} --plot {tmp_path / 'b.png'} {closed}")
    assert done.returncode == 2
    said = [line for line in done.stderr.splitlines() if "compiling" not in line]
    assert len(said) == 1
    assert said[0].startswith("pearlbvp: standard output: ")
    assert why in said[0]
    assert is_png(tmp_path / "b.png")
    assert (tmp_path / "b.h5").stat().st_size > 1000


@pytest.mark.parametrize("words", ["--help", "--version", "dispersion --c0 0 --length 10", "nonsense"])
@pytest.mark.parametrize("closed", [">&-", ">&- 2>&-", ">/dev/full 2>/dev/full"])
def test_whatever_cannot_be_written_is_an_error_without_a_trace(words, closed):
    done = shell(f"{PROGRAM} {words} {closed}")
    assert done.returncode == 2
    assert (done.stdout, "Traceback" in done.stderr) == ("", False)


@pytest.mark.parametrize("closed", ["2>&-", "2>/dev/full"])
def test_messages_that_cannot_be_written_are_dropped(tmp_path, closed):
    done = shell(f"{PROGRAM} period --c0 0.48 --lengths 15,16,17,18,19 --processes 2 {closed}")
    assert done.returncode == 0
    assert len(done.stdout.splitlines()) == 6
    assert shell(f"{PROGRAM} nonsense {closed}").returncode == 2


def test_a_reader_of_messages_that_has_had_enough_is_no_error(tmp_path):
    done = shell(f"({PROGRAM} {BRANCH} --out {tmp_path / 't.csv'}; echo $? >{tmp_path / 'status'}) 2> >(exec true)")
    assert done.stderr == ""
    assert (tmp_path / "status").read_text().strip() == "1"
    assert len(pd.read_csv(tmp_path / "t.csv")) == 3


IMPORTING = """
import os, runpy, signal, sys

class Interrupting:
    def find_spec(self, name, *_):
        if name == "pearlbvp.commands.branch":
            os.kill(os.getpid(), signal.SIGINT)

sys.meta_path.insert(0, Interrupting())
runpy.run_module("pearlbvp", run_name="__main__")
"""


def test_an_interruption_while_all_is_imported_leaves_no_trace():
    done = subprocess.run([sys.executable, "-c", IMPORTING, "--help"], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout, done.stderr) == (-signal.SIGINT, "", "")
