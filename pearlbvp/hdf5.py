"""Trees of arrays, numbers and words in HDF5 files: whole, readable by any HDF5 library, with no pickle in them.

A file begins with a user block of 512 bytes, which HDF5 leaves alone: two lines of text that name the kind of file and the
SHA-256 of all that follows. So every byte is vouched for before HDF5 looks at one, and a file that was cut off, damaged or
changed is known as such. Arrays are datasets with fletcher32, the checksum that other programs look at; numbers and words are
attributes; what is a mapping is a group.

HDF5 itself works in memory only. It leaves open what it cannot write on a full disk, waits for locks that a network's file
system does not have, and follows links into other files; none of that can happen to bytes that are read or written at once.
"""

from __future__ import annotations

import hashlib
import io
import os
import re
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, field
from typing import Any, TypeVar

import h5py
import numpy as np

from pearlbvp.errors import InputError
from pearlbvp.files import MOST_BINARY, read_whole, writable, write_whole

FORMAT = 2
"""Number of the layout; files of others are refused."""

HEADER = 512
"""Bytes of the user block, the smallest that HDF5 has."""

SIGNATURE = b"\x89HDF\r\n\x1a\n"
"""How HDF5 files begin."""

SUPERBLOCK = SIGNATURE + b"\x03"
"""How HDF5 files begin whose objects have checksums, which are those of its format of version 1.10."""

OPEN_FLAGS = 11
"""Place of the byte that is not 0 while a program has the file open for writing, or where it was killed meanwhile."""

OF_KIND = re.compile(rb"(pearlbvp [a-z ]{1,40}), format (\d{1,9})")
"""The first line of a saved file, of whatever kind and format."""

VERSIONS = ("v110", "v110")

MOST_OBJECTS = 1_000_000
"""Groups, datasets and attributes that a file may have."""

DEEPEST = 8
"""Groups within groups that a file may have."""

Tree = Mapping[str, Any]
"""Names with arrays, numbers, words, or trees again."""

AGAIN = "give an intact copy, or compute it anew"
"""What helps where a file is damaged, which may be the only one."""

T = TypeVar("T")


def save_tree(name: str, path: str | os.PathLike[str], kind: str, tree: Tree) -> None:
    """Write a tree into a file, whole or not at all.

    Args:
        name: the argument's name, for the message.
        path: where to.
        kind: what the file holds, in a word or two.
        tree: its content. A file that another program is writing is replaced, so that this is not lost; the command
            line refuses it before anything is computed.

    Raises:
        InputError: the place cannot be written to.
    """
    path = writable(name, path, locked=True)
    memory = io.BytesIO()
    with h5py.File(memory, "w", libver=VERSIONS, userblock_size=HEADER) as file:
        _write(file, tree)
    image = memory.getvalue()[HEADER:]
    if len(image) > MOST_BINARY:
        raise InputError(name, f"it would have more than {MOST_BINARY:.3g} bytes", "save a shorter run")
    write_whole(name, path, lambda temporary: temporary.write_bytes(sealed(kind, image)))


def sealed(kind: str, image: bytes) -> bytes:
    """An HDF5 file's bytes behind the lines that vouch for them."""
    lines = f"{kind}, format {FORMAT}\nsha256 {hashlib.sha256(image).hexdigest()}\n"
    return lines.encode().ljust(HEADER, b"\0") + image


def load_tree(
    name: str,
    path: str | os.PathLike[str],
    kind: str,
    make: Callable[[dict[str, Any]], T],
    *,
    writer: str,
    undefined: Collection[str] = (),
) -> T:
    """What ``make`` makes of the tree that ``save_tree`` wrote. Nothing in the file is executed.

    Args:
        name: the argument's name, for the message.
        path: of the file.
        kind: what the file must hold.
        make: raises an ordinary error where something is missing in the tree, or does not fit.
        writer: what wrote such files, for the message.
        undefined: names of numbers that may be NaN; all others must be finite.

    Raises:
        InputError: there is no such file, it is none of these, it was damaged or changed, or ``make`` failed.
    """
    content = read_whole(name, path)
    image = _unsealed(name, path, kind, content, writer)
    try:
        with h5py.File(h5py.h5f.open_file_image(image), "r") as file:
            tree = _Reader(len(image), frozenset(undefined)).group(file, DEEPEST)
        return make(tree)
    except InputError:
        raise
    except (
        OSError, RuntimeError, LookupError, ValueError, TypeError, AttributeError, ArithmeticError, MemoryError
    ):  # fmt: skip
        raise InputError(
            name, f"{path} cannot be read as a saved {_what(kind)}: something is missing or misplaced in it", AGAIN
        ) from None


def _unsealed(name: str, path: str | os.PathLike[str], kind: str, content: bytes, writer: str) -> bytes:
    """The HDF5 file behind the lines that vouch for it, if they do.

    Raises:
        InputError: it is no such file, or not as it was when it was written.
    """
    first, _, rest = content[:HEADER].rstrip(b"\0").partition(b"\n")
    image = content[HEADER:]
    if first == f"{kind}, format {FORMAT}".encode():
        if rest != f"sha256 {hashlib.sha256(image).hexdigest()}\n".encode() or not image.startswith(SUPERBLOCK):
            if image.startswith(SUPERBLOCK) and image[OPEN_FLAGS : OPEN_FLAGS + 1] > b"\0":
                raise InputError(name, f"another program has {path} open for writing", "close it there first")
            raise InputError(name, f"{path} is not as it was saved: it was cut off, damaged or changed since", AGAIN)
        return image
    what = f"no {_what(kind)} saved by this version"
    if not content:
        what += ", but empty"
    elif SIGNATURE not in content[: 2 * HEADER]:
        what += ": it is no HDF5 file"
    elif (other := OF_KIND.fullmatch(first)) and other[1] != kind.encode():
        what += f", but a saved {_what(other[1].decode())}"
    elif other:
        what += f", but by another, whose format is {int(other[2])}"
    elif b"pearlbvp" in first:
        what += ": its first line is damaged"
    raise InputError(name, f"{path} is {what}", f"give one that {writer} wrote")


