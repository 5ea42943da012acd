"""A page around a picture: title and figures above, legend below. Its letters are those that Pillow brings."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Literal

from PIL import Image, ImageDraw, ImageFont

from trundle.record.colors import BESIDE, FAINT, HAIRLINE, INK, PAGE, Rgb, speed_color

_EDGE = 28
_LEAST_WIDTH = 900
_SMOOTH = 4
_BAR = (180, 12)

Font = ImageFont.FreeTypeFont | ImageFont.ImageFont


@dataclass(frozen=True, slots=True)
class Mark:
    """An entry of the legend: a line or a filled square of one colour, and what it stands for."""

    shape: Literal["line", "square"]
    color: Rgb
    text: str


@lru_cache(maxsize=16)
def font(size: int) -> Font:
    """Return the font of that size [px]."""
    return ImageFont.load_default(size)


def plain(text: str) -> str:
    """Replace letters that the font does not have."""
    known = set("·±°…")
    text = text.replace("²", "2")
    return "".join(one if one in known or (one.isascii() and one.isprintable()) else "?" for one in text)


def compose_page(
    picture: Image.Image,
    *,
    title: str,
    status: tuple[str, Rgb] | None,
    lines: Sequence[str],
    legend: Sequence[Mark],
    pixels_per_metre: float,
    top_speed: float | None = None,
) -> Image.Image:
    """Set a picture of a map on a page.

    Args:
        picture: The map with what was drawn on it.
        title: First line.
        status: A word after the title, in its colour.
        lines: Smaller lines below the title.
        legend: Entries below the picture.
        pixels_per_metre: For the scale bar.
        top_speed: End of the colour bar [m/s]; none means no colour bar.
    """
    width = max(picture.width, _LEAST_WIDTH) + 2 * _EDGE
    small = font(17)
    wrapped = [part for line in lines for part in _wrap(plain(line), small, width - 2 * _EDGE)]
    head = _EDGE + 40 + 25 * len(wrapped) + 12
    foot = 62
    page = Image.new("RGB", (width, head + picture.height + foot), PAGE)
    draw = ImageDraw.Draw(page)
    _draw_title(draw, plain(title), status, width)
    for index, line in enumerate(wrapped):
        draw.text((_EDGE, _EDGE + 42 + 25 * index), line, font=small, fill=FAINT)
    left = (width - picture.width) // 2
    if picture.width < width - 2 * _EDGE:
        draw.rectangle((_EDGE, head, width - _EDGE - 1, head + picture.height - 1), fill=BESIDE)
    page.paste(picture, (left, head))
    draw.rectangle((_EDGE - 1, head - 1, width - _EDGE, head + picture.height), outline=HAIRLINE)
    middle = head + picture.height + foot // 2
    x = _draw_scale(draw, _EDGE, middle, pixels_per_metre)
    right = _draw_speeds(draw, width - _EDGE, middle, top_speed) if top_speed is not None else width - _EDGE
    _draw_legend(draw, x + 36, right - 24, middle, legend)
    return page


def _draw_title(draw: ImageDraw.ImageDraw, title: str, status: tuple[str, Rgb] | None, width: int) -> None:
    large = font(28)
    room = width - 2 * _EDGE - (0 if status is None else 34 + draw.textlength(status[0], font=large))
    shown = _shorten(title, large, room)
    draw.text((_EDGE, _EDGE - 6), shown, font=large, fill=INK)
    if status is not None:
        x = _EDGE + draw.textlength(shown, font=large) + 18
        _draw_disc(draw, (x + 7, _EDGE + 11), 7, status[1])
        draw.text((x + 22, _EDGE - 6), status[0], font=large, fill=status[1])


def _draw_disc(draw: ImageDraw.ImageDraw, center: tuple[float, float], radius: int, color: Rgb) -> None:
    """Draw a filled circle with smooth edges."""
    side = 2 * radius + 2
    mask = Image.new("L", (side * _SMOOTH, side * _SMOOTH), 0)
    ImageDraw.Draw(mask).ellipse([_SMOOTH, _SMOOTH, (side - 1) * _SMOOTH, (side - 1) * _SMOOTH], fill=255)
    draw.bitmap((round(center[0] - side / 2), round(center[1] - side / 2)), mask.reduce(_SMOOTH), fill=color)


def _draw_scale(draw: ImageDraw.ImageDraw, left: int, middle: int, pixels_per_metre: float) -> int:
    """Draw a bar of a round length; return where it ends."""
    lengths = [0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100, 200, 500]
    length = next((one for one in lengths if one * pixels_per_metre >= 70), lengths[-1])
    end = left + round(length * pixels_per_metre)
    draw.line((left, middle + 8, end, middle + 8), fill=INK, width=3)
    for x in (left, end):
        draw.line((x, middle + 2, x, middle + 14), fill=INK, width=2)
    draw.text(((left + end) / 2, middle - 3), f"{length:g} m", font=font(15), fill=INK, anchor="mb")
    return end


def _draw_speeds(draw: ImageDraw.ImageDraw, right: int, middle: int, top: float) -> int:
    """Draw the colour bar of speeds; return where it begins."""
    small = font(15)
    text = f"{top:g} m/s"
    end = right - round(draw.textlength(text, font=small)) - 8
    begin = end - _BAR[0]
    for x in range(_BAR[0]):
        color = speed_color(x / (_BAR[0] - 1))
        draw.line((begin + x, middle - _BAR[1] // 2, begin + x, middle + _BAR[1] // 2), fill=color)
    draw.text((end + 8, middle), text, font=small, fill=INK, anchor="lm")
    low = "driven at 0"
    draw.text((begin - 8, middle), low, font=small, fill=INK, anchor="rm")
    return begin - 8 - round(draw.textlength(low, font=small))


def _draw_legend(draw: ImageDraw.ImageDraw, x: float, right: float, middle: int, legend: Sequence[Mark]) -> None:
    small = font(15)
    for mark in legend:
        wide = 26 if mark.shape == "line" else 16
        if x + wide + 8 + draw.textlength(mark.text, font=small) > right:
            break
        if mark.shape == "line":
            draw.line((x, middle, x + wide, middle), fill=mark.color, width=6)
        else:
            draw.rectangle((x, middle - 8, x + wide, middle + 8), fill=mark.color)
        draw.text((x + wide + 8, middle), mark.text, font=small, fill=INK, anchor="lm")
        x += wide + 8 + draw.textlength(mark.text, font=small) + 24


def draw_tag(
    draw: ImageDraw.ImageDraw,
    at: tuple[float, float],
    text: str,
    color: Rgb,
    *,
    apart: float,
    size: tuple[int, int],
) -> None:
    """Write a word on a small field of colour, up and right of a point [px] by `apart`, in a picture of `size`."""
    letters = font(16)
    wide, high = round(draw.textlength(text, font=letters)) + 14, 24
    x = min(max(2, at[0] + apart), size[0] - wide - 2)
    y = min(max(2, at[1] - apart - high), size[1] - high - 2)
    draw.rounded_rectangle((x, y, x + wide, y + high), radius=5, fill=color)
    draw.text((x + wide / 2, y + high / 2), text, font=letters, fill=PAGE, anchor="mm")


def _length(letters: Font) -> Callable[[str], float]:
    return lambda text: float(letters.getlength(text))


def _shorten(text: str, letters: Font, room: float) -> str:
    length = _length(letters)
    if length(text) <= room:
        return text
    while text and length(text + "…") > room:
        text = text[:-1]
    return text + "…"


def _wrap(text: str, letters: Font, room: float) -> list[str]:
    """Break a line between words so that it fits, into three lines at most."""
    length = _length(letters)
    rows: list[str] = []
    row = ""
    for word in text.split(" "):
        longer = f"{row} {word}" if row else word
        if row and length(longer) > room:
            rows.append(row)
            row = word
        else:
            row = longer
    rows.append(row)
    return [_shorten(part, letters, room) for part in rows[:3]]
