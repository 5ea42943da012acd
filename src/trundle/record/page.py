"""A page around a picture: title and figures above, legend below. The font is the one included in Pillow."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from PIL import Image, ImageDraw

from trundle.pictures.colors import BESIDE, FAINT, HAIRLINE, INK, PAGE, Rgb, speed_color
from trundle.pictures.figure import Font, draw_scale, font, plain, scale_length, shorten, text_length

_EDGE = 28
_LEAST_WIDTH = 900
_SMOOTH = 4
_BAR = (180, 12)
_LOWEST_SPEED = "driven at 0"
_LEGEND_ROW = 26
_BETWEEN_MARKS = 24
_SIGN = {"line": 26, "square": 16}
"""Width of the symbol before a legend entry [px]."""


@dataclass(frozen=True, slots=True)
class Mark:
    """An entry of the legend: a line or a filled square of one colour, and its label."""

    shape: Literal["line", "square"]
    color: Rgb
    text: str


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
    """Place a picture of a map on a page.

    Args:
        picture: The picture of the map.
        title: First line.
        status: A word after the title, in its own colour.
        lines: Smaller lines below the title.
        legend: Entries below the picture, in as many rows as needed.
        pixels_per_metre: For the scale bar.
        top_speed: End of the colour bar [m/s]. If None, there is no colour bar.
    """
    width = max(picture.width, _LEAST_WIDTH) + 2 * _EDGE
    small = font(17)
    wrapped = [part for line in lines for part in _wrap(plain(line), small, width - 2 * _EDGE)]
    head = _EDGE + 40 + 25 * len(wrapped) + 12
    begin, end = _legend_room(width, pixels_per_metre, top_speed)
    rows = _break_legend(legend, end - begin)
    foot = 62 + _LEGEND_ROW * (len(rows) - 1)
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
    middle = head + picture.height + 31
    draw_scale(draw, _EDGE, middle, pixels_per_metre)
    if top_speed is not None:
        _draw_speeds(draw, width - _EDGE, middle, top_speed)
    for index, row in enumerate(rows):
        _draw_legend(draw, begin, middle + index * _LEGEND_ROW, row)
    return page


def _draw_title(draw: ImageDraw.ImageDraw, title: str, status: tuple[str, Rgb] | None, width: int) -> None:
    large = font(28)
    room = width - 2 * _EDGE - (0 if status is None else 34 + draw.textlength(status[0], font=large))
    shown = shorten(title, large, room)
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


def _legend_room(width: int, pixels_per_metre: float, top_speed: float | None) -> tuple[float, float]:
    """Return left and right ends of the legend: beside the scale, and the colour bar if there is one."""
    end = width - _EDGE if top_speed is None else _place_speeds(width - _EDGE, top_speed)[0]
    return _EDGE + round(scale_length(pixels_per_metre) * pixels_per_metre) + 36, end - 24


def _place_speeds(right: int, top: float) -> tuple[int, int, int]:
    """Return positions of the label and of both ends of the colour bar of speeds."""
    length = text_length(font(15))
    end = right - round(length(_speed_text(top))) - 8
    begin = end - _BAR[0]
    return begin - 8 - round(length(_LOWEST_SPEED)), begin, end


def _draw_speeds(draw: ImageDraw.ImageDraw, right: int, middle: int, top: float) -> None:
    small = font(15)
    _, begin, end = _place_speeds(right, top)
    for x in range(_BAR[0]):
        color = speed_color(x / (_BAR[0] - 1))
        draw.line((begin + x, middle - _BAR[1] // 2, begin + x, middle + _BAR[1] // 2), fill=color)
    draw.text((end + 8, middle), _speed_text(top), font=small, fill=INK, anchor="lm")
    draw.text((begin - 8, middle), _LOWEST_SPEED, font=small, fill=INK, anchor="rm")


def _speed_text(top: float) -> str:
    return f"{top:g} m/s"


def _break_legend(legend: Sequence[Mark], room: float) -> list[list[Mark]]:
    """Return rows of the legend, at least one; each entry is in one of them."""
    rows: list[list[Mark]] = [[]]
    x = 0.0
    for mark in legend:
        if rows[-1] and x + _mark_length(mark) > room:
            rows.append([])
            x = 0.0
        rows[-1].append(mark)
        x += _mark_length(mark) + _BETWEEN_MARKS
    return rows


def _mark_length(mark: Mark) -> float:
    return _SIGN[mark.shape] + 8 + text_length(font(15))(mark.text)


def _draw_legend(draw: ImageDraw.ImageDraw, x: float, middle: int, row: Sequence[Mark]) -> None:
    for mark in row:
        wide = _SIGN[mark.shape]
        if mark.shape == "line":
            draw.line((x, middle, x + wide, middle), fill=mark.color, width=6)
        else:
            draw.rectangle((x, middle - 8, x + wide, middle + 8), fill=mark.color)
        draw.text((x + wide + 8, middle), mark.text, font=font(15), fill=INK, anchor="lm")
        x += _mark_length(mark) + _BETWEEN_MARKS


def draw_tag(
    draw: ImageDraw.ImageDraw,
    at: tuple[float, float],
    text: str,
    color: Rgb,
    *,
    apart: float,
    size: tuple[int, int],
) -> None:
    """Write a word on a small coloured background, up and right of a point [px] by `apart`, in a picture of `size`."""
    letters = font(16)
    wide, high = round(draw.textlength(text, font=letters)) + 14, 24
    x = min(max(2, at[0] + apart), size[0] - wide - 2)
    y = min(max(2, at[1] - apart - high), size[1] - high - 2)
    draw.rounded_rectangle((x, y, x + wide, y + high), radius=5, fill=color)
    draw.text((x + wide / 2, y + high / 2), text, font=letters, fill=PAGE, anchor="mm")


def _wrap(text: str, letters: Font, room: float) -> list[str]:
    """Break a line between words so that it fits, into three lines at most."""
    length = text_length(letters)
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
    return [shorten(part, letters, room) for part in rows[:3]]
