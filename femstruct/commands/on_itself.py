"""Commands on the program: its kernels, its findings, its language, its library."""

from __future__ import annotations

from typing import Annotated, Literal

import typer

from femstruct.commands.shared import AsJson, command, print_json, progress
from femstruct.exits import GOOD

Kind = Literal["model", "study", "summary"]


@command
def warm_up() -> int:
    """Compile the simulation kernels now. This takes about 15 seconds, once; otherwise the first simulation does it."""
    from femstruct.compiled.store import compilation, folder
    from femstruct.impact.simulate import ALL

    with progress() as tell, compilation(ALL) as kernels:
        kernels.wait(tell)
    print(f"{len(kernels.units)} kernels compiled; they are kept in {folder()}")
    return GOOD


@command
def explain(
    code: Annotated[
        str, typer.Argument(metavar="[CODE]", help="code of a finding; without it, all codes are listed")
    ] = "",
    as_json: AsJson = False,
) -> int:
    """Explain a finding. What its code means, its thresholds, and what to do."""
    from femstruct.findings.catalogue import CATALOGUE, entry_of
    from femstruct.findings.explain import entry_table, explanation, listing

    if as_json:
        print_json(entry_table(entry_of(code)) if code else [entry_table(entry) for entry in CATALOGUE.values()])
    else:
        print(explanation(entry_of(code)) if code else listing())
    return GOOD


@command
def schema(
    kind: Annotated[Kind, typer.Argument(metavar="model|study|summary", help="kind of file")] = "model",
) -> int:
    """Print the JSON schema of a file. For editors, of a model or a study file; for programs, of summary.json."""
    if kind == "summary":
        from femstruct.files.summary_schema import summary_schema

        print_json(summary_schema())
        return GOOD
    from femstruct.language.cases import json_schema

    print_json(json_schema(kind))
    return GOOD


@command
def materials(
    words: Annotated[
        list[str] | None, typer.Argument(metavar="[WORD]", help="part of a name; without it, all entries are listed")
    ] = None,
    as_json: AsJson = False,
) -> int:
    """List materials and products with their sources. For 'like: NAME' in a model."""
    from femstruct.files.tables import library_table
    from femstruct.model.library_entries import look_up

    entries = look_up(words or ())
    if as_json:
        print_json([library_table(entry) for entry in entries])
    else:
        from femstruct.view.library_listing import show_library

        show_library(entries, bool(words))
    return GOOD


@command
def new(
    kind: Annotated[
        str, typer.Argument(metavar="[KIND]", help="what to start from; without it, all kinds are listed")
    ] = "",
    name: Annotated[str, typer.Argument(metavar="[NAME]", help="name of the new files, without .yaml")] = "",
    as_json: AsJson = False,
) -> int:
    """Write a model and a study to start from. Into this folder, never over a file."""
    from femstruct.templates.starting_files import KINDS, what_of, write_new

    if not kind:
        listed = {one: what_of(one) for one in KINDS}
        if as_json:
            print_json([{"kind": one, "what": what} for one, what in listed.items()])
        else:
            for one, what in listed.items():
                print(f"{one:16}{what}")
            print("femstruct new KIND [NAME] writes the files of one of them to this folder")
        return GOOD
    model, study = (path.name for path in write_new(kind, name))
    if as_json:
        print_json({"model": model, "study": study})
    else:
        print(f"{model} and {study} written; compute them with: femstruct run {study}")
    return GOOD
