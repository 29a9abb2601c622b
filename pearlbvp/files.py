"""Files of the user: inputs are regular files of bounded size, outputs are whole or not there."""

from __future__ import annotations

import contextlib
import errno
import os
import stat
import tempfile
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import IO

from pearlbvp.errors import InputError

MOST_TEXT = 2**26
"""Bytes of the longest table that is read (64 MB): some million rows."""

MOST_BINARY = 2**31
"""Bytes of the longest saved branch, flow or mesh that is read or written (2 GB)."""

try:
    import fcntl
except ImportError:  # where the system has other locks, which keep files from being replaced by themselves
    fcntl = None  # type: ignore[assignment]

LONGEST_ENDING = 16
"""Characters of a file's ending that its temporary name keeps: longer ones name no format."""


def named(name: str, path: str | os.PathLike[str]) -> Path:
    """``path`` as a Path.

    Raises:
        InputError: it is no name of a file, or one that ends as a folder's does, which a Path would forget.
    """
    try:
        text = os.fspath(path)
        found = Path(path)
    except TypeError:
        raise InputError(name, f"{path!r} is no name of a file", "give a text or a Path") from None
    if text.endswith(tuple(filter(None, (os.sep, os.altsep)))) and not os.path.isdir(text):
        raise InputError(name, f"{shortened(text)} ends as a folder's name does", "give a file's name")
    return found


def readable(name: str, path: str | os.PathLike[str], most: int = MOST_BINARY) -> Path:
    """``path`` as a Path, if it is a regular file of bounded size: a device or a pipe might never end.

    Args:
        name: the argument's name, for the message.
        path: of the file.
        most: bytes that it may have.

    Raises:
        InputError: there is no such file, or it is none that can be read.
    """
    path = named(name, path)
    try:
        found = path.stat()
    except FileNotFoundError:
        raise InputError(name, f"there is no file {path}", "give one that exists") from None
    except (OSError, ValueError) as error:
        raise InputError(name, f"{shortened(path)} cannot be read ({_why(error)})", "give another file") from None
    if stat.S_ISDIR(found.st_mode):
        raise InputError(name, f"{path} is a folder", "give a file's name")
    if not stat.S_ISREG(found.st_mode):
        raise InputError(name, f"{path} is no ordinary file but a device or a pipe", "write it to a file first")
    if found.st_size > most:
        raise InputError(name, f"{path} has {found.st_size:.3g} bytes, more than {most:.3g}", "give a smaller file")
    return path


def read_whole(name: str, path: str | os.PathLike[str], most: int = MOST_BINARY) -> bytes:
    """The bytes of an input; see ``readable``.

    Raises:
        InputError: as ``readable``, or the file cannot be opened, or does not fit into memory.
    """
    path = readable(name, path, most)
    try:
        with path.open("rb") as file:
            content = file.read(most + 1)
    except (OSError, MemoryError) as error:
        raise InputError(name, f"{path} cannot be read ({_why(error)})", "give another file") from None
    if len(content) > most:  # files of /proc say that they have 0
        raise InputError(name, f"{path} has more than {most:.3g} bytes", "give a smaller file")
    return content


def writable(name: str, path: str | os.PathLike[str], *, locked: bool = False) -> Path:
    """``path`` as a Path, checked before anything is computed for it.

    Args:
        name: the argument's name, for the message.
        path: where a file is to be written.
        locked: take a file, too, that another program is writing: what was computed for it is not to be lost.

    Raises:
        InputError: its folder does not exist or cannot be written to, or it is a folder itself, or write-protected, or
            another program is writing it, or its name is too long.
    """
    path, found = named(name, path), None
    if str(path) == "-":
        raise InputError(name, "- is standard output, which takes the table alone", "give a file's name")
    try:
        path = Path(os.path.realpath(path))  # what a link points to is written, not the link
        found = path.stat()
    except (FileNotFoundError, NotADirectoryError):
        pass
    except (OSError, ValueError) as error:
        raise InputError(name, f"{shortened(path)} cannot be written ({_why(error)})", "give another name") from None
    folder = path.parent
    if not folder.is_dir():
        raise InputError(name, f"the folder {folder} does not exist", "make it first")
    if found is not None and stat.S_ISDIR(found.st_mode):
        raise InputError(name, f"{path} is a folder", "give a file's name")
    # Renaming onto a file needs no right to write it, and a superuser has all rights: its own bits say what is meant.
    if found is not None and (not found.st_mode & 0o222 or not os.access(path, os.W_OK)):
        raise InputError(name, f"{path} is write-protected", "give another name, or chmod u+w it first")
    if found is not None and not locked and _is_being_written(path):
        raise InputError(
            name, f"another program has {path} open for writing", "close it there first, or give another name"
        )
    if not os.access(folder, os.W_OK) and not (found and not stat.S_ISREG(found.st_mode)):
        raise InputError(name, f"the folder {folder} cannot be written to", "choose another")
    return path


