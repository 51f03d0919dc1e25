"""Hostile archives: whatever they hold, reading ends soon, within bounds, and writes nothing."""

import gzip
import io
import stat
import tarfile
import zipfile
from collections.abc import Callable

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from logical_robots_tui.lab.platforms.archives import File, UnpackBudget, unpack
from tests.lab.test_handins import tarred, zipped

MB = 1_000_000

many = settings(max_examples=settings().max_examples * 6, deadline=None)


def unpacked(content: bytes, room: UnpackBudget | None = None) -> dict[str, str]:
    """The problems of what is in an archive, by path; "" if it can be read."""
    found = unpack(File(("a.zip",), content), room or UnpackBudget(), lambda _name: MB)
    return {"/".join(file.parts): file.problem for file in found}


def tar_of(*headers: tuple[str, bytes, int], content: bytes = b"") -> bytes:
    """A tar of headers with names, types and sizes, true or not, and no end."""
    blocks = []
    for name, kind, size in headers:
        info = tarfile.TarInfo(name)
        info.type, info.linkname = kind, "/etc/passwd" if kind in b"12" else ""
        block = bytearray(info.tobuf())
        number = size if size >= 0 else 256**12 + size
        block[124:136] = (b"%011o\0" % number) if size >= 0 else number.to_bytes(12, "big")
        block[148:156] = b" " * 8
        block[148:156] = b"%06o\0 " % sum(block)
        blocks.append(bytes(block))
    return b"".join(blocks) + content


@pytest.mark.parametrize("name", ["../x.l", "/x.l", "a/../../x.l", r"..\x.l", r"C:\x.l", "a//x.l"])
@pytest.mark.parametrize("pack", [zipped, tarred])
def test_no_path_leads_out(pack: Callable[[dict[str, str]], bytes], name: str) -> None:
    assert unpacked(pack({name: "x"})) == {"a.zip/x.l": "its path leads out of the archive"}


def test_links_and_devices_are_not_followed() -> None:
    info = zipfile.ZipInfo("x.l")
    info.external_attr = (stat.S_IFLNK | 0o777) << 16
    assert unpacked(zipped({info: "/etc/passwd"})) == {"a.zip/x.l": "it is a link"}
    for kind in (tarfile.SYMTYPE, tarfile.LNKTYPE, tarfile.FIFOTYPE, tarfile.CHRTYPE):
        found = unpacked(tar_of(("x.l", kind, 0), content=bytes(1024)))
        assert found == {"a.zip/x.l": "it is a link"}


def test_what_is_too_much_is_refused() -> None:
    much = "it holds too much"
    many = {f"{number}.l": "" for number in range(101)}
    for pack in (zipped, tarred):
        assert unpacked(pack(many), UnpackBudget(members=100))["a.zip"] == much
        assert "a.zip" not in unpacked(pack(many), UnpackBudget(members=102))
        large = {f"{number}.l": "x" * MB for number in range(5)}
        assert unpacked(pack(large), UnpackBudget(bytes=3 * MB))["a.zip"] == much
        assert unpacked(pack({"x.l": "x" * (MB + 1)})) in (
            {"a.zip/x.l": "it is larger than 1 MB"},
            {"a.zip": much},  # for it is packed very tightly
        )
    assert unpacked(gzip.compress(bytes(40 * MB))) == {"a.zip": much}


@pytest.mark.parametrize("kind", [b"x", b"g", b"X", b"L", b"K"])
def test_headers_can_not_keep_the_parser_busy(kind: bytes) -> None:
    digits = b"1" * 2 * MB
    assert unpacked(tar_of(("x", kind, 2 * MB), content=digits)) == {"a.zip": "it holds too much"}
    assert unpacked(tar_of(("x.l", kind, -512), ("x.l", b"0", 0))) == {"a.zip": "it is damaged"}


def test_encrypted_and_strangely_packed_files_are_told_apart() -> None:
    for method, problem in (
        (zipfile.ZIP_LZMA, "its compression method is not supported"),
        (zipfile.ZIP_STORED, "it is encrypted"),
    ):
        content = bytearray(zipped({"x.l": "x"}, method))
        if method == zipfile.ZIP_STORED:
            content[content.index(b"PK\1\2") + 8] |= 1
        assert unpacked(bytes(content)) == {"a.zip/x.l": problem}


SEEDS = [
    zipped({"a/x.l": "x" * 100, "y.l": "y"}),
    tarred({"a/x.l": "x" * 100, "y" * 120 + ".l": "y"}, "w"),
    *(tarred({"x.l": "x"}, f"w:{kind}") for kind in ("gz", "bz2", "xz")),
]


@many
@given(
    st.sampled_from(SEEDS),
    st.lists(st.tuples(st.integers(0, 20_000), st.integers(0, 255)), max_size=12),
    st.integers(0, 20_000),
)
def test_damage_ends_in_a_problem(seed: bytes, changes: list[tuple[int, int]], length: int) -> None:
    content = bytearray(seed)
    for place, value in changes:
        content[place % len(content)] = value
    room = UnpackBudget(members=100, bytes=MB)
    for file in unpack(File(("a",), bytes(content[: length or None])), room, lambda _name: MB):
        assert file.parts[0] == "a"
        assert not {"..", "", "__MACOSX"} & {*file.parts}
        assert len(file.content) <= MB


@many
@given(st.binary(max_size=2_000), st.sampled_from([b"", b"PK", b"\x1f\x8b", b"BZh", b"\xfd7zXZ\0"]))
def test_noise_is_not_an_archive(noise: bytes, magic: bytes) -> None:
    found = [*unpack(File(("a",), magic + noise), UnpackBudget(), lambda _name: MB)]
    assert all(file.problem or not file.content for file in found)


@many
@given(st.dictionaries(st.text(min_size=1, max_size=30), st.binary(max_size=50), max_size=8))
def test_any_name_stays_inside(files: dict[str, bytes]) -> None:
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w") as archive:
        for name, content in files.items():
            try:
                archive.writestr(name, content)
            except (IndexError, UnicodeEncodeError):  # no name, or half of a pair
                continue
    for file in unpack(File(("a",), out.getvalue()), UnpackBudget(), lambda _name: MB):
        assert file.parts[0] == "a"
        assert not any("/" in part or part in ("", ".", "..") for part in file.parts[1:])
