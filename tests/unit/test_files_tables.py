"""The JSON tables of a study: layout, first receiver, numbers that do not exist."""

import json
import runpy
from dataclasses import replace
from pathlib import Path

import pytest

from femstruct.errors import Finding
from femstruct.files.study_tables import summary
from femstruct.files.tables import findings_by_case

BY_HAND = runpy.run_path(str(Path(__file__).parents[1] / "data" / "study_by_hand.py"))


@pytest.fixture(scope="module")
def result():
    return BY_HAND["study_by_hand"]()


def test_layout_is_the_documented_one(result):
    table = summary(result)
    case = table["cases"]["without damper"]
    assert set(case) == {
        "outcome",
        "accuracy",
        "basis",
        "rated",
        "peaks",
        "contacts",
        "bodies",
        "blows",
        "drops",
        "shock_spectra",
        "perception",
        "vibration",
        "sources",
        "fatigue",
        "stresses",
        "arrays",
        "energy",
        "error_estimate",
        "levels",
        "by_surface",
        "own_levels",
        "total_levels",
        "sound_energy",
        "limits",
        "machine",
        "findings",
    }
    assert set(case["peaks"]["O_f.z velocity"]) == {"first_impact", "whole", "unit", "converged"}
    assert set(case["contacts"]["ball on floor"]) == {"peak_force_n", "peak_time_s", "closings", "first_open_s"}
    assert set(case["bodies"]["ball"]) == {"end_velocity", "travel"}
    assert set(case["energy"]) == {"input_j", "at_separation", "end", "ledger_residual"}
    assert {"t_s", "ball", "structure", "dissipated"} <= set(case["energy"]["end"])
    single = {"l_peak_db", "l_cpeak_db", "l_afmax_db", "l_asmax_db", "l_aimax_db", "l_aeq_db", "l_ae_db"}
    assert set(case["levels"]["box.mic"]) == single | {
        "peak_pa",
        "bands_db",
        "octaves_db",
        "exposure_db",
        "complete_below_hz",
    }
    assert {"code", "message", "values"} <= set(case["findings"][0])
    beside = table["comparison"]["damper 0.6 / new"]
    assert {"peaks", "bands_db", "modes_db"} <= set(beside)
    assert beside["peaks"]["O_f.z velocity"] == {
        "first_impact_percent": -50.0,
        "whole_percent": None,
        "converged": True,
    }


def test_short_tables_are_those_of_the_first_receiver(result):
    beside = summary(result)["comparison"]["damper 0.6 / new"]
    assert beside["modes_db"] == beside["modes_db_by_channel"]["box.mic pressure"] == {"2": 5.9}
    assert beside["bands_db"] == beside["bands_db_by_receiver"]["box.mic"]


def test_without_a_room_the_first_channel_stands_in(result):
    quiet = {name: replace(case, rooms={}, levels={}) for name, case in result.cases.items()}
    beside = summary(replace(result, cases=quiet))["comparison"]["damper 0.6 / new"]
    assert beside["modes_db"] == {"2": 6.0}


def test_nan_becomes_null(result):
    text = json.dumps(summary(result), allow_nan=False)
    assert json.loads(text)["comparison"]["damper 0.6 / new"]["bands_db"] == {"25": 6.02, "31.5": None}


def test_energy_put_in_is_the_start_and_the_work(result):
    case = result.cases["without damper"]
    ledger = case.response.ledger
    worked = replace(ledger, end=replace(ledger.end, work=0.03))
    changed = replace(case, response=replace(case.response, ledger=worked))
    table = summary(replace(result, cases={**result.cases, "without damper": changed}))
    # 0.12 J of the ball, made by hand, and the work just put in; 1e-15: one addition
    assert table["cases"]["without damper"]["energy"]["input_j"] == pytest.approx(0.15, rel=1e-15)


def test_findings_name_the_cases_they_hold_for(result):
    first, second = result.cases
    case = result.cases[second]
    own = Finding("own", "Of one case alone.")
    changed = {**result.cases, second: replace(case, findings=(*case.findings, own))}
    whole = Finding("whole", "Of the run.")
    told = findings_by_case(replace(result, cases=changed, findings=(whole,)))
    assert told == ((whole, ()), (case.findings[0], (first, second)), (own, (second,)))
