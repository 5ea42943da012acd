"""Text and scale bars in pictures, and a drawing with a caption: what a notebook shows for a value."""

from __future__ import annotations

import io
from collections.abc import Callable, Sequence
from functools import lru_cache

from PIL import Image, ImageDraw, ImageFont

from trundle.pictures.colors import FAINT, HAIRLINE, INK, PAGE

Font = ImageFont.FreeTypeFont | ImageFont.ImageFont


@lru_cache(maxsize=16)
def font(size: int) -> Font:
    """Return the font of that size [px]."""
    return ImageFont.load_default(size)


def plain(text: str) -> str:
    """Replace letters that the font does not have."""
    known = set("·±°…")
    text = text.replace("²", "2").replace("×", "x")
    return "".join(one if one in known or (one.isascii() and one.isprintable()) else "?" for one in text)


def text_length(letters: Font) -> Callable[[str], float]:
    """Return the function that measures texts in this font [px]."""
    return lambda text: float(letters.getlength(text))


def shorten(text: str, letters: Font, room: float) -> str:
    """Cut a text to `room` [px], with an ellipsis at the end."""
    length = text_length(letters)
    if length(text) <= room:
        return text
    while text and length(text + "…") > room:
        text = text[:-1]
    return text + "…"


def scale_length(pixels_per_metre: float) -> float:
    """Return the length of the scale bar [m]: a round one, of 70 pixels or more where it can be."""
    lengths = [one * power for power in (1e-3, 1e-2, 0.1, 1.0, 10.0, 100.0, 1e3, 1e4) for one in (1, 2, 5)]
    return next((one for one in lengths if one * pixels_per_metre >= 70), lengths[-1])


def draw_scale(draw: ImageDraw.ImageDraw, left: int, middle: int, pixels_per_metre: float) -> int:
    """Draw the scale bar from `left` at the height `middle` [px]; return where it ends."""
    length = scale_length(pixels_per_metre)
    end = left + round(length * pixels_per_metre)
    draw.line((left, middle + 8, end, middle + 8), fill=INK, width=3)
    for x in (left, end):
        draw.line((x, middle + 2, x, middle + 14), fill=INK, width=2)
    text = f"{length:g} m" if length < 1000 else f"{length / 1000:g} km"
    draw.text(((left + end) / 2, middle - 3), text, font=font(15), fill=INK, anchor="mb")
    return end


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
