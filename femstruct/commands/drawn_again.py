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
SOLID: Final = ("model", "mode_shapes", "rooms", "stress")  # pictures in three dimensions, some of several files


def pictures_of(result: StudyResult) -> dict[str, str]:
    """The pictures that a study may have, by the names of the files without their ending: "" of those that can be
    drawn, of others why not."""
    from femstruct.view.figures.plots import drawings
    from femstruct.view.figures.undrawn import no_model, no_shapes, no_stresses
    from femstruct.view.scenes.room_scene import no_room_pictures

    flat = {name.removesuffix(".png"): one.why_not() for name, one in drawings(result).items()}
    solid = (no_model(result), no_shapes(result), no_room_pictures(result), no_stresses(result))
    return flat | dict(zip(SOLID, solid, strict=True))


def plotted(result: StudyResult, what: str, folder: Path) -> list[Path]:
    """Draw one picture of a study, or all shapes of modes, or all of its rooms, to a folder; returns the files.

    Raises InputError for a name that is none of `pictures_of`, and for a picture with nothing to show, with the reason.
    """
    from femstruct.view.figures.drawing import save
    from femstruct.view.figures.plots import drawings

    known = pictures_of(result)
    if what not in known:
        names = [name for name, why_not in known.items() if not why_not]
        near = get_close_matches(what, names, n=1)
        do = f"did you mean '{near[0]}'?" if near else ""
        listed = wrap(", ".join(names), LINE, break_long_words=False, break_on_hyphens=False)
        raise InputErrors((sentence("WHAT", f"'{what}'", "one of these names", do), *listed))
    if known[what]:
        got = f"nothing to show in this study: {known[what]}"
        raise InputError(what, got=got, expected="a picture that can be drawn", do="choose another one")
    folder.mkdir(parents=True, exist_ok=True)
    if what not in SOLID:
        figure = drawings(result)[f"{what}.png"].draw()
        return [save(figure, folder / f"{what}.png")] if figure is not None else []
    from femstruct.view.scenes.beside import drawn_beside
    from femstruct.view.scenes.room_scene import room_pictures
    from femstruct.view.scenes.scene import model_picture, shapes_all
    from femstruct.view.scenes.stress_scene import stress_pictures

    draw = dict(zip(SOLID, (model_picture, shapes_all, room_pictures, stress_pictures), strict=True))[what]
    paths, left_out = drawn_beside(lambda: draw(result, folder))()
    if not paths:
        raise InputError(what, got=left_out, expected="a picture that can be drawn", do="choose another one")
    return paths
