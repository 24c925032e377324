"""What a run leaves behind: one results file, tables, sound, and pictures."""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Final, NamedTuple

import numpy as np

from femstruct.arrays import Floats
from femstruct.errors import some_of
from femstruct.files.atomic import file_name, replacing, short
from femstruct.files.audio import listening_scale, write_sequence, write_wav
from femstruct.files.belongings import NAME, Stage, together
from femstruct.files.results_file.results import write_results
from femstruct.files.results_file.stored import RESULTS, read_results
from femstruct.files.room_modes import write_room_modes
from femstruct.files.set_aside import same_file
from femstruct.files.tables.study_tables import summary
from femstruct.study.result import StudyResult
from femstruct.view.report import write_report
from femstruct.workflow.progress import Progress
from femstruct.workflow.run.provenance import Stopwatch, inputs_of

NO_PICTURES: Final = "Pictures left out, because of --no-pictures; 'femstruct report RESULTS' draws them."
NAMED: Final = 4  # files of those that are removed


def write_all(
    result: StudyResult,
    folder: Path,
    progress: Progress = lambda line: None,
    pictures: bool = True,
    keep: Progress | None = None,
) -> tuple[dict[str, float], str]:
    """Write results.h5, summary.json, a WAV for every receiver and case, one to listen to with all cases in turn, all
    pictures, and report.html with tables, pictures and what to listen to.

    All files take their places together when the last is complete, so that a folder holds those of one run; those of
    an earlier run that this one does not make are then removed, and nothing else (files.belongings). All sounds of a
    study have one full scale, so that cases can be compared by ear. pictures : False for numbers, tables, sound alone.
    keep : a run of other inputs that is in the folder is kept beside it with a number, and keep is told where; None
    replaces it.

    Returns CPU seconds by stage, and sentences, a line each, about pictures that were left out and files that were
    removed, or kept though they are older ("" for none).
    """
    folder.mkdir(parents=True, exist_ok=True)
    clock = Stopwatch(progress)
    with _folder_of(result, folder, keep) as stage:
        left_out = _write(result, stage.path, clock, pictures, lambda path: write_results(path, result))
    return clock.seconds, "\n".join(
        filter(None, (left_out, _cleared([] if stage.aside else stage.removed), _older(stage.older)))
    )


def redraw(
    source: Path,
    folder: Path,
    progress: Progress = lambda line: None,
    pictures: bool = True,
    keep: Progress | None = None,
) -> tuple[StudyResult, str]:
    """Write all that `write_all` does from a results file, which stays as it is or is copied to another folder.

    Nothing is solved. Returns what the file says, and sentences as `write_all` does.
    """
    result = read_results(source)
    folder.mkdir(parents=True, exist_ok=True)
    own = source.parent.resolve() == folder.resolve()
    with _folder_of(result, folder, None if own else keep) as stage:
        left_out = _write(result, stage.path, Stopwatch(progress), pictures, lambda path: same_file(source, path))
    return result, "\n".join(
        filter(None, (left_out, _cleared([] if stage.aside else stage.removed), _older(stage.older)))
    )


@contextmanager
def _folder_of(result: StudyResult, folder: Path, keep: Progress | None) -> Iterator[Stage]:
    """The stage of a folder for the files of a run; says where an earlier one of other inputs is kept."""
    finished = len(result.cases) == len(result.plan.cases)
    with together(folder, finished=finished, inputs=inputs_of(result.plan), keep=keep is not None) as stage:
        yield stage
    for place in stage.aside:
        if keep is not None:
            keep(f"The run of other inputs that was in {folder} is now in {place}")


def _told(stage: Stage, left_out: str = "") -> str:
    """Sentences about what a run left out, removed, or kept that is older; what is kept elsewhere is told by itself."""
    return "\n".join(filter(None, (left_out, "" if stage.aside else _cleared(stage.removed), _older(stage.older))))


def _older(kept: Sequence[str]) -> str:
    """What is said of files of an earlier run beside those of one with cases missing.

    >>> _older(["a.wav"])
    'Some cases are missing. These files are of an earlier run: a.wav (written_by_femstruct.json lists them)'
    """
    names = some_of(kept, NAMED)
    return f"Some cases are missing. These files are of an earlier run: {names} ({NAME} lists them)" if kept else ""


def _cleared(removed: Sequence[str]) -> str:
    """What is said of files that are no longer there.

    >>> _cleared(["a.wav", "b.wav"]), _cleared([])
    ('Removed files of an earlier run: a.wav, b.wav', '')
    """
    names = some_of(removed, NAMED)
    return f"Removed files of an earlier run: {names}" if removed else ""


def write_numbers(
    result: StudyResult, folder: Path, progress: Progress = lambda line: None, keep: Progress | None = None
) -> str:
    """Write summary.json, the sounds, and report.html without pictures: what a person changes a number for.

    Files take their places as those of `write_all` do; keep : likewise. Returns sentences about what was removed or is
    older.
    """
    folder.mkdir(parents=True, exist_ok=True)
    clock = Stopwatch(progress)
    with _folder_of(result, folder, keep) as stage:
        _write_summary(result, stage.path)
        with clock("sound"):
            sounds = _write_sounds(result, stage.path)
        heard = {name: (stage.path / name).read_bytes() for name in sounds}
        write_report(result, stage.path / "report.html", sounds=heard)
    return _told(stage)


