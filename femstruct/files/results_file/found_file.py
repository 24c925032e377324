"""What an optimisation found in one HDF5 file with the rows of all designs, and a front as a table for a spreadsheet.

The file is that of a sweep (`swept_file`) and, of a front,

    /front/goal [design, goal]          the goals of all designs, nan where they are not to be trusted
    /front/member [design]              whether a design is on the front; /front/held : holds all limits
    /front/unit [goal]

with the answer itself as nouns. `read_found` reads it back.
"""

from __future__ import annotations

import csv
from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING, Final

import numpy as np

from femstruct.errors import FemstructError, InputError
from femstruct.files.atomic import replacing
from femstruct.files.results_file.datasets import axis, group, put, remembered
from femstruct.files.results_file.seal import refuse_broken_seal, write_sealed
from femstruct.files.results_file.swept_file import headed, write_rows
from femstruct.files.results_file.whole import NOUNS, read_whole, write_whole
from femstruct.files.tables.front_tables import design_table
from femstruct.study.campaign.front import Front
from femstruct.study.campaign.sought import Found

if TYPE_CHECKING:  # slow to import
    import h5py

OPTIMUM: Final = "optimise.h5"


def write_found(path: str | Path, found: Found | Front) -> None:
    """Write the answer of an optimisation to one file that is, at every instant, complete or not there.

    Raises FemstructError when the disk is full or refuses; the file that was there before is then untouched.

    A design that was tried once:

    >>> from pathlib import Path
    >>> import tempfile
    >>> from femstruct.study.campaign.sought import Chosen, Search
    >>> from femstruct.study.campaign.swept import Swept
    >>> from femstruct.study.campaign.varied import Scattered
    >>> rows = Swept(
    ...     title="hits",
    ...     paths=("bodies.ball.mass",),
    ...     units=("kg",),
    ...     texts=(("1 kg",),),
    ...     values=[[1.0]],
    ...     method="grid",
    ...     cases=("as given",),
    ...     baseline="as given",
    ...     names=("hit peak force",),
    ...     number_units=("N",),
    ...     main=("hit peak force",),
    ...     numbers=[[[5.0]]],
    ...     done=np.array([True]),
    ...     severe=(((),),),
    ...     findings=(((),),),
    ...     trouble=("",),
    ... )
    >>> mass = Scattered("bodies.ball.mass", "uniform", 1.0, 2.0, "kg")
    >>> found = Found(
    ...     search=Search("hit.study.yaml", "hit peak force", (mass,)),
    ...     unit="N",
    ...     goal=5.0,
    ...     ends=(5.0, 5.0),
    ...     chosen=(Chosen("bodies.ball.mass", "1 kg", 1.0, "kg", "lower", 0.1),),
    ...     limits={},
    ...     feasible=True,
    ...     best=0,
    ...     runs=1,
    ...     designs=1,
    ...     left_out=0,
    ...     goals=np.array([5.0]),
    ...     held=np.array([True]),
    ...     history=((1, 5.0),),
    ...     spent=True,
    ...     interrupted=False,
    ...     rows=rows,
    ... )
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_found(Path(folder, "optimise.h5"), found)
    ...     read_found(folder).goal
    5.0
    """

    def write(file: h5py.File) -> None:
        with remembered() as written:
            write_rows(file, found.rows)
            if isinstance(found, Front):
                _write_front(file, found)
            write_whole(file, found, written)

    write_sealed(path, write)


def read_found(path: str | Path) -> Found | Front:
    """The answer of an optimisation. path : an optimise.h5, or the folder that it is in.

    Raises InputError for a file that is not there, of another kind, incomplete, or damaged. The example of
    `write_found` reads one.
    """
    path = Path(path) / OPTIMUM if Path(path).is_dir() else Path(path)
    if not path.is_file():
        raise InputError(
            str(path), got="no such file", expected=f"an {OPTIMUM}, or its folder", do="run optimise first"
        )
    try:
        refuse_broken_seal(path)
        import h5py

        with h5py.File(path, "r") as file:
            found = read_whole(file) if NOUNS in file else None
    except InputError:
        raise
    except (OSError, KeyError, RuntimeError, ValueError, TypeError, AttributeError, FemstructError) as error:
        expected = "a complete file of this version"
        raise InputError(str(path), got=f"a file that cannot be read ({error})", expected=expected) from error
    if not isinstance(found, Found | Front):
        raise InputError(str(path), got="an HDF5 file of another kind", expected="the answer of an optimisation")
    return found


def write_front_table(path: str | Path, found: Front) -> None:
    """A row for every design of the front as comma-separated values: its number, what it stands out by, what was
    chosen, goals, limited numbers, paths at ends of their ranges, findings, and the command that runs it."""
    search = found.search
    chosen = [headed(one.path, one.unit) for one in search.designs]
    goals = [headed(one.name, unit) for one, unit in zip(search.goals, found.units, strict=True)]
    limited = [headed(name, found.rows.unit_of(name)) for name in search.limits]
    with replacing(path) as temporary, temporary.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        ended = "paths at an end of their range"
        writer.writerow(["design", "sample", "stands out", *chosen, *goals, *limited, ended, "findings", "command"])
        for k in found.members:
            told = design_table(found, k)
            own = [one["text"] if one["value"] is None else repr(one["value"]) for one in told["chosen"]]
            values = [repr(float(one)) if isfinite(one) else "" for one in (*found.goals[k], *found.limited[k])]
            ends = [f"{one['path']} {one['at']}" for one in told["chosen"] if one["at"]]
            notes, codes = "; ".join(told["notes"]), " ".join(told["findings"])
            writer.writerow([k, told["sample"], notes, *own, *values, "; ".join(ends), codes, told["run_it"]])


def _write_front(file: h5py.File, found: Front) -> None:
    inside = group(file, "front", "Goals of all designs, and which of them no other one beats")
    axis(inside, "design", np.arange(found.designs), "1", "Number of the design")
    axis(inside, "goal_name", [one.name for one in found.search.goals], "1", "What is to be small or large")
    put(inside, "goal", found.goals, "see unit", "Goals of all designs", ("design", "goal_name"))
    member = np.isin(np.arange(found.designs), found.members)
    put(inside, "member", member, "1", "Whether no other design beats it", ("design",))
    put(inside, "held", found.held, "1", "Whether it holds all limits and is to be trusted", ("design",))
    put(inside, "unit", list(found.units), "1", "Unit of a goal", ("goal_name",))
