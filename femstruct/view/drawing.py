"""What all figures share: size, colours of cases, thinned lines, and one way to the disk."""

from __future__ import annotations

import warnings
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from typing import Any, Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.font_manager import fontManager
from matplotlib.text import Text
from matplotlib.ticker import ScalarFormatter
from numpy.typing import NDArray

from femstruct.arrays import Floats
from femstruct.files.writing import replacing

# ----------------------------------------------------------------------------------------------------------------------
# Names in pictures as they were written: no formulas, in any script there is a font for.
# ----------------------------------------------------------------------------------------------------------------------

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


# ----------------------------------------------------------------------------------------------------------------------
# What all figures share.
# ----------------------------------------------------------------------------------------------------------------------

BASELINE: Final = "#222222"
COLOURS: Final = ("#0072b2", "#e69f00", "#009e73", "#56b4e9", "#d55e00", "#cc79a7", "#8c564b", "#7f7f7f")
"""Okabe and Ito's colours, told apart by colour-blind readers; each pair also in grey."""
DASHES: Final[tuple[Any, ...]] = ("-", (0, (6, 1.5)), (0, (2, 1)), (0, (6, 1.5, 1.5, 1.5)))
TOTAL: Final[dict[str, Any]] = {"linestyle": "--", "linewidth": 1.6}  # of what is heard with the bodies' own sound
PAIR: Final = 2  # so many other cases have the same dashes
CHARACTER: Final = 0.0085  # of a figure's width, that a digit of a mode's number takes


def new_figure(width: float, height: float, title: str) -> Figure:
    """An empty figure [inches] of its own, without pyplot: no window, no global state."""
    figure = Figure(figsize=(width, height), dpi=100)
    FigureCanvasAgg(figure)
    figure.text(0.09 / width, 1.0 - 0.08 / height, title, fontsize=11, ha="left", va="top")
    return figure


def panels(
    figure: Figure,
    rows: int,
    columns: int,
    *,
    between: float,
    top: float = 0.62,
    left: float = 0.95,
    right: float = 0.3,
    **options: Any,
) -> NDArray[np.object_]:
    """Axes [rows, columns] with margins in inches: `between` the rows, `top` above the first, `left`, `right`.

    A layout engine would measure every text twice; that doubles the time of a picture.
    """
    width, height = figure.get_size_inches()
    bottom, beside = 0.5, 0.75
    inner = (
        ((height - top - bottom) - (rows - 1) * between) / rows,
        (width - left - right - (columns - 1) * beside) / columns,
    )
    figure.subplots_adjust(
        left / width, bottom / height, 1.0 - right / width, 1.0 - top / height, beside / inner[1], between / inner[0]
    )
    axes: NDArray[np.object_] = figure.subplots(rows, columns, squeeze=False, **options)
    return axes


def save(figure: Figure, path: str | Path) -> Path:
    """Write a figure in one step: nobody sees half a picture. The suffix of the path chooses the format."""
    path = Path(path)
    with replacing(path) as temporary, as_written(figure):
        form = path.suffix.removeprefix(".") or "png"
        options: dict[str, Any] = {"pil_kwargs": {"compress_level": 2}} if form == "png" else {}
        figure.savefig(temporary, format=form, **options)
    return path


def case_colours(names: Iterable[str], baseline: str) -> dict[str, str]:
    """One colour a case, the same in all pictures of a study: the baseline dark, the others in their order.

    >>> case_colours(["a", "b"], baseline="a")
    {'a': '#222222', 'b': '#0072b2'}
    """
    others = [name for name in names if name != baseline]
    return {baseline: BASELINE} | {name: COLOURS[number % len(COLOURS)] for number, name in enumerate(others)}


