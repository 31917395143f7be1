"""The check of a .vtu file's size when it is unpacked, before any of its content is kept.

A compressed array has a header of integers (number of blocks, size of a block, size of the last
block, packed size of each block) and the blocks. The check does not trust the sizes in the header:
it unpacks each block, up to the limit.
"""

import base64
import lzma
import re
import zlib
from collections.abc import Callable, Iterator
from typing import Any
from xml.etree import ElementTree

MOST_UNPACKED = 400_000_000
"""Largest size [bytes] of all unpacked arrays of a .vtu file; a larger file is refused.

Some 2 million nodes with their cells and groups have this size.
"""
MOST_ARRAYS = 200
"""Largest number of arrays in a .vtu file; a file with more arrays is refused.

The check of the file's size then takes no longer than reading the file.
"""
_HEADER_WIDTHS = {"UInt32": 4, "UInt64": 8}
"""Size [bytes] of an integer in the header of an array, by the header's type."""
_RAW_APPENDED = re.compile(rb"<AppendedData[^>]*>")
"""The tag in front of appended data, which may be raw bytes."""


def check_unpacked_size(data: bytes) -> None:
    """Refuse the content of a .vtu file that would unpack to more than MOST_UNPACKED bytes.

    Other faults are left to the reader of the file.

    Raises
    ------
    ValueError
        with a line that says why the file is refused
    """
    if b"<!DOCTYPE" in data or b"<!ENTITY" in data:
        raise ValueError("defines entities of its own")
    if data.count(b"<DataArray") > MOST_ARRAYS:
        raise ValueError(f"has more than {MOST_ARRAYS} arrays")
    head, raw = _split_raw_data(data)
    root = ElementTree.fromstring(head)
    if root.get("compressor") is None:
        return
    width = _HEADER_WIDTHS[root.get("header_type", "UInt32")]
    order = "big" if root.get("byte_order") == "BigEndian" else "little"
    unpacker = (
        lzma.LZMADecompressor if "LZMA" in str(root.get("compressor")) else zlib.decompressobj
    )
    room = MOST_UNPACKED
    for packed in _packed_blocks_of_arrays(root, raw, width, order):
        room -= _size_when_unpacked(packed, unpacker, room)


def _split_raw_data(data: bytes) -> tuple[bytes, bytes | None]:
    """The XML of a .vtu file, and the raw bytes in its middle or None without raw bytes."""
    found = _RAW_APPENDED.search(data)
    if found is None or b'encoding="raw"' not in found.group():
        return data, None
    end = data.rindex(b"</AppendedData>")
    return data[: found.end()] + data[end:], data[found.end() : end].split(b"_", 1)[1]


def _packed_blocks_of_arrays(
    root: Any, raw: bytes | None, width: int, order: Any
) -> Iterator[bytes]:
    """The packed blocks of all arrays, one after the other."""
    # Raw arrays follow each other without a gap; arrays in base64 stand in elements of the XML.
    if raw is not None:
        at = 0
        while at + width <= len(raw):
            sizes = _packed_block_sizes(raw[at:], width, order)
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
        text = (array.text or "").strip()
        if kind == "appended":
            text = rest[int(array.get("offset", "0")) :]
        sizes = _packed_block_sizes(
            base64.b64decode(text[: _letters_of_base64(width)])[:width], width, order, text
        )
        at = _letters_of_base64(width * (3 + len(sizes)))
        content = base64.b64decode(text[at : at + _letters_of_base64(sum(sizes))])
        for size in sizes:
            yield content[:size]
            content = content[size:]


def _packed_block_sizes(data: bytes, width: int, order: Any, text: str | None = None) -> list[int]:
    """The packed sizes of the blocks of an array, from its header.

    `data` begins the array. Where the array is in base64, `text` is all of it, of which data is the
    unpacked beginning.
    """
    count = int.from_bytes(data[:width], order)
    length = width * (3 + count)
    if text is not None:
        if _letters_of_base64(length) > len(text):
            raise ValueError("has an array that is shorter than its head says")
        data = base64.b64decode(text[: _letters_of_base64(length)])
    if length > len(data):
        raise ValueError("has an array that is shorter than its head says")
    return [int.from_bytes(data[i : i + width], order) for i in range(3 * width, length, width)]


def _letters_of_base64(count: int) -> int:
    """The number of letters of base64 that `count` bytes take."""
    return -(-count // 3) * 4


def _size_when_unpacked(packed: bytes, unpacker: Callable[[], Any], room: int) -> int:
    """The size [bytes] of a block when unpacked. Raises ValueError beyond `room` bytes."""
    # Pieces of a megabyte keep the memory small, however much the block unpacks to.
    machine, size = unpacker(), 0
    while True:
        piece = machine.decompress(packed, 1 << 20)
        size += len(piece)
        if size > room:
            raise ValueError(f"unpacks to more than {MOST_UNPACKED} bytes")
        packed = getattr(machine, "unconsumed_tail", b"")
        if machine.eof or not (piece or packed):
            return size
