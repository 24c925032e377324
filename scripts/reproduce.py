"""Write the reproduction ledger: every number of the dissertation we looked at, ours, and a verdict.

`python scripts/reproduce.py [FOLDER]` writes FOLDER/ledger.md and FOLDER/ledger.csv (default: results). Rows come from
all modules of scripts/ledger that have a function `rows`.
"""

from __future__ import annotations

import csv
import importlib
import pkgutil
import sys
import time
from collections import Counter
from pathlib import Path

import ledger
from ledger.row import Row

COLUMNS = ("where", "relation", "printed", "ours", "tolerance", "unit", "verdict", "note")


def gather() -> dict[str, list[Row]]:
    """Rows by the name of their module, in alphabetical order."""
    found: dict[str, list[Row]] = {}
    for module in sorted(info.name for info in pkgutil.iter_modules(ledger.__path__)):
        rows = getattr(importlib.import_module(f"ledger.{module}"), "rows", None)
        if rows is not None:
            found[module] = rows()
    return found


def cells(row: Row) -> tuple[str, ...]:
    """A row as text, numbers with ten digits."""
    numbers = (f"{value:.10g}" for value in (row.printed, row.ours, row.tolerance))
    return (row.where, row.relation, *numbers, row.unit, row.verdict, row.sentence)


def write_csv(rows: list[Row], path: Path) -> None:
    """All rows, a line each."""
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(COLUMNS)
        writer.writerows(cells(row) for row in rows)


def write_markdown(found: dict[str, list[Row]], path: Path) -> None:
    """A table a module, with the count of verdicts above."""
    counted = Counter(row.verdict for rows in found.values() for row in rows)
    lines = ["# Reproduction ledger", "", ", ".join(f"{n} {verdict}" for verdict, n in counted.most_common()), ""]
    for module, rows in found.items():
        lines += [f"## {module.replace('_', ' ')}", "", "| where | printed | ours | tolerance | verdict | note |"]
        lines.append("|---|---|---|---|---|---|")
        for row in rows:
            unit = "" if row.unit == "1" else f" {row.unit}"
            sign = "" if row.relation == "=" else f"{row.relation} "
            numbers = f"{sign}{row.printed:.5g}{unit} | {row.ours:.5g}{unit} | {row.tolerance:.2g}"
            text = row.sentence.replace("|", "\\|")
            lines.append(f"| {row.where.replace('|', chr(92) + '|')} | {numbers} | {row.verdict} | {text} |")
        lines.append("")
    path.write_text("\n".join(lines), encoding="utf-8")


def main(folder: Path = Path("results")) -> dict[str, float]:
    """Write the ledger; returns how many rows have each verdict."""
    found = gather()
    rows = [row for some in found.values() for row in some]
    folder.mkdir(parents=True, exist_ok=True)
    write_csv(rows, folder / "ledger.csv")
    write_markdown(found, folder / "ledger.md")
    return {verdict: float(n) for verdict, n in Counter(row.verdict for row in rows).items()} | {"rows": len(rows)}


if __name__ == "__main__":
    begin = time.process_time()
    for name, count in main(*(Path(argument) for argument in sys.argv[1:2])).items():
        print(f"{name:32} {count:5.0f}")
    print(f"{time.process_time() - begin:.0f} s CPU")
