"""All that was measured, read and made ready for a fit, as the command line names it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from femstruct.errors import InputError
from femstruct.files.inputs.columns import read_measured
from femstruct.files.inputs.measured_frequencies import MOST_SCATTER
from femstruct.language import ModelFile
from femstruct.study.study import Plan, Study
from femstruct.units import quantity
from femstruct.workflow.identify.data.datum import Datum, file_and_scatter, norm, scatter_of
from femstruct.workflow.identify.data.frfs import read_frfs
from femstruct.workflow.identify.data.history import (
    DIMENSIONS,
    FROM_REST,
    USUAL,
    HistoryDatum,
    delay_parameter,
    quantity_of_channel,
    window_of,
)
from femstruct.workflow.identify.data.levels import read_levels
from femstruct.workflow.identify.data.modes import read_modes
from femstruct.workflow.identify.intervals import Parameter
from femstruct.workflow.stages.modal_bases import meshed


@dataclass(frozen=True)
class MeasuredFiles:
    """What was measured, and where it stands.

    history, channel : a table of time and value, and the recorded channel that it is of. modes : universal files or
    tables of natural frequencies. frfs : universal files or tables. levels : tables of bands. Each is a text ``FILE``
    or ``FILE +- SCATTER``, one standard deviation. shapes : scatter of the mode shapes as a share of their rms, ""
    where they only pair. band : "A:B", of the frequency responses. near : width of a group of near-equal frequencies.
    length : unit of length of universal files that do not state it.

    >>> MeasuredFiles(modes=("floor.csv +- 0.5 %",)).any
    True
    """

    history: str = ""
    channel: str = ""
    modes: tuple[str, ...] = ()
    frfs: tuple[str, ...] = ()
    levels: tuple[str, ...] = ()
    shapes: str = ""
    band: str = ""
    near: str = "1 %"
    length: str = "m"

    @property
    def any(self) -> bool:
        """Whether there is anything to fit to."""
        return bool(self.history or self.modes or self.frfs or self.levels)


def read_data(
    files: MeasuredFiles, source: ModelFile | Plan, delay: bool
) -> tuple[tuple[Datum, ...], tuple[Parameter, ...]]:
    """All data, and the parameters that they bring with them: the delay of a history, where it is to be found.

    Raises InputError for options that do not fit each other or the study; InputErrors for what is wrong in a file.
    """
    if not files.any:
        do = "give --modes, --frf, --levels, or --measured with --channel"
        raise InputError("identify", got="no measured data", expected="one file or more", do=do)
    for option, given in (("--measured", files.history), ("--levels", files.levels)):
        if given and not isinstance(source, Plan):
            raise InputError(option, got="a model", expected="a study, in which something happens")
    if bool(files.history) != bool(files.channel):
        raise InputError("--measured and --channel", got="one of them", expected="both, or neither")
    data: list[Datum] = []
    own: tuple[Parameter, ...] = ()
    if files.history and isinstance(source, Plan):
        history, own = _history(files, source, delay)
        data.append(history)
    elif delay:
        raise InputError("--delay", got="no history", expected="--measured and --channel")
    length = _option(f"1 {files.length}", "--length", "length")
    data += _modes(files, length)
    if files.frfs:
        structure = source.structure if isinstance(source, ModelFile) else _baseline(source).structure
        places, band = meshed(structure).places, _band(files.band)
        for text in files.frfs:
            path, scatter = file_and_scatter(text, "--frf", "ratio")
            data += read_frfs(path, scatter, places, band, length)
    elif files.band:
        raise InputError("--band", got="no frequency response", expected="--frf")
    for text in files.levels:
        path, scatter = file_and_scatter(text, "--levels", "level")
        assert isinstance(source, Plan)
        data += read_levels(path, scatter, source)
    return tuple(data), own


def _modes(files: MeasuredFiles, length: float) -> list[Datum]:
    near = _option(files.near, "--near", "ratio")
    if not 0.0 <= near < 1.0:
        raise InputError("--near", got=files.near, expected="0 % to below 100 %")
    shapes = scatter_of(files.shapes, "--shapes", "ratio") if files.shapes else 0.0
    if shapes and not files.modes:
        raise InputError("--shapes", got="no modes", expected="--modes with a universal file")
    read = [file_and_scatter(text, "--modes", "ratio", MOST_SCATTER) for text in files.modes]
    return [read_modes(path, scatter, shapes, near, length) for path, scatter in read]


def _history(files: MeasuredFiles, plan: Plan, delay: bool) -> tuple[HistoryDatum, tuple[Parameter, ...]]:
    what = quantity_of_channel(plan, files.channel)
    if delay and what not in FROM_REST:
        raise InputError(
            "--delay",
            got=f"a {what}",
            expected=" or ".join(FROM_REST),
            do="a motion from before has no start in the record",
        )
    path, scatter = file_and_scatter(files.history, "--measured", DIMENSIONS[what])
    table = read_measured(path, DIMENSIONS[what])
    spacing = float(np.median(np.diff(table.times)))
    window = window_of(plan, table, spacing, delay)
    rms = norm(table.values) / np.sqrt(len(table.values))
    if not rms > 0.0:
        raise InputError(str(path), got="a history of zeros", expected="one that moves")
    taken = USUAL * float(rms) if scatter is None else scatter
    datum = HistoryDatum(files.channel, scatter is not None, table, what, taken, window)
    return datum, (delay_parameter(table, spacing),) if delay else ()


def _baseline(plan: Plan) -> Study:
    return next(one.study for one in plan.cases if one.name == plan.baseline)


def _band(text: str) -> tuple[float, float] | None:
    if not text:
        return None
    low, _, high = text.partition(":")
    ends = _option(low.strip(), "--band", "frequency"), _option(high.strip(), "--band", "frequency")
    if not 0.0 <= ends[0] < ends[1]:
        raise InputError("--band", got=f"'{text}'", expected="a lower and a higher frequency, such as '5 Hz:200 Hz'")
    return ends


def _option(text: str, option: str, dimension: str) -> float:
    try:
        return quantity(text, dimension)
    except InputError as error:
        raise InputError(option, got=error.got, expected=error.expected, do=error.do) from error
