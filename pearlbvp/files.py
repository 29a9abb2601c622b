"""Files that are whole or not there: written beside their destination, then renamed onto it."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Callable
from pathlib import Path

from pearlbvp.errors import InputError


def writable(name: str, path: str | os.PathLike[str]) -> Path:
    """``path`` as a Path, checked before anything is computed for it.

    Args:
        name: the argument's name, for the message.
        path: where a file is to be written.

    Raises:
        InputError: its folder does not exist or cannot be written to, or it is a folder itself.
    """
    path = Path(os.path.realpath(path))  # what a link points to is written, not the link
    folder = path.parent
    if not folder.is_dir():
        raise InputError(f"{name}: the folder {folder} does not exist; make it first")
    if path.is_dir():
        raise InputError(f"{name}: {path} is a folder; give a file's name")
    if not os.access(folder, os.W_OK):
        raise InputError(f"{name}: the folder {folder} cannot be written to; choose another")
    return path


def write_whole(name: str, path: Path, write: Callable[[Path], None]) -> None:
    """Let ``write`` fill a temporary file beside ``path``, then rename it; on any failure nothing is left behind.

    Raises:
        InputError: the file could not be written (a full disk, say).
    """
    temporary: Path | None = None
    try:
        if path.exists() and not path.is_file():  # a device or a pipe: there is nothing to rename onto
            write(path)
            return
        handle, temporary_name = tempfile.mkstemp(prefix=f".{path.stem}-", suffix=path.suffix, dir=path.parent)
        os.close(handle)
        temporary = Path(temporary_name)
        write(temporary)
        mask = os.umask(0)
        os.umask(mask)
        temporary.chmod(0o666 & ~mask)
        temporary.replace(path)
    except OSError as error:
        raise InputError(
            f"{name}: {path} could not be written ({error.strerror or error}); free space or choose another place"
        ) from None
    finally:
        if temporary is not None:
            temporary.unlink(missing_ok=True)
