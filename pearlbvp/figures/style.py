"""Styles: files of matplotlib's settings over our own, which pictures are drawn by for a while."""

from __future__ import annotations

import logging
import shutil
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import matplotlib.style
from matplotlib import rc_params_from_file
from matplotlib.font_manager import FontProperties, findfont

from pearlbvp.errors import InputError
from pearlbvp.figures.canvas import STYLE
from pearlbvp.files import shortened
from pearlbvp.messages import say

NONE_OF_A_PICTURE = ("backend", "interactive", "toolbar", "timezone", "date.epoch", "webagg", "keymap", "tk.", "macosx",
                     "savefig.directory", "savefig.format", "figure.raise_window", "figure.max_open_warning",
                     "figure.hooks", "docstring", "agg.path")  # fmt: skip
"""What settings begin with that are none of a picture's, and are left out."""

GENERIC = ("serif", "sans-serif", "cursive", "fantasy", "monospace")
"""Families of fonts that lists of fonts stand behind."""

LATEX = ("latex", "dvipng")
"""Programs that ``text.usetex`` needs."""


@contextmanager
def styled(style: str | Path) -> Iterator[None]:
    """Draw pictures by a style: a file of matplotlib's settings, or the name of one of matplotlib's own.

    Colours stay, as they mean families and stability.

    Raises:
        InputError: there is no such style, or it cannot be used.
    """
    token = STYLE.set(read_style(style))
    try:
        yield
    finally:
        STYLE.reset(token)


def read_style(style: str | Path) -> Mapping[str, Any]:
    """The settings of a style that can be used here; what cannot is said.

    Args:
        style: a file's name, or one of matplotlib's.

    Raises:
        InputError: there is no such style, a line in it cannot be read, or it needs LaTeX where there is none.
    """
    name = str(style)
    known: Mapping[Any, Any] = matplotlib.style.library
    found = known[name] if name in known else _read(Path(style))
    settings = {key: value for key, value in found.items() if not key.startswith(NONE_OF_A_PICTURE)}
    if settings.get("text.usetex") and any(shutil.which(program) is None for program in LATEX):
        raise InputError(
            "style",
            f"{shortened(name)} sets text.usetex, and there is no LaTeX here ({', '.join(LATEX)})",
            "leave it out",
        )
    missing = _missing_fonts(settings)
    if missing:
        say(f"style: no font {', '.join(missing)} here; the usual one is taken")
        settings = {key: value for key, value in settings.items() if not _names_fonts(key)}
    return settings


def _read(path: Path) -> Mapping[str, Any]:
    """The settings of a file.

    Raises:
        InputError: it cannot be read.
    """
    said: list[str] = []
    handler = logging.Handler(logging.WARNING)
    handler.emit = lambda record: said.append(record.getMessage())  # type: ignore[method-assign]
    log = logging.getLogger("matplotlib")
    propagate, level = log.propagate, log.level
    log.addHandler(handler)
    log.propagate = False
    log.setLevel(logging.WARNING)
    try:
        found = dict(rc_params_from_file(str(path), fail_on_error=True, use_default_template=False))
    except OSError as error:
        raise InputError(
            "style", f"{shortened(str(path))} cannot be read ({error.strerror})", "give a file of settings"
        ) from None
    except UnicodeDecodeError:
        raise InputError(
            "style", f"{shortened(str(path))} is no text", "give a file of matplotlib's settings"
        ) from None
    except ValueError as error:
        why = _line(str(error))
        raise InputError("style", f"{shortened(str(path))} has a line that cannot be used ({why})", "mend it") from None
    finally:
        log.removeHandler(handler)
        log.setLevel(level)
        log.propagate = propagate
    for text in said:
        say(f"style: {_line(text)}; it is left out")
    return {str(key): value for key, value in found.items()}


def _line(text: str) -> str:
    """The first line of a message, without what ends it."""
    return text.strip().partition("\n")[0].rstrip(".:; ")


def _names_fonts(key: str) -> bool:
    return key == "font.family" or key.removeprefix("font.") in GENERIC


def _missing_fonts(settings: Mapping[str, Any]) -> list[str]:
    """The fonts that a style wants, where none of them is here."""
    families = list(settings.get("font.family", ["sans-serif"]))
    wanted = [
        font for family in families for font in (settings.get(f"font.{family}", []) if family in GENERIC else [family])
    ]
    return [] if not wanted or any(map(_is_here, wanted)) else wanted


def _is_here(font: str) -> bool:
    try:
        findfont(FontProperties(family=font), fallback_to_default=False)
    except ValueError:
        return font in GENERIC
    return True
