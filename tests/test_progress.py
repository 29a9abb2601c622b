"""Where signs of life are shown."""

import io
import sys
import time

from pearlbvp import progress as module
from pearlbvp.progress import progress


class Notebook(io.StringIO):
    """Standard error of a notebook's kernel, as far as it is known by where its class lives."""


Notebook.__module__ = "ipykernel.iostream"


def shown(monkeypatch, stream, seconds):
    monkeypatch.setattr(sys, "stderr", stream)
    monkeypatch.setattr(module, "PATIENCE", 0.1)
    monkeypatch.setattr(module, "SECONDS", 0.02)
    with progress("point") as bar:
        bar.set_postfix(v="1.01234", refresh=False)
        bar.update()
        time.sleep(seconds)
    return stream.getvalue()


def test_a_notebook_shows_what_takes_long_and_nothing_of_it_stays(monkeypatch):
    assert shown(monkeypatch, Notebook(), 0) == ""
    text = shown(monkeypatch, Notebook(), 0.3)
    assert "1point" in text
    assert "v=1.01234" in text
    assert text.endswith("\r")
    assert not text.split("\r")[-2].strip()


def test_a_file_shows_nothing(monkeypatch):
    assert shown(monkeypatch, io.StringIO(), 0.3) == ""
