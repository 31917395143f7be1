"""The check that the compressed arrays of a .vtu mesh file do not fill the memory when unpacked.

A compressed array has a header of integers (number of blocks, size of a block, size of the last
block, packed size of each block) and the blocks. The sizes in the header may be false. The check
therefore unpacks each block up to the limit, and keeps nothing of it.
"""

import base64
import lzma
import re
import zlib
from collections.abc import Callable, Iterator
from typing import Any, NamedTuple
from xml.etree import ElementTree

LARGEST_UNPACKED_VTU_SIZE = 400_000_000
"""Largest size [bytes] of all unpacked arrays of a .vtu file; a larger file is refused.

Some 2 million nodes with their cells and groups have this size.
"""
MOST_VTU_ARRAYS = 200
"""Largest number of arrays in a .vtu file; a file with more arrays is refused.

The check of the file's size then takes no longer than reading the file.
"""
_BYTES_OF_VTU_HEADER_INTEGER = {"UInt32": 4, "UInt64": 8}
"""Size [bytes] of an integer in the header of a compressed array, by the file's header type."""
_APPENDED_DATA_TAG_PATTERN = re.compile(rb"<AppendedData[^>]*>")
"""Pattern of the XML tag in a .vtu file after which the appended arrays begin, raw or as text."""


def check_decompressed_vtu_size_fits_memory(data: bytes) -> None:
    """Refuse the content of a .vtu file whose arrays are larger than LARGEST_UNPACKED_VTU_SIZE.

    Other faults of the file are found later, when it is read.

    Raises
    ------
    ValueError
        with a line that says why the file is refused
    """
    if b"<!DOCTYPE" in data or b"<!ENTITY" in data:
        raise ValueError("defines entities of its own")
    if data.count(b"<DataArray") > MOST_VTU_ARRAYS:
        raise ValueError(f"has more than {MOST_VTU_ARRAYS} arrays")
    head, raw = _split_vtu_into_xml_and_raw_bytes(data)
    root = ElementTree.fromstring(head)
    if root.get("compressor") is None:
        return
    width = _BYTES_OF_VTU_HEADER_INTEGER[root.get("header_type", "UInt32")]
    order = "big" if root.get("byte_order") == "BigEndian" else "little"
    unpacker = (
        lzma.LZMADecompressor if "LZMA" in str(root.get("compressor")) else zlib.decompressobj
    )
    room = LARGEST_UNPACKED_VTU_SIZE
    for packed in _compressed_blocks_of_vtu_arrays(root, raw, width, order):
        room -= _size_of_decompressed_block(packed, unpacker, room)


def _split_vtu_into_xml_and_raw_bytes(data: bytes) -> tuple[bytes, bytes | None]:
    """Split a .vtu file into its XML and its raw bytes, which are None if it has no raw bytes."""
    found = _APPENDED_DATA_TAG_PATTERN.search(data)
    if found is None or b'encoding="raw"' not in found.group():
        return data, None
    end = data.rindex(b"</AppendedData>")
    return data[: found.end()] + data[end:], data[found.end() : end].split(b"_", 1)[1]


def _compressed_blocks_of_vtu_arrays(
    root: Any, raw: bytes | None, width: int, order: Any
) -> Iterator[bytes]:
    """Yield the packed blocks of all arrays of a .vtu file, one after the other.

    Parameters
    ----------
    root : root element of the file's XML
    raw : raw bytes of all appended arrays; None if they are text in base64
    width : size [bytes] of an integer in the header of an array
    order : order of the bytes of an integer: "big" or "little"

    Raises
    ------
    ValueError
        for an array that is shorter than its header says
    """
    appended = root.find("AppendedData")
    text = "" if appended is None else (appended.text or "").strip()[1:]
    for array in root.iter("DataArray"):
        # An array stands in its XML element, or at its offset in the appended data.
        if array.get("format") == "binary":
            stored = _StoredVtuArray((array.text or "").strip().encode(), is_base64=True)
        elif array.get("format") == "appended":
            data = text.encode() if raw is None else raw
            stored = _StoredVtuArray(data[int(array.get("offset", "0")) :], is_base64=raw is None)
        else:
            continue
        # The first integer is the number of blocks. Then follow the unpacked sizes of a block and
        # of the last block, and the packed size of each block.
        count = int.from_bytes(stored.bytes_of_part(0, width), order)
        length = width * (3 + count)
        header = stored.bytes_of_part(0, length)
        if len(header) < length:
            raise ValueError("has an array that is shorter than its head says")
        sizes = [
            int.from_bytes(header[i : i + width], order) for i in range(3 * width, length, width)
        ]
        content = stored.bytes_of_part(length, sum(sizes))
        for size in sizes:
            yield content[:size]
            content = content[size:]


class _StoredVtuArray(NamedTuple):
    """A compressed array as a .vtu file stores it, and whether it is text in base64."""

    data: bytes
    is_base64: bool

    def bytes_of_part(self, start: int, count: int) -> bytes:
        """The `count` bytes that follow the first part of `start` bytes; base64 codes each part."""
        if not self.is_base64:
            return self.data[start : start + count]
        first, length = map(_number_of_base64_letters_for_bytes, (start, count))
        return base64.b64decode(self.data[first : first + length])[:count]


def _number_of_base64_letters_for_bytes(count: int) -> int:
    """The number of characters that `count` bytes take as text in base64."""
    return -(-count // 3) * 4


def _size_of_decompressed_block(packed: bytes, unpacker: Callable[[], Any], room: int) -> int:
    """The size [bytes] of a packed block when it is unpacked.

    ValueError is raised if the size is above `room` bytes. `unpacker` makes an object with a method
    `decompress` for a packed block.
    """
    # The block is unpacked in pieces of a megabyte, so that little memory is used.
    machine, size = unpacker(), 0
    while True:
        piece = machine.decompress(packed, 1 << 20)
        size += len(piece)
        if size > room:
            raise ValueError(f"unpacks to more than {LARGEST_UNPACKED_VTU_SIZE} bytes")
        packed = getattr(machine, "unconsumed_tail", b"")
        if machine.eof or not (piece or packed):
            return size
