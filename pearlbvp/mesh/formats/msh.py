"""gmsh's MSH files, through meshio."""

from __future__ import annotations

import re
from contextlib import redirect_stderr, redirect_stdout
from io import StringIO
from tempfile import TemporaryFile

import numpy as np
from meshio.gmsh.main import read_buffer

from pearlbvp.mesh.formats.soup import Soup, Unreadable

IDLE = frozenset(("vertex", "line"))


def read_msh(data: bytes) -> Soup:
    """The triangles and quads of an MSH file of version 2.2, 4.0 or 4.1, as text or binary.

    Raises:
        Unreadable: another version, a broken file, or cells of other kinds.
    """
    if not data.lstrip().startswith((b"$MeshFormat", b"$Comments")) or b"$EndElements" not in data:
        raise Unreadable("it does not begin as an MSH file does, or is cut off before $EndElements")
    for section in (
        rb"\$Nodes\s+([\d ]+)",
        rb"\$Elements\s+([\d ]+)",
    ):  # of text; meshio makes arrays of what is declared
        if (match := re.search(section, data)) and max(map(int, match[1].split()[:2]), default=0) > len(data):
            raise Unreadable("it declares more nodes or elements than it can hold")
    try:
        # What it warns of is not asked for; numpy reads numbers from real files only.
        with redirect_stdout(StringIO()), redirect_stderr(StringIO()), TemporaryFile() as file:
            file.write(data)
            file.seek(0)
            found = read_buffer(file)
    except (Exception, SystemExit):  # meshio's readers meet anything in a broken file, and some end the program
        raise Unreadable("it is broken or cut off") from None
    blocks = [(block.type, np.asarray(block.data)) for block in found.cells]
    if others := sorted({kind for kind, _ in blocks} - {"triangle", "quad", *IDLE}):
        raise Unreadable(
            f"it has cells of kind {others[0]}; mesh its surface alone, by triangles or quads of first order"
        )
    parts = [cells for kind, cells in blocks if kind not in IDLE]
    if not all(np.issubdtype(cells.dtype, np.integer) for cells in parts):
        raise Unreadable("it is broken or cut off")
    return Soup.joined(
        np.asarray(found.points, dtype=float),
        [(cells.ravel(), np.full(len(cells), cells.shape[1])) for cells in parts],
    )
