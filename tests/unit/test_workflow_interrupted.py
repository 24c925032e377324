"""Ctrl-C loses nothing that was finished."""

import sys
from dataclasses import replace
from pathlib import Path

import pytest

from femstruct.commands.shared import verdict
from femstruct.exits import INTERRUPTED
from femstruct.files.results_file import read_results, write_results
from femstruct.language.cases import read_study
from femstruct.workflow.run import run_study

STUDY = Path(__file__).parents[2] / "models" / "three_bodies.study.yaml"


def interrupted_after(count: int, monkeypatch: pytest.MonkeyPatch):
    """The study of three bodies as three equal cases, interrupted in the case after `count` finished ones."""
    plan = read_study(STUDY)
    only = plan.cases[0]
    plan = replace(plan, cases=tuple(replace(only, name=name) for name in "abc"), baseline="a")
    module = sys.modules[run_study.__module__]
    run_case, done = module.run_case, []

    def until_then(*arguments, **options):
        if len(done) == count:
            raise KeyboardInterrupt
        done.append(arguments[0].name)
        return run_case(*arguments, **options)

    monkeypatch.setattr(module, "run_case", until_then)
    return run_study(plan)


def test_finished_cases_are_kept_and_the_rest_is_said(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    result = interrupted_after(2, monkeypatch)
    assert list(result.cases) == ["a", "b"]
    assert [finding.code for finding in result.findings] == ["interrupted"]
    assert result.findings[0].severe
    assert verdict(result) == INTERRUPTED
    write_results(tmp_path / "results.h5", result)
    assert list(read_results(tmp_path / "results.h5").cases) == ["a", "b"]


def test_without_a_baseline_there_is_nothing_to_keep(monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(KeyboardInterrupt):
        interrupted_after(0, monkeypatch)
