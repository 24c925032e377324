"""Legends on pictures in three dimensions, in black text beside their colours: those of VTK have its colour."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any, Final

import matplotlib as mpl
import numpy as np

LETTERS: Final = 18  # height in pixels of a legend
SMALL: Final = 12  # of a title and a scale of colours
BAR: Final = (120, 10)  # pixels of a scale of colours


def draw_legend(image: Any, entries: Sequence[tuple[str, str]]) -> None:
    """Names beside their colours, in the upper left corner of an image.

    >>> from PIL import Image
    >>> image = Image.new("RGB", (200, 60), "white")
    >>> draw_legend(image, [("floor", "#ff0000")])
    >>> image.getpixel((18, 20)), min(image.crop((34, 0, 200, 60)).tobytes())  # its colour, black letters
    ((255, 0, 0), 0)
    """
    from PIL import ImageDraw

    draw, font = ImageDraw.Draw(image), _font(LETTERS)
    for number, (name, colour) in enumerate(entries):
        top = 12 + 1.4 * LETTERS * number
        draw.rectangle((12, top, 12 + 0.8 * LETTERS, top + 0.8 * LETTERS), fill=colour, outline="#444444")
        draw.text((12 + 1.3 * LETTERS, top + 0.4 * LETTERS), name, fill="black", font=font, anchor="lm")


def draw_colours(image: Any, title: str, meaning: str) -> None:
    """A title at the top of an image, and below it the scale of colours from -1 to 1 and what they mean.

    >>> from PIL import Image
    >>> image = Image.new("RGB", (400, 34), "white")
    >>> draw_colours(image, "case", "displacement")
    >>> image.getpixel((28, 25)), image.getpixel((28 + BAR[0], 25))  # blue and red
    ((58, 76, 192), (179, 3, 38))
    """
    from PIL import Image, ImageDraw

    (width, height), font, draw, middle = BAR, _font(SMALL), ImageDraw.Draw(image), 25
    row = (255 * mpl.colormaps["coolwarm"](np.linspace(0.0, 1.0, width + 1))[:, :3]).astype(np.uint8)
    image.paste(Image.fromarray(np.repeat(row[None], height, axis=0)), (28, middle - height // 2))
    draw.text((10, 9), title, fill="black", font=font, anchor="lm")
    draw.text((10, middle), "-1", fill="black", font=font, anchor="lm")
    draw.text((28 + width + 8, middle), f"1   {meaning}", fill="black", font=font, anchor="lm")


def _font(height: int) -> Any:
    from PIL import ImageFont

    return ImageFont.truetype(Path(mpl.get_data_path(), "fonts", "ttf", "DejaVuSans.ttf"), height)