def case_lines(names: Iterable[str], baseline: str) -> dict[str, dict[str, Any]]:
    """How the lines of a case are drawn: its colour, and dashes that tell it in grey and let equal lines be seen below.

    >>> case_lines(["a", "b"], baseline="a")["b"]
    {'color': '#0072b2', 'linestyle': '-'}
    """
    colours = case_colours(names, baseline)  # the baseline first
    return {
        name: {"color": colour, "linestyle": DASHES[max(0, number - 1) // PAIR % len(DASHES)]}
        for number, (name, colour) in enumerate(colours.items())
    }


def thin_history(t: Floats, values: Floats, most: int = 1500) -> tuple[Floats, Floats]:
    """A history with at most about 2 x `most` points that looks the same: least and largest of every stretch.

    >>> t, y = thin_history(np.arange(1e5), np.sin(np.arange(1e5)))
    >>> len(t) < 3100, float(y.max()) > 0.9999
    (True, True)
    """
    stretch = len(t) // most
    if stretch < 3:
        return t, values
    whole = len(t) // stretch * stretch
    blocks = values[:whole].reshape(-1, stretch)
    start = np.arange(len(blocks)) * stretch
    least, largest = (np.where(np.isnan(blocks), beyond, blocks) for beyond in (np.inf, -np.inf))
    picked = np.sort(np.stack([start + least.argmin(axis=1), start + largest.argmax(axis=1)], axis=1), axis=1).ravel()
    picked = np.concatenate([picked, np.arange(whole, len(t))])
    return t[picked], values[picked]


def finish(axes: Axes, xlabel: str, ylabel: str) -> None:
    """Labels and a light grid."""
    axes.set_xlabel(xlabel)
    axes.set_ylabel(ylabel)
    for axis in (axes.xaxis, axes.yaxis):
        if isinstance(form := axis.get_major_formatter(), ScalarFormatter):
            form.set_useOffset(False)  # "+5.548e1" beside an axis is not seen
    axes.grid(True, which="major", color="0.88", linewidth=0.6)
    axes.set_axisbelow(True)


def legend_above(axes: Axes, *, up: float = 0.0) -> None:
    """A legend over the axes, `up` points above them, where it covers no curve."""
    axes.legend(
        fontsize=8, loc="lower left", bbox_to_anchor=(0.0, 1.0), borderaxespad=0.2 + up / 8, frameon=False,
        labelspacing=0.25,
    )  # fmt: skip


def unit_text(unit: str) -> str:
    """A unit as people write it.

    >>> unit_text("m/(N s^2)")
    'm/(N s²)'
    """
    return unit.replace("^2", "²")


def mode_lines(
    axes: Axes,
    frequency_hz: Mapping[int, float],
    low: float,
    high: float,
    *,
    numbers: bool = True,
    of: str = " of the baseline",
) -> str:
    """Dotted lines at natural frequencies inside a band, with the modes' numbers on top.

    A number is left out where it would cover the one before.

    Parameters
    ----------
    of : str
        Whose modes they are.

    Returns
    -------
    str
        The label of the frequencies, which tells what the numbers are.
    """
    inside = {mode: frequency for mode, frequency in frequency_hz.items() if low <= frequency <= high}
    axes.vlines(
        list(inside.values()), 0.0, 1.0, transform=axes.get_xaxis_transform(), color="0.7", linewidth=0.6,
        linestyle=":", zorder=0,
    )  # fmt: skip
    logarithmic = axes.get_xscale() == "log"
    taken = -np.inf
    for mode, frequency in inside.items() if numbers else ():
        along = np.log(frequency / low) / np.log(high / low) if logarithmic else (frequency - low) / (high - low)
        half = 0.5 * CHARACTER * len(str(mode))
        if along - half > taken:
            axes.annotate(
                str(mode), (frequency, 1.0), xycoords=("data", "axes fraction"), xytext=(0, 2),
                textcoords="offset points", fontsize=7, color="0.4", ha="center",
            )  # fmt: skip
            taken = along + half + 0.3 * CHARACTER
    return "frequency in Hz" + (f"   (numbers: modes{of})" if inside else "")
