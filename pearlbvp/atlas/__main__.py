"""``python -m pearlbvp.atlas [FILE]``: compute the atlas anew, in about a minute, and write it."""

import sys
from pathlib import Path

from pearlbvp.atlas.series import FILE, Atlas, unscaled

if __name__ == "__main__":
    found = Atlas.computed()
    path = Path(sys.argv[1]) if len(sys.argv) > 1 else FILE
    found.save(path)
    for piece in found.pieces:
        print(f"c0 from {unscaled(piece.low):.5f} to {unscaled(piece.high):.5f}: error {piece.error:.1e}")
    print(f"{path}: {path.stat().st_size:,} bytes")
