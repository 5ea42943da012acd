"""What the pictures of docs/images share that show one thing above another."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from PIL import Image


def save_stacked(pictures: Sequence[Image.Image], name: str) -> None:
    """Put pictures below each other, halve them, and write the file of docs/images."""
    page = Image.new("RGB", (max(p.width for p in pictures), sum(p.height for p in pictures)), "white")
    for i, picture in enumerate(pictures):
        page.paste(picture, (0, sum(p.height for p in pictures[:i])))
    page.resize((page.width // 2, page.height // 2), Image.Resampling.LANCZOS).save(
        Path(__file__).parents[1] / "images" / name, optimize=True
    )
