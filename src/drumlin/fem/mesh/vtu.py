"""How much a .vtu file holds when it is unpacked, found out before anything of it is kept.

Compressed arrays are a head of integers (count of blocks, size of a block, size of the last one,
packed size of each) and the blocks. The sizes in the head are not believed: each block is unpacked
here, up to the limit.
"""

import base64
import lzma
import re
import zlib
from collections.abc import Callable, Iterator
from typing import Any
from xml.etree import ElementTree

MOST_UNPACKED = 400_000_000  # bytes of all arrays: some 2 million nodes with their cells and groups
MOST_ARRAYS = 200
_HEADER_WIDTHS = {"UInt32": 4, "UInt64": 8}
_RAW_APPENDED = re.compile(rb"<AppendedData[^>]*>")


def check_unpacked(data: bytes) -> None:
    """Raise ValueError for the content of a .vtu file that would unpack to more than MOST_UNPACKED
    bytes.

    What is wrong otherwise is left to whoever reads it.
    """
    if b"<!DOCTYPE" in data or b"<!ENTITY" in data:
        raise ValueError("defines entities of its own")
    if data.count(b"<DataArray") > MOST_ARRAYS:
        raise ValueError(f"has more than {MOST_ARRAYS} arrays")
    head, raw = _parts(data)
    root = ElementTree.fromstring(head)
    if root.get("compressor") is None:
        return
    width = _HEADER_WIDTHS[root.get("header_type", "UInt32")]
    order = "big" if root.get("byte_order") == "BigEndian" else "little"
    unpacker = (
        lzma.LZMADecompressor if "LZMA" in str(root.get("compressor")) else zlib.decompressobj
    )
    room = MOST_UNPACKED
    for packed in _arrays(root, raw, width, order):
        room -= _unpacked(packed, unpacker, room)


def _parts(data: bytes) -> tuple[bytes, bytes | None]:
    """The XML of a file, and the raw bytes that may stand in the middle of it."""
    found = _RAW_APPENDED.search(data)
    if found is None or b'encoding="raw"' not in found.group():
        return data, None
    end = data.rindex(b"</AppendedData>")
    return data[: found.end()] + data[end:], data[found.end() : end].split(b"_", 1)[1]


def _arrays(root: Any, raw: bytes | None, width: int, order: Any) -> Iterator[bytes]:
    """The packed blocks of all arrays."""
    if raw is not None:
        at = 0
        while at + width <= len(raw):
            sizes = _sizes(raw[at:], width, order)
            at += width * (3 + len(sizes))
            for size in sizes:
                yield raw[at : at + size]
                at += size
        return
    appended = root.find("AppendedData")
    rest = "" if appended is None else (appended.text or "").strip()[1:]
    for array in root.iter("DataArray"):
        kind = array.get("format")
        if kind not in {"binary", "appended"}:
            continue
        text = (
            rest[int(array.get("offset", "0")) :]
            if kind == "appended"
            else (array.text or "").strip()
        )
        sizes = _sizes(base64.b64decode(text[: _letters(width)])[:width], width, order, text)
        at = _letters(width * (3 + len(sizes)))
        content = base64.b64decode(text[at : at + _letters(sum(sizes))])
        for size in sizes:
            yield content[:size]
            content = content[size:]


def _sizes(data: bytes, width: int, order: Any, text: str | None = None) -> list[int]:
    """The packed sizes of the blocks, from the head of an array; `text`: the array in base64, which
    data begins.
    """
    count = int.from_bytes(data[:width], order)
    length = width * (3 + count)
    if text is not None:
        if _letters(length) > len(text):
            raise ValueError("has an array that is shorter than its head says")
        data = base64.b64decode(text[: _letters(length)])
    if length > len(data):
        raise ValueError("has an array that is shorter than its head says")
    return [int.from_bytes(data[i : i + width], order) for i in range(3 * width, length, width)]


def _letters(count: int) -> int:
    """Letters of base64 that `count` bytes take."""
    return -(-count // 3) * 4


def _unpacked(packed: bytes, unpacker: Callable[[], Any], room: int) -> int:
    """How many bytes a block unpacks to. Raises ValueError beyond `room`."""
    machine, size = unpacker(), 0
    while True:
        piece = machine.decompress(packed, 1 << 20)
        size += len(piece)
        if size > room:
            raise ValueError(f"unpacks to more than {MOST_UNPACKED} bytes")
        packed = getattr(machine, "unconsumed_tail", b"")
        if machine.eof or not (piece or packed):
            return size