def _is_being_written(path: Path) -> bool:
    """Whether a program holds the file for itself, as HDF5 does while it writes.

    A file is replaced, not overwritten: who reads the old one reads on, and is no obstacle. But what somebody still writes into
    it would be lost without a word.
    """
    if fcntl is None or not path.is_file():
        return False
    with contextlib.suppress(OSError), path.open("rb") as file:
        try:
            fcntl.flock(file, fcntl.LOCK_SH | fcntl.LOCK_NB)  # beside readers; closing the file gives it back
        except BlockingIOError:
            return True
        except OSError:  # a file system without locks
            return False
    return False


def held(path: Path) -> IO[bytes] | None:
    """A file, made where there is none, that this process holds for itself until it is closed; None if another holds it.

    A process that is killed holds nothing.
    """
    file = path.open("ab")
    if fcntl is not None:
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            file.close()
            return None
        except OSError:  # a file system without locks
            pass
    return file


def write_whole(name: str, path: Path, write: Callable[[Path], object]) -> None:
    """Let ``write`` fill a temporary file beside ``path``, then rename it; on any failure nothing is left behind.

    Raises:
        InputError: the file could not be written (a full disk, say).
    """
    temporary: Path | None = None
    try:
        if path.exists() and not path.is_file():  # a device or a pipe: there is nothing to rename onto
            write(path)
            return
        ending = path.suffix if len(path.suffix) <= LONGEST_ENDING else ""
        handle, temporary_name = tempfile.mkstemp(prefix=".pearlbvp-", suffix=ending, dir=path.parent)
        os.close(handle)
        temporary = Path(temporary_name)
        write(temporary)
        temporary.chmod(_mode(path))
        temporary.replace(path)
    except Exception as error:
        failed = _of_the_system(error)
        if failed is None:
            raise
        raise InputError(name, f"{path} could not be written ({_why(failed)})", _remedy(failed)) from None
    finally:
        if temporary is not None:
            temporary.unlink(missing_ok=True)


def _of_the_system(error: BaseException | None) -> OSError | None:
    """The system's error behind one of a library, which stumbled over its own half-written file while it closed that."""
    while error is not None and not isinstance(error, OSError):
        error = error.__cause__ or error.__context__
    return error


def _mode(path: Path) -> int:
    """Rights of a file that is to be: those of the one that it replaces, or what the user's mask leaves."""
    if path.exists():
        return stat.S_IMODE(path.stat().st_mode)
    mask = os.umask(0)
    os.umask(mask)
    return 0o666 & ~mask


def shortened(path: str | os.PathLike[str]) -> str:
    """A name for a message: the beginning of one that is too long for a line."""
    text = os.fspath(path)
    return text if len(text) <= 200 else f"{text[:60]}... ({len(text)} characters)"


def _why(error: BaseException) -> str:
    if isinstance(error, MemoryError):
        return "it does not fit into memory"
    return str(getattr(error, "strerror", None) or error)


def _remedy(error: OSError) -> str:
    return "give a shorter name" if error.errno == errno.ENAMETOOLONG else "free space or choose another place"


def check_ending(option: str, path: Path | None, endings: Sequence[str]) -> None:
    """Refuse a file whose ending names no format that can be written, or that has none; devices have none.

    Raises:
        InputError: the option, and the endings that can be.
    """
    if path is None or path.suffix.lower() in endings or str(path) == "-" or (not path.suffix and is_device(path)):
        return
    found = f"the ending {path.suffix}" if path.suffix else "no ending that names its format"
    raise InputError(option, f"{path.name} has {found}", f"give one of {', '.join(endings)}")


def is_device(path: Path) -> bool:
    """Whether a name is that of a device or a pipe."""
    try:
        return path.exists() and not path.is_file()
    except OSError:  # a name that no file can have; who opens it says so
        return False
