"""The page: HTML, CSS and JavaScript of this folder, three.js and the data as one file, which needs no network.

Its content security policy lets only the scripts run that were put in here, by their hashes, and lets nothing be loaded.
"""

from __future__ import annotations

import base64
import hashlib
import html
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from importlib.resources import files
from typing import Any

from pearlbvp.continuation.branch import Branch
from pearlbvp.errors import InputError
from pearlbvp.explorer.series import branch_series, flow_series
from pearlbvp.explorer.shapes import Shared
from pearlbvp.figures.canvas import COLOURS
from pearlbvp.flows.record import FlowState
from pearlbvp.progress import progress
from pearlbvp.representation import brief
from pearlbvp.units import RADII, Units

SCRIPTS = ("numbers.js", "surfaces.js", "scene.js", "plots.js", "app.js")
"""Our own, in the order in which they are read: each uses only what stands before it."""


@dataclass(frozen=True)
class Explorer:
    """A page; a notebook shows it in a frame.

    Attributes:
        text: all of it.
    """

    __repr__ = brief

    text: str

    def _repr_html_(self) -> str:
        """The page in a frame of a notebook."""
        return (
            f'<iframe srcdoc="{html.escape(self.text)}" title="pearlbvp explorer" '
            'style="width:100%;height:720px;border:0" sandbox="allow-scripts"></iframe>'
        )


def explorer(
    shown: Mapping[str, Branch[Any] | FlowState], x: str = "", y: str = "E", title: str = "", units: Units = RADII
) -> Explorer:
    """A page of branches and flows.

    Args:
        shown: by name.
        x, y: columns of the diagram to begin with; ``x`` is ``v`` by default, ``t`` of flows alone.
        title: of the page; by default the names.
        units: of its numbers.

    Raises:
        InputError: a column that none of them has.
    """
    shared = Shared()
    series = []
    with progress("shape") as bar:
        bar.leave = False
        for name, each in shown.items():
            of_kind = flow_series if isinstance(each, FlowState) else branch_series
            series.append(of_kind(name, each, shared, units, bar.update))  # type: ignore[arg-type]
    x = x or ("v" if any(each["kind"] == "branch" for each in series) else "t")
    for option, column in (("x", x), ("y", y)):
        if not any(column in each["labels"] for each in series):
            raise InputError(option, f"no branch here has a column {column!r} of numbers", "choose another column")
    title = title or ", ".join(shown)
    data = {"x": x, "y": y, "note": units.note(), "radius": units.to_user("x", 1.0), "unit": units.unit("x"),
            "curvature": units.unit("H"),
            "colours": COLOURS, "series": series, "shared": shared.lists}  # fmt: skip
    scripts = [_own("three.min.js"), '"use strict";(() => {\n' + "\n".join(map(_own, SCRIPTS)) + "\n})();"]
    return Explorer(_page(title, _json(data), scripts))


def _own(name: str) -> str:
    """A file of this folder."""
    return (files("pearlbvp.explorer") / name).read_text(encoding="utf-8")


def _json(data: object) -> str:
    """Data that can stand in a page: nothing in it can end the element."""
    return json.dumps(data, separators=(",", ":"), allow_nan=False).replace("<", "\\u003c")


def _page(title: str, data: str, scripts: Sequence[str]) -> str:
    """The template with everything in its place."""
    hashes = " ".join(
        f"'sha256-{base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()}'" for text in scripts
    )
    parts = {
        "TITLE": html.escape(title), "HASHES": hashes, "STYLE": _own("page.css"), "DATA": data,
        "SCRIPTS": "\n".join(f"<script>{text}</script>" for text in scripts),
    }  # fmt: skip
    found = []
    for piece in _own("page.html").split("{{"):
        name, end, rest = piece.partition("}}")
        found.append(parts[name] + rest if end else piece)
    return "".join(found)
