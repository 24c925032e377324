"""Names in pictures as they were written: no formulas, in any script there is a font for."""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from typing import Final

from matplotlib.figure import Figure
from matplotlib.font_manager import fontManager
from matplotlib.text import Text

_FALLBACKS: Final = (
    "Noto Sans CJK KR", "Noto Sans CJK JP", "Noto Sans KR", "Noto Sans JP", "Source Han Sans KR", "Malgun Gothic",
    "NanumGothic", "Apple SD Gothic Neo", "AppleGothic", "Yu Gothic", "Meiryo", "MS Gothic", "Hiragino Sans",
    "IPAexGothic", "WenQuanYi Zen Hei", "Arial Unicode MS",
)  # fmt: skip
_OWN: Final = "DejaVu Sans"  # comes with matplotlib: Latin, Greek, Cyrillic


@contextmanager
def as_written(figure: Figure) -> Iterator[None]:
    """While a figure is drawn here: ``$x$`` is a name, only the numbers of logarithmic axes are formulas; what no font
    of this machine has is drawn as a box, without a word for every character."""
    for text in figure.findobj(Text):
        text.set_parse_math(False)
        if not text.get_text().isascii():
            text.set_fontfamily(_fonts())
    for axes in figure.axes:
        for axis in (axes.xaxis, axes.yaxis):
            for text in (*axis.get_ticklabels(which="both"), axis.get_offset_text()):
                text.set_parse_math(True)
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", message="Glyph .* missing from")
        yield


@cache
def _fonts() -> list[str]:
    """The figures' own font, and those of this machine that have Korean, Japanese or Chinese."""
    there = {font.name for font in fontManager.ttflist}
    return [_OWN, *(name for name in _FALLBACKS if name in there)]
