"""What the commands that read a results file share: find it, draw of it what is asked for. Nothing is solved."""

from __future__ import annotations

from difflib import get_close_matches
from pathlib import Path
from textwrap import wrap
from typing import TYPE_CHECKING, Final

from femstruct.errors import InputError, InputErrors, sentence

if TYPE_CHECKING:
    from femstruct.study.result import StudyResult

LINE: Final = 110  # characters of a line of names
SOLID: Final = ("model", "mode_shapes", "rooms")  # pictures in three dimensions, some of several files


def results_file(given: Path) -> Path:
    """The results file that is meant by its name or by that of its folder."""
    from femstruct.workflow.run.output import RESULTS

    return given / RESULTS if given.is_dir() else given


def pictures_of(result: StudyResult) -> list[str]:
    """What can be drawn, by the names of the files without their ending."""
    from femstruct.view.figures.plots import drawings

    return [*(name.removesuffix(".png") for name in drawings(result)), *SOLID]


def plotted(result: StudyResult, what: str, folder: Path) -> list[Path]:
    """Draw one picture of a study, or all shapes of modes, or all of its rooms, to a folder; returns the files.

    Raises InputError for a name that is none of `pictures_of`, and for a picture with nothing to show.
    """
    from femstruct.view.figures.drawing import save
    from femstruct.view.figures.plots import drawings

    folder.mkdir(parents=True, exist_ok=True)
    paths: list[Path] = []
    why = "nothing to show in this study"
    if what in SOLID:
        from femstruct.view.scenes.beside import drawn_beside
        from femstruct.view.scenes.room_scene import room_pictures
        from femstruct.view.scenes.scene import model_picture, shapes_all

        draw = {"model": model_picture, "mode_shapes": shapes_all, "rooms": room_pictures}[what]
        paths, left_out = drawn_beside(lambda: draw(result, folder))()
        why = left_out or why
    elif draws := drawings(result).get(f"{what}.png"):
        figure = draws()
        paths = [save(figure, folder / f"{what}.png")] if figure is not None else []
    else:
        names = pictures_of(result)
        near = get_close_matches(what, names, n=1)
        do = f"did you mean '{near[0]}'?" if near else ""
        listed = wrap(", ".join(names), LINE, break_long_words=False, break_on_hyphens=False)
        raise InputErrors((sentence("WHAT", f"'{what}'", "one of these names", do), *listed))
    if not paths:
        raise InputError(what, got=why, expected="a picture that can be drawn", do="choose another one")
    return paths
