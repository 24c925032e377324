"""A campaign, run: all its samples through all their cases, and a table of what came of them."""

from __future__ import annotations

import os
from collections.abc import Sequence
from contextlib import ExitStack
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Final

from femstruct.campaign.batch_rows import batch_tasks
from femstruct.campaign.executors import Crew, crew
from femstruct.campaign.rows import APART, Journal, Row, open_journal, rename_previous
from femstruct.campaign.tasks import Samples, Work, first_read, gather_rows, make_ready, samples_of, split, versions
from femstruct.declared import Count, expect
from femstruct.errors import InputError, list_some
from femstruct.study.campaigns import Campaign, Swept
from femstruct.study.study import Plan
from femstruct.workflow.bases import fingerprint
from femstruct.workflow.provenance import Progress, progress_counter
from femstruct.yaml.reader import near_one

MOST: Final = 8  # names in a message
ROWS: Final = "sweep.rows"  # where rows are kept as they come, until all are there


def sweep(
    campaign: Campaign,
    folder: str | Path | None = None,
    workers: int | None = None,
    cluster: str = "",
    progress: Progress = lambda line: None,
    command: str = "",
    names: Sequence[str] = (),
) -> Swept:
    """Run a study once for every sample of what it varies.

    Parameters
    ----------
    folder : str | Path | None
        Where rows are kept as they come; samples that are there already are not run again, but for those whose process
        ended without an answer. None to keep nothing.
    workers : int | None
        Processes, None for one a core; a script that asks for several must run under ``if __name__ == "__main__":``.
    cluster : str
        Address of a Dask scheduler whose workers do the work instead; they see the same files.
    names : Sequence[str]
        Names of numbers that a row must have: where the first that is finished, or known already, has none of that name
        in any case, it ends.

    Returns
    -------
    Swept
        The rows. After Ctrl-C those that are finished, if any; the others are not `done`.

    Raises
    ------
    InputErrors
        Where no sample can be read, before anything is computed; InputError for rows in the folder that are of another
        campaign, and for a file that is changed meanwhile.

    Notes
    -----
    A row is what `run_study` finds for the study with the values of the sample; a sample that fails has a row that
    says why. Modes are solved once for each structure, as far as a process has them from one of the samples before.

    Examples
    --------
    A ball hits a mass on a soft spring, which takes over its speed where both are as heavy:

    >>> from pathlib import Path
    >>> import tempfile
    >>> from femstruct import read_campaign
    >>> model = "structure: {type: oscillator, mass: 1 kg, stiffness: 100 N/m}\\npoints: {m: {}}"
    >>> study = '''
    ... model: model.yaml
    ... bodies: {ball: {mass: 1 kg, above: m, speed: 1 m/s, contact: {type: linear, stiffness: 1 MN/m}}}
    ... record: {m.z: velocity}
    ... time: {duration: 10 ms, sampling: 10 kHz}
    ... vary: {bodies.ball.mass: {values: [0.5 kg, 1 kg, 2 kg]}}
    ... '''
    >>> with tempfile.TemporaryDirectory() as place:
    ...     _ = Path(place, "model.yaml").write_text(model, encoding="utf-8")
    ...     _ = Path(place, "hit.study.yaml").write_text(study, encoding="utf-8")
    ...     rows = sweep(read_campaign(Path(place, "hit.study.yaml")), workers=1)
    >>> rows.of("m.z velocity").round(3).tolist()  # 2 m v / (m + M)
    [0.667, 1.0, 1.333]
    """
    expect("sweep", campaign, Campaign, "read_campaign(PATH) is that of a study file")
    expect("sweep workers", workers, Count | None)
    folder = Path(folder) if folder is not None else None
    samples, cores = samples_of(campaign), workers or os.cpu_count() or 1
    batch = batch_tasks(campaign, samples, 1 if cluster else cores, progress)
    parts = split(campaign, samples, progress) if isinstance(batch, str) else batch
    with ExitStack() as stack:
        place = folder or Path(stack.enter_context(TemporaryDirectory()))
        place.mkdir(parents=True, exist_ok=True)
        journal = stack.enter_context(open_journal(place / ROWS, _name_of(campaign, samples, parts.plan)))
        make_ready(parts.plan, progress)
        kept = journal.rows()
        known = {row.sample for row in kept if not row.again}
        left = [task for one in parts.tasks if (task := one.left(known)) is not None]
        apart = 2 if any(row.again for row in kept) else 1  # what ended a process is not run in this one
        with crew(1 if parts.threaded else min(cores, max(len(left), apart)), cluster) as run:
            _run(left, run, journal, progress, names)
        rows = journal.rows()
    return gather_rows(
        campaign.title,
        parts.plan,
        samples,
        rows,
        parts.refused,
        method=campaign.sampling.method,
        command=command,
        made=parts.made,
        only=campaign.only,
    )


def set_aside(campaign: Campaign, folder: Path) -> Path | None:
    """Give the files of another campaign in a folder names with a number; returns that of its rows, None where there
    are none.

    Raises InputErrors where no sample can be read.
    """
    if not (folder / ROWS).exists():
        return None
    samples = samples_of(campaign)
    return rename_previous(folder / ROWS, _name_of(campaign, samples, first_read(campaign, samples)))


def _name_of(campaign: Campaign, samples: Samples, plan: Plan) -> str:
    """A name for all that the rows hang on: the files of one sample, what is changed in them, and the program that
    reads them. Files of other samples the journal knows from their rows."""
    choices = (campaign.overrides, campaign.case, campaign.only, samples.paths, samples.texts)
    return fingerprint((dict(plan.sources), *choices, versions()))


def _run(tasks: Sequence[Work], run: Crew, journal: Journal, progress: Progress, names: Sequence[str]) -> None:
    """Run tasks and keep their rows; Ctrl-C ends it with what there is."""
    refuse_unknown(names, journal.rows() if names else ())
    tell = progress_counter(sum(len(task.numbers) for task in tasks), "samples", progress)
    done = 0

    def keep(rows: list[Row]) -> None:
        nonlocal done
        journal.append(rows)
        if not done:
            refuse_unknown(names, rows)
        done += len({row.sample for row in rows})
        tell(done)

    try:
        run(tasks, keep, lambda: tell(done))
    except KeyboardInterrupt:
        if not journal.rows():
            journal.remove()
            raise


def refuse_unknown(names: Sequence[str], rows: Sequence[Row]) -> None:
    """Raise InputError for a name that no number of these rows has; rows without numbers say nothing."""
    known = {name for row in rows for name in row.numbers}
    wrong = next((name for name in names if known and name not in known), None)
    if wrong is not None:
        main = list_some([name for name in sorted(known) if APART not in name], MOST)
        expected = "a number of the study"
        raise InputError("results", got=f"'{wrong}'", expected=expected, do=near_one(wrong, known) or f"it has {main}")