def kind_of(name: str, path: str | os.PathLike[str]) -> str:
    """What a file says that it holds, in the words of ``save_tree``; nothing of files of other programs, and damaged ones.

    Args:
        name: the argument's name, for the message.
        path: of the file.

    Raises:
        InputError: there is no such file, or it cannot be read.
    """
    other = OF_KIND.fullmatch(read_whole(name, path)[:HEADER].partition(b"\n")[0])
    return other[1].decode() if other else ""


def group_of(name: str, path: str | os.PathLike[str], group: str) -> dict[str, Any]:
    """A group of numbers and words of a saved file; empty where there is none, or no such file, which its reader refuses.

    Args:
        name: the argument's name, for the messages.
        path: of the file.
        group: its name.

    Raises:
        ValueError, LookupError, TypeError: it holds what is never written.
    """
    try:
        image = _unsealed(name, path, kind_of(name, path), read_whole(name, path), "")
    except InputError:
        return {}
    with h5py.File(h5py.h5f.open_file_image(image), "r") as file:
        return _Reader(len(image), frozenset()).group(file[group], 1) if group in file else {}


def _what(kind: str) -> str:
    return kind.removeprefix("pearlbvp ")


def _write(group: Any, tree: Tree) -> None:
    for name, value in tree.items():
        if isinstance(value, Mapping):
            _write(group.create_group(name), value)
        elif isinstance(value, np.ndarray):
            chunk = {"chunks": value.shape, "fletcher32": True} if value.size else {}  # nothing needs no checksum
            group.create_dataset(name, data=value, **chunk)
        elif isinstance(value, str):
            word = value.encode()
            group.attrs.create(name, np.array(word), dtype=h5py.string_dtype("utf-8", max(len(word), 1)))
        else:
            group.attrs[name] = value


@dataclass
class _Reader:
    """Walks through a file that may lie about sizes, and reads no more than it has bytes.

    Attributes:
        room: bytes that may still be read.
        undefined: names of numbers that may be NaN.
        seen: addresses of what was read already; nothing has two names.
    """

    room: int
    undefined: frozenset[str]
    seen: set[int] = field(default_factory=set)
    objects: int = 0

    def group(self, group: Any, deepest: int) -> dict[str, Any]:
        """A group as a tree.

        Raises:
            ValueError: it holds what is never written.
        """
        if deepest == 0:
            raise ValueError("groups within groups")
        self._first_time(group)
        self._count(len(group) + len(group.attrs))
        tree: dict[str, Any] = {}
        for name in group:
            if group.id.links.get_info(name.encode()).type != h5py.h5l.TYPE_HARD:
                raise ValueError(f"{name}: a link to elsewhere")
            found = group[name]
            tree[name] = self.group(found, deepest - 1) if isinstance(found, h5py.Group) else self._array(name, found)
        return tree | {name: self._attribute(name, group.attrs.get_id(name)) for name in group.attrs}

    def _first_time(self, found: Any) -> None:
        address = h5py.h5o.get_info(found.id).addr
        if address in self.seen:
            raise ValueError("two names of one thing")
        self.seen.add(address)

    def _count(self, more: int) -> None:
        self.objects += more
        if self.objects > MOST_OBJECTS:
            raise ValueError("too many objects")

    def _take(self, name: str, shape: Any, dtype: np.dtype[Any], kinds: str) -> int:
        """Bytes of an array of numbers or of a word, if the file has so many left."""
        if shape is None or dtype.kind not in kinds or dtype.hasobject:
            raise ValueError(f"{name}: neither numbers nor a word")
        size = dtype.itemsize
        for extent in shape:
            size *= int(extent)
        if size > self.room:
            raise ValueError(f"{name}: larger than the file")
        self.room -= size
        return size

    def _array(self, name: str, found: Any) -> Any:
        """An array, whose bytes must be in the file as they were written: in one piece, with its checksum."""
        if not isinstance(found, h5py.Dataset):
            raise ValueError(f"{name}: neither a group nor a dataset")
        self._first_time(found)
        size = self._take(name, found.shape, found.dtype, "fiub")
        layout = found.id.get_create_plist()
        filters = [layout.get_filter(i)[0] for i in range(layout.get_nfilters())]
        if size and (
            layout.get_layout() != h5py.h5d.CHUNKED
            or filters != [h5py.h5z.FILTER_FLETCHER32]
            or found.chunks != found.shape
            or found.id.get_storage_size() < size
        ):
            raise ValueError(f"{name}: not as it is written")
        return self._finite(name, found[()] if size else np.zeros(found.shape, found.dtype))

    def _attribute(self, name: str, found: Any) -> Any:
        self._take(name, found.shape, found.dtype, "fiubS")
        if found.dtype.kind != "S":
            value = np.zeros(found.shape, found.dtype)
            found.read(value)
            self._finite(name, value)
            return value if value.shape else value.item()
        word = np.zeros(found.shape, found.dtype)
        found.read(word, mtype=found.get_type())
        return bytes(word.item()).decode()  # fails for several

    def _finite(self, name: str, value: Any) -> Any:
        if name not in self.undefined and not np.isfinite(value).all():
            raise ValueError(f"{name}: not finite")
        return value
