"""Reading a map's image: the format is detected from its content, and the size checked before decoding."""

from __future__ import annotations

from pathlib import Path

from trundle.errors import MapError
from trundle.files.opening import describe_unreadable, open_file, read_up_to
from trundle.maps.cells import cell_limit
from trundle.maps.images import bmp, png, pnm
from trundle.maps.images.pixels import Pixels

_HEAD_BYTES = 1 << 16  # headers are in them, also after long comments
_PNG_EXTRA_BYTES = 16_000_000  # of colour profiles and texts beside the pixels
_TRAILING_BYTES = 1 << 16  # padding and colour profiles after the pixels
_DECODED_BYTES = 4  # for each cell of the limit: 8-bit colour with alpha; 16-bit images may have fewer pixels
_TEXT_BYTES = 6  # the same for images as text, of which there are several copies


def read_image(path: Path, *, max_cells: int | None = None) -> Pixels:
    """Read a PNG, PNM or BMP image.

    Args:
        path: The file; its suffix does not matter.
        max_cells: The most pixels to accept; fewer of 16-bit colour and of text. If None, 20 million.

    Raises:
        MapError: If the file cannot be read, is not a PNG, PNM or BMP image, is too large, truncated or damaged.
    """
    most = cell_limit(max_cells)
    try:
        with open_file(path) as stream:
            head = stream.read(_HEAD_BYTES)
            limit = _check_size(head, str(path), most)
            content = head + read_up_to(stream, max(0, limit - len(head)))
            if head[:2] not in pnm.BINARY_MAGIC and stream.read(1):
                raise MapError(f"{path}: the file is far longer than its image needs; write the image again")
    except FileNotFoundError:
        raise MapError(f"{path}: there is no such image file; correct `image` or put the file there") from None
    except OSError as error:
        raise MapError(describe_unreadable(path, error)) from error
    if head[:2] in pnm.MAGIC:
        return pnm.decode_pnm(content, str(path))
    if head.startswith(bmp.SIGNATURE):
        return bmp.decode_bmp(content, str(path))
    return png.decode_png(content, str(path))


def _check_size(head: bytes, name: str, max_cells: int) -> int:
    """Check the size that the header claims; return how many bytes of the file to read."""
    if head[:2] in pnm.MAGIC:
        header = pnm.parse_header(head, name)
        limit = header.offset + header.raster_bytes
        if header.plain:
            limit = min(limit, _TEXT_BYTES * max_cells)
    elif head.startswith(bmp.SIGNATURE):
        header = bmp.parse_header(head, name)
        # Run-length encoding takes at most two bytes per pixel, and two at the end of each row.
        packed = 2 * (header.width + 1) * header.height
        limit = header.offset + max(packed if header.is_packed else 0, header.raster_bytes) + _TRAILING_BYTES
    else:
        if not head:
            raise MapError(f"{name}: the image file is empty; write the image again")
        if not head.startswith(png.SIGNATURE):
            raise MapError(f"{name}: not a PNG, PNM (PGM) or BMP image; convert it to PNG")
        header = png.parse_header(head, name)
        limit = header.decoded_bytes + header.decoded_bytes // 100 + _PNG_EXTRA_BYTES
    cells = header.width * header.height
    if cells > max_cells or header.decoded_bytes > _DECODED_BYTES * max_cells:
        needed = max(cells, -(-header.decoded_bytes // _DECODED_BYTES))
        raise MapError(
            f"{name}: {header.width} x {header.height} pixels need max_cells={needed}, and the limit is {max_cells}, "
            f"which keeps memory within 1.5 GB: raise it (--max-cells {needed}), crop the map or make its cells larger"
        )
    return limit