def _write_summary(result: StudyResult, folder: Path) -> None:
    with replacing(folder / "summary.json") as path:
        path.write_text(json.dumps(summary(result), indent=1, allow_nan=False) + "\n", encoding="utf-8")


def _write(
    result: StudyResult, folder: Path, clock: Stopwatch, pictures: bool, results_file: Callable[[Path], None]
) -> str:
    """All files in their order; a sentence about pictures that were left out. results_file : makes results.h5."""
    with clock("sound"):
        sounds = _write_sounds(result, folder)
    with clock("results file"):
        results_file(folder / RESULTS)
        _write_summary(result, folder)
        for plan in result.cases[result.plan.baseline].case.study.rooms:
            write_room_modes(plan, (folder / file_name("room_modes", plan.name)).with_suffix(".vtu"))
    shown, left_out = _drawn(result, folder, clock) if pictures else ([], NO_PICTURES)
    with clock("report"):
        inside = [{name: (folder / name).read_bytes() for name in names} for names in (shown, sounds)]
        write_report(result, folder / "report.html", *inside)
    return left_out


def _drawn(result: StudyResult, folder: Path, clock: Stopwatch) -> tuple[list[str], str]:
    """Draw all pictures, those in three dimensions in a process beside this one: their names in the order of the page,
    and a sentence about those that were left out."""
    from femstruct.view.figures.plots import plot_all
    from femstruct.view.scenes.beside import drawn_beside
    from femstruct.view.scenes.opengl import NoOpenGL
    from femstruct.view.scenes.room_scene import room_pictures
    from femstruct.view.scenes.scene import model_picture, shapes_all
    from femstruct.view.scenes.stress_scene import stress_pictures

    with clock("pictures"):
        scenes = (shapes_all, room_pictures, model_picture, stress_pictures)
        solid = drawn_beside(lambda: [draw(result, folder) for draw in scenes])
        flat = plot_all(result, folder)
    with clock("pictures in three dimensions"):
        try:
            (shapes, left_out), (moving, _), (model, _), (stressed, _) = solid()
        except NoOpenGL as error:
            shapes, moving, model, stressed, left_out = [], [], [], [], str(error)
    model = model or _outline(result, folder)
    first = sorted(flat, key=lambda path: not path.name.startswith(("rated", "level", "own_sound")))
    return [path.name for path in (*model, *first, *stressed, *moving, *shapes)], left_out


def _outline(result: StudyResult, folder: Path) -> list[Path]:
    """The model in lines, where it cannot be drawn in three dimensions."""
    from femstruct.view.figures.drawing import save
    from femstruct.view.figures.outline import outline
    from femstruct.view.scenes.scene import baseline_model

    model = baseline_model(result)
    rooms = result.cases[result.plan.baseline].case.study.rooms
    return [] if model is None else [save(outline(model, rooms), folder / file_name("model"))]


class _Heard(NamedTuple):
    """A pressure history at ROOM.RECEIVER in a case: of what the structure radiates, or with the bodies themselves."""

    case: str
    total: bool
    receiver: str
    p: Floats
    sampling: float


def _write_sounds(result: StudyResult, folder: Path) -> list[str]:
    """A WAV for every receiver and case, and for every receiver one of all cases in turn, for listening: their names.

    Where striking bodies are heard themselves there are two of a case: of what the structure radiates, as elsewhere,
    and CASE.ROOM.RECEIVER.total.wav, which follows it in the sequence. All are at one scale, the sequence a decibel
    below it. Cases of another sampling than the baseline's cannot follow it in one file: they are not in the sequence.
    """
    heard = [
        _Heard(case, total, f"{room}.{receiver.name}", p, item.case.study.time.sampling)
        for case, item in result.cases.items()
        if item.case.study.time is not None
        for room, borne in item.rooms.items()
        for i, receiver in enumerate(borne.receivers)
        for total, of in ((False, item.rooms), (True, item.heard.total))
        if room in of
        for p in (of[room].p[i],)
    ]
    loudest = max((float(np.abs(one.p).max()) for one in heard), default=0.0)
    if not loudest > 0.0:
        return []
    for one in heard:
        name = _sound_name(one.case, one.receiver, *(["total"] if one.total else []))
        write_wav(folder / name, one.p, one.sampling, full_scale=loudest)
    baseline = result.cases[result.plan.baseline].case.study.time
    names = []
    for receiver in dict.fromkeys(one.receiver for one in heard):
        sounds = {
            f"{one.case}{', total' if one.total else ''}": one.p
            for one in heard
            if one.receiver == receiver and baseline is not None and one.sampling == baseline.sampling
        }
        if sounds and baseline is not None:
            names.append(_sound_name("listen", receiver))
            scale = listening_scale(loudest)
            write_sequence(folder / names[-1], sounds, baseline.sampling, full_scale=scale, form="pcm24")
    return names


def _sound_name(*words: str) -> str:
    """A name for a sound, with the spaces of its words; what some system does not take in a name is a line.

    >>> _sound_name("damper 0.6 / new", "box.mic")
    'damper 0.6 _ new.box.mic.wav'
    """
    return short(re.sub(r'[/\\:*?"<>|]', "_", ".".join(words))) + ".wav"
