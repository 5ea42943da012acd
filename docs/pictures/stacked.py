"""Pictures of docs/images that are made of two, one above or beside the other."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from PIL import Image


def save_stacked(pictures: Sequence[Image.Image], name: str, columns: int = 1) -> None:
    """Put pictures below each other, in columns row after row, halve them, and write the file of docs/images."""
    width = max(picture.width for picture in pictures)
    rows = [pictures[i : i + columns] for i in range(0, len(pictures), columns)]
    heights = [max(picture.height for picture in row) for row in rows]
    page = Image.new("RGB", (width * columns, sum(heights)), "white")
    for i, row in enumerate(rows):
        for j, picture in enumerate(row):
            page.paste(picture, (j * width, sum(heights[:i])))
    page.resize((page.width // 2, page.height // 2), Image.Resampling.LANCZOS).save(
        Path(__file__).parents[1] / "images" / name, optimize=True
    )
