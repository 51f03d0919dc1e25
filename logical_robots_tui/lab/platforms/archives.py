"""Zip and tar archives from strangers, read within bounds and never unpacked; archives of ours."""

from __future__ import annotations

import bz2
import io
import lzma
import stat
import tarfile
import zipfile
import zlib
from collections.abc import Callable, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass
from datetime import datetime
from typing import Any, NamedTuple

MOST_PACKED = 200_000_000
"""Bytes of an archive that holds a whole class."""

_LONGEST_PATH = 500  # characters; names are matched with patterns
_LONGEST_NAME = 100
_MOST_RATIO = 200
_SLACK = 1_000_000  # bytes of which the ratio does not matter
_ENDINGS = (".tar.gz", ".tar.bz2", ".tar.xz", ".zip", ".tar", ".tgz", ".tbz2", ".txz")
_UNREADABLE = (
    *(zipfile.BadZipFile, tarfile.TarError, lzma.LZMAError, zlib.error),
    *(EOFError, LookupError, OSError, OverflowError, RuntimeError, ValueError),
)


class _BudgetError(ValueError):
    def __str__(self) -> str:
        return "it holds too much"


class File(NamedTuple):
    """A file that was handed in, with its time of change; `problem` is why it can't be read.

    The names of the archives that it was in are among its `parts`.
    """

    parts: tuple[str, ...]
    content: bytes = b""
    mtime: float = 0.0
    problem: str = ""


@dataclass(slots=True)
class UnpackBudget:
    """What may still be unpacked of one submission."""

    members: int = 10_000
    bytes: int = 50_000_000

    def spend(self, size: int, packed_size: int) -> None:
        """Count a file of an archive of `packed` bytes; raise an error if it is too much."""
        self.members -= 1
        self.bytes -= size
        if self.members < 0 or self.bytes < 0 or size > max(_SLACK, _MOST_RATIO * packed_size):
            raise _BudgetError


class _Member(NamedTuple):
    name: str
    mtime: float
    problem: str
    read: Callable[[int], bytes]


def is_archive(name: str) -> bool:
    return name.casefold().endswith(_ENDINGS)


def stem_of(name: str, *endings: str) -> str:
    """Return a file's name without the ending of an archive, or one of `endings`, in any case."""
    for ending in (*_ENDINGS, *endings):
        if name.casefold().endswith(ending):
            return name[: -len(ending)]
    return name


def is_hidden(name: str) -> bool:
    return name.startswith(".") or name == "__MACOSX"


def unpack(archive: File, budget: UnpackBudget, limit_of: Callable[[str], int]) -> Iterator[File]:
    """Yield the files of an archive, with contents of at most `limit_of(name)` bytes.

    Links and paths that lead out of it are files with a problem, and so is the archive itself if
    it is damaged or exceeds `budget`.
    """
    members_of = _zip_members if archive.content[:2] == b"PK" else _tar_members
    try:
        for member in members_of(archive.content, budget):
            parts = tuple(part for part in member.name.replace("\\", "/").split("/") if part != ".")
            problem, content = member.problem, b""
            if not parts or any(is_hidden(part) for part in parts if part != ".."):
                continue
            if len(member.name) > _LONGEST_PATH:
                parts, problem = (parts[0][:_LONGEST_NAME] or "?",), "its path is too long"
            elif "" in parts or ".." in parts or ":" in parts[0]:
                parts = tuple(part for part in parts if part not in ("", ".."))[-1:] or ("?",)
                problem = "its path leads out of the archive"
            if not problem and (limit := limit_of(parts[-1])):
                try:
                    content = member.read(limit + 1)
                except _UNREADABLE:
                    problem = "it is damaged"
                if len(content) > limit:
                    content, problem = b"", f"it is larger than {limit // 10**6} MB"
            budget.spend(len(content), len(archive.content))
            yield File((*archive.parts, *parts), content, member.mtime, problem)
    except _UNREADABLE as error:
        reason = str(error) if isinstance(error, _BudgetError) else "it is damaged"
        yield File(archive.parts, problem=reason)


def _zip_members(content: bytes, budget: UnpackBudget) -> Iterator[_Member]:
    if content.count(b"PK\1\2") > budget.members:  # each takes memory as soon as it is opened
        raise _BudgetError
    with zipfile.ZipFile(io.BytesIO(content)) as archive:
        for entry in archive.infolist():
            if entry.is_dir():
                continue
            name = entry.filename
            if not entry.flag_bits & 0x800:  # what macOS packs is UTF-8 without saying so
                with suppress(UnicodeError):
                    name = name.encode("cp437").decode()
            problem = "it is a link" if stat.S_ISLNK(entry.external_attr >> 16) else ""
            if entry.flag_bits & 1:
                problem = "it is encrypted"
            elif entry.compress_type not in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED):
                problem = "its compression method is not supported"
            try:
                mtime = datetime(*entry.date_time).timestamp()
            except (OverflowError, ValueError):
                mtime = 0.0

            def read(size: int, entry: zipfile.ZipInfo = entry) -> bytes:
                with archive.open(entry) as file:
                    return file.read(size)

            yield _Member(name, mtime, problem, read)


def _tar_members(content: bytes, budget: UnpackBudget) -> Iterator[_Member]:
    decompressor: Any = None
    if content[:2] == b"\x1f\x8b":
        decompressor = zlib.decompressobj(31)
    elif content[:3] == b"BZh":
        decompressor = bz2.BZ2Decompressor()
    elif content[:6] == b"\xfd7zXZ\0":
        decompressor = lzma.LZMADecompressor(memlimit=_SLACK * 100)
    if decompressor:
        packed_size, content = len(content), decompressor.decompress(content, budget.bytes + 1)
        budget.spend(len(content), packed_size)

    class ArchiveHeader(_TarHeader):
        extension_bytes = 0

    with tarfile.open(fileobj=io.BytesIO(content), mode="r:", tarinfo=ArchiveHeader) as archive:
        for header in archive:
            if header.isdir():
                continue
            problem = "" if header.isreg() and not header.issparse() else "it is a link"

            def read(size: int, header: tarfile.TarInfo = header) -> bytes:
                file = archive.extractfile(header)
                return file.read(size) if file else b""

            yield _Member(header.name, min(max(float(header.mtime), 0.0), 4e9), problem, read)


class _TarHeader(tarfile.TarInfo):
    """A header that refuses what keeps the parser busy: long or many headers of headers."""

    extension_bytes: int

    @classmethod
    def frombuf(cls, buf: bytes | bytearray, encoding: str, errors: str) -> _TarHeader:
        header = super().frombuf(buf, encoding, errors)
        if header.size < 0:
            raise tarfile.ReadError("a file of a negative size")
        if header.type in b"xgXLK":
            cls.extension_bytes += header.size
            if header.size > 8_000 or cls.extension_bytes > 250_000:
                raise _BudgetError
        return header


def is_script(text: str) -> bool:
    return text.startswith("#!")


def pack(texts: Mapping[str, str]) -> bytes:
    """Return files by path as a zip archive, which is the same each time."""
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w") as archive:
        for path, text in texts.items():
            entry = zipfile.ZipInfo(path)  # of 1980
            entry.external_attr = (0o755 if is_script(text) else 0o644) << 16
            archive.writestr(entry, text.encode(), zipfile.ZIP_DEFLATED)
    return buffer.getvalue()
