"""A drawing with its scale and a caption: the picture that a notebook shows for a value."""

from __future__ import annotations

import io
from collections.abc import Sequence

from PIL import Image, ImageDraw

from trundle.pictures.colors import FAINT, HAIRLINE, INK, PAGE
from trundle.pictures.text import draw_scale, font, plain, shorten

MAX_DRAWING = 900
"""Largest side of the drawing in a figure [px]; with its margins and captions a figure has at most 1000."""

_EDGE = 16
_LEAST_WIDTH = 480
_FOOT = 48
_ROW = 22


def make_figure(drawing: Image.Image, pixels_per_metre: float, title: str, lines: Sequence[str] = ()) -> Image.Image:
    """Set a drawing on a page.

    Args:
        drawing: At most `MAX_DRAWING` pixels wide and high.
        pixels_per_metre: For the scale bar.
        title: Above the drawing.
        lines: Below it, beside the scale bar; what does not fit is cut.
    """
    width = max(drawing.width, _LEAST_WIDTH) + 2 * _EDGE
    head = _EDGE + 24
    foot = max(_FOOT, _ROW * len(lines) + 14)
    page = Image.new("RGB", (width, head + drawing.height + foot), PAGE)
    draw = ImageDraw.Draw(page)
    draw.text((_EDGE, 10), shorten(plain(title), font(18), width - 2 * _EDGE), font=font(18), fill=INK)
    left = (width - drawing.width) // 2
    page.paste(drawing, (left, head))
    draw.rectangle((left - 1, head - 1, left + drawing.width, head + drawing.height), outline=HAIRLINE)
    top = head + drawing.height
    begin = draw_scale(draw, _EDGE, top + 27, pixels_per_metre) + 24
    for index, line in enumerate(lines):
        text = shorten(plain(line), font(15), width - _EDGE - begin)
        draw.text((begin, top + 12 + _ROW * index), text, font=font(15), fill=FAINT)
    return page


def to_png(image: Image.Image) -> bytes:
    """Return a picture as the bytes of a PNG file."""
    content = io.BytesIO()
    image.save(content, format="PNG", compress_level=4)
    return content.getvalue()
