"""Random models against independent answers and relations: `python scripts/verify.py --seconds 600 -o faults`.

Exit 1 if the program answered wrongly, crashed or gave no answer in time, or if nothing was checked. The same seed
makes the same checks; a check is found again with its capability and --only INDEX.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory

for _name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(_name, "1")  # workers share the cores
sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from tests.machine import coverage, framework, running  # noqa: E402 (threads and the place of the tests come first)


def main() -> int:
    """The command line."""
    ask = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    ask.add_argument("--seconds", type=float, default=600.0, help="no new check is begun after this time")
    ask.add_argument("--seed", type=int, default=1)
    ask.add_argument("--workers", type=int, default=1)
    ask.add_argument("--capability", action="append", help="part of a name; may be given again")
    ask.add_argument("--count", type=int, help="checks of each capability")
    ask.add_argument("--only", type=int, metavar="INDEX", help="one check of each capability")
    ask.add_argument("--limit", type=float, default=30.0, help="seconds of one check")
    ask.add_argument("--coverage", action="store_true", help="which keys and answers checks reach, kept if more")
    ask.add_argument("--until-fault", action="store_true", help="end at the first fault")
    ask.add_argument("--named", action="append", help="a whole name; in the order given")
    ask.add_argument("--verdicts", type=Path, help="of a program before it was changed, from which none may differ; "
                     "written if it is not there")  # fmt: skip
    ask.add_argument("--unchanged", type=Path, metavar="FOLDER", help="the tree of that program, asked for "
                     "verdicts on faults that are not kept")  # fmt: skip
    ask.add_argument("--reached", type=Path, help="written: seconds and lines of the packages of each capability; "
                     "needs '.[mutants]'")  # fmt: skip
    ask.add_argument("-o", type=Path, help="folder for models that fail")
    given = ask.parse_args()
    wanted = given.capability or [""]
    chosen = [one for name, one in framework.capabilities().items() if any(part in name for part in wanted)]
    if not chosen:
        names = "".join(f"\n  {name}" for name in framework.capabilities())
        ask.error(f"--capability: got {' '.join(wanted)}, expected a part of the name of a capability:{names}")
    if given.named:
        chosen = [framework.capabilities()[name] for name in given.named]
    if given.unchanged and not given.verdicts:
        ask.error("--unchanged: got no --verdicts, expected those of its first run, of which some are not kept")
    if given.coverage:
        return _coverage(chosen, given.seed, given.seconds, given.count or 2)
    kept = json.loads(given.verdicts.read_text()) if given.verdicts and given.verdicts.exists() else None
    again = None if given.unchanged is None else _asked_of(given.unchanged, given.seed, given.limit)
    fault = running.is_fault if kept is None else running.differs(kept, again)
    if given.only is not None:
        found = [running.check(one, given.seed, given.only, given.limit) for one in chosen]
    else:
        plan = (given.seed, given.seconds, given.workers, given.count, given.limit, given.until_fault)
        found = running.run(chosen, *plan, fault, given.reached is not None)
    print(f"seed {given.seed}\n{running.table(chosen, found)}")
    for path in running.write(found, given.o) if given.o else ():
        print(f"wrote {path}")
    if given.verdicts and kept is None:
        given.verdicts.write_text(json.dumps({f"{one.capability} {one.index}": one.verdict for one in found}, indent=0))
    if given.reached:
        given.reached.write_text(json.dumps(running.reached(found)))
    checked = any(one.verdict not in ("refused", "generator") for one in found)
    return int(not checked or any(map(fault, found)))


def _asked_of(tree: Path, seed: int, limit: float) -> Callable[[running.Checked], str | None]:
    """What another tree says of a check; None where it says nothing."""

    def verdict(one: running.Checked) -> str | None:
        with TemporaryDirectory() as folder:
            kept = Path(folder) / "verdicts.json"
            words = ["--named", one.capability, "--only", str(one.index), "--seed", str(seed), "--limit", str(limit)]
            command = [sys.executable, "scripts/verify.py", *words, "--verdicts", str(kept)]
            environment = {**os.environ, "PYTHONPATH": f"{tree}:{tree / 'scripts'}"}
            subprocess.run(command, cwd=tree, env=environment, capture_output=True, check=False)
            found = json.loads(kept.read_text()) if kept.exists() else {}
        return found.get(f"{one.capability} {one.index}")

    return verdict


def _coverage(chosen: Sequence[framework.Capability], seed: int, seconds: float, count: int) -> int:
    """The table of keys and answers; exit 1 if the program did not follow where an answer moved."""
    found = []
    for some in coverage.survey(chosen, seed, seconds, count):
        coverage.keep(some)  # at once: what was found stays if this is stopped
        found += some
    print(coverage.table(frozenset(tuple(cell.split(" | ")) for cell in coverage.stored())))  # type: ignore[misc]
    wrong = [cell for cell in found if not cell.off <= 1]
    for cell in wrong:
        print(f"{cell.key} | {cell.column}: {cell.capability}, index {cell.index}, {cell.off:.3g} tolerances off")
    return int(bool(wrong))


if __name__ == "__main__":
    sys.exit(main())
