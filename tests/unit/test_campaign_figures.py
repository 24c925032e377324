"""What pictures of campaigns show is what is in the rows."""

from dataclasses import replace

import numpy as np
from matplotlib.collections import LineCollection

from femstruct.campaign.tasks import unit_in
from femstruct.study.campaigns import Swept, spread
from femstruct.study.study import Plan
from femstruct.view.campaign_answers import swept_pieces
from femstruct.view.campaign_figures import bands_figure, edges, swept_figure, swept_parallel

N = 16
LEVELS = tuple(f"levels / hall.mic / bands_db / {band}" for band in ("63", "125", "250"))


def rows() -> Swept:
    """Two masses and a word for 16 samples, the last of them not to be trusted; a level follows the first mass."""
    rng = np.random.default_rng(1)
    masses = np.column_stack([rng.uniform(1.0, 2.0, N), np.geomspace(1.0, 100.0, N), np.full(N, np.nan)])
    texts = tuple((f"{a} kg", f"{b} kg", "oak" if i % 3 else "fir") for i, (a, b, _) in enumerate(masses))
    level = 60.0 + 10.0 * masses[:, 0]
    numbers = np.column_stack([level, level, level + 3.0, np.where(np.arange(N) == 2, np.nan, level)])[None]
    severe = (((),) * (N - 1) + (("unsound",),),)
    return Swept(
        title="hits", paths=("bodies.a.mass", "bodies.b.mass", "parts.floor.material"), units=("kg", "kg", ""),
        texts=texts, values=masses, method="latin hypercube", cases=("as given",), baseline="as given",
        names=("hall.mic L_AFmax", *LEVELS), number_units=("dB",) * 4, main=("hall.mic L_AFmax",), numbers=numbers,
        done=np.ones(N, dtype=bool), severe=severe, findings=severe, trouble=("",) * N,
    )  # fmt: skip


def test_envelopes_are_quantiles_of_the_samples_that_are_trusted() -> None:
    whole = rows()
    figure = bands_figure(whole)
    assert figure is not None
    (axes,) = figure.axes
    corners = axes.collections[0].get_paths()[0].vertices
    level = whole.of(LEVELS[0])[:-1]
    for x, add in ((0, 0.0), (1, 3.0)):
        own = corners[corners[:, 0] == x, 1]
        ends = np.quantile(level, (0.05, 0.95)) + add
        np.testing.assert_allclose((own.min(), own.max()), ends, rtol=1e-12)  # rounding
        np.testing.assert_allclose(axes.lines[0].get_ydata()[x], np.median(level) + add, rtol=1e-12)  # rounding
    assert np.isnan(axes.lines[0].get_ydata()[2])  # a sample has no level there
    assert [one.get_text() for one in axes.get_xticklabels()] == ["63", "125", "250"]
    chosen = bands_figure(replace(whole, method="grid"))
    corners = chosen.axes[0].collections[0].get_paths()[0].vertices
    assert corners[corners[:, 0] == 0, 1].max() == level.max()
    assert bands_figure(replace(whole, names=("a", "b", "c", "d"))) is None


def test_cells_of_a_map_lie_about_their_values() -> None:
    """Of 1, 10, 100 on a logarithmic axis the edges are half a decade away, else half-way to the next."""
    decades = 10.0 ** np.array([-0.5, 0.5, 1.5, 2.5])
    np.testing.assert_allclose(edges(np.array([1.0, 10.0, 100.0])), decades, rtol=1e-12)  # rounding
    found = edges(np.array([1.0, 4.0, 5.0]))
    assert found.tolist() == [-0.5, 2.5, 4.5, 5.5] and edges(np.array([2.0])).tolist() == [1.9, 2.1]


def test_ticks_of_a_map_are_at_values_that_were_run() -> None:
    """Cells about the first and the last value go beyond them; an axis of times went from below 0 on."""
    whole = rows()
    values = np.array([(a, b) for a in (0.1, 0.4, 0.7, 1.0) for b in (0.14, 0.18, 0.22, 0.26)])
    grid = replace(whole, values=values, paths=("rooms.a.losses.t60", "parts.slab.thickness"), units=("s", "m"),
                   texts=tuple((f"{a}", f"{b} m") for a, b in values), method="grid")  # fmt: skip
    axes = swept_figure(grid, ("hall.mic L_AFmax",)).axes[0]
    assert [one.get_text() for one in axes.get_xticklabels()] == ["0.1", "0.4", "0.7", "1"]
    assert [one.get_text() for one in axes.get_yticklabels()] == ["140", "180", "220", "260"]
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("rooms.a.losses.t60 [s]", "parts.slab.thickness [mm]")


def test_bands_of_a_rated_room_have_their_symbol() -> None:
    whole = rows()
    assert bands_figure(whole).axes[0].get_ylabel() == "L_Fmax in dB re 20 µPa"
    names = (*(f"rated / hall / bands_db / {band}" for band in (63, 125)), "rated / hall / numbers / X / value_db")
    for number, label in (("L'_iA,Fmax,V,T", "L'_i,Fmax,V,T"), ("L'_nT,w", "L'_nT"), ("L-50", "rated bands")):
        rated = replace(whole, names=(*(one.replace("X", number) for one in names), "mass"))
        assert bands_figure(rated).axes[0].get_ylabel() == f"{label} in dB re 20 µPa"


def test_plain_numbers_have_the_unit_that_the_file_writes() -> None:
    sources = {"a.study.yaml": "rooms: {bed: {losses: {t60: 0.5 s}}}\nn: 3\n", "b.yaml": "parts: {slab: {E: 30 GPa}}"}
    plan = Plan("", (), "", sources)
    paths = ("rooms.bed.losses.t60", "parts.slab.E", "n", "rooms.bed", "rooms.x.y")
    assert [unit_in(plan, path) for path in paths] == ["s", "Pa", "", "", ""]


def test_each_trusted_sample_is_a_line_across_all_axes() -> None:
    whole = rows()
    figure = swept_parallel(whole, whole.main)
    assert figure is not None
    host, *axes = figure.axes
    lines = [one for one in host.collections if isinstance(one, LineCollection)][-1].get_segments()
    assert len(lines) == N - 1 and {len(one) for one in lines} == {4}
    first = np.array([one[0, 1] for one in lines])
    level = np.array([one[3, 1] for one in lines])
    np.testing.assert_allclose(first, level, atol=1e-12)  # the level is linear in the first mass: rounding
    second = np.sort([one[1, 1] for one in lines])
    np.testing.assert_allclose(np.diff(second), np.diff(second)[0], rtol=1e-9)  # even on a logarithmic axis: rounding
    titles = [one.get_title().replace("\n", " ") for one in axes]
    assert titles[:4] == [
        "bodies.a.mass [kg]",
        "bodies.b.mass [kg]",
        "parts.floor. material",
        "hall.mic L_AFmax [dB]",
    ]
    assert [one.get_text() for one in axes[2].get_yticklabels()] == ["fir", "oak"]
    two = replace(whole, texts=tuple((*one[:2], "oak") for one in whole.texts))
    assert swept_parallel(two, whole.main) is None


def test_levels_that_hardly_change_are_drawn_so() -> None:
    whole = rows()
    same = replace(whole, numbers=55.48 + 1e-4 * (whole.numbers - 55.0), paths=whole.paths[:1], units=whole.units[:1],
                   texts=tuple(one[:1] for one in whole.texts), values=whole.values[:, :1])  # fmt: skip
    axes = swept_figure(same, ("hall.mic L_AFmax",)).axes[0]
    low, high = axes.get_ylim()
    np.testing.assert_allclose(high - low, 0.1, rtol=1e-9)  # rounding
    assert not axes.yaxis.get_major_formatter().get_useOffset()


def test_a_case_that_does_not_change_stands_beside_one_that_does() -> None:
    whole = rows()
    numbers = np.concatenate([whole.numbers, whole.numbers * 0.0 + 50.0])
    two = replace(whole, cases=("as given", "fixed"), numbers=numbers,
                  severe=whole.severe * 2, findings=whole.findings * 2)  # fmt: skip
    for table in (replace(two, method="grid"), two):
        grid = list(swept_pieces(table))[1]
        assert [row[1] for row in grid.rows][:2] == ["as given", "fixed"]
    assert spread(two, "hall.mic L_AFmax", "fixed").deviation == 0.0


def test_a_number_that_no_sample_has_is_not_the_same_in_all() -> None:
    """Nor one that only the sample has that is not to be trusted."""
    whole = rows()
    names = ("hall rating", "hall rating before rounding", "total mass", "hall.mic L_AFmax")
    values = np.column_stack([np.full((N, 2), np.nan), np.full(N, 7.0), np.full(N, np.nan)])[None].copy()
    values[0, -1] = 50.0  # of the last sample, whose finding forbids trust
    some = replace(whole, names=names, number_units=("dB", "dB", "kg", "dB"), main=names, numbers=values,
                   findings=((("rating-beyond-modes",),) * N,))  # fmt: skip
    told = [one for one in swept_pieces(some) if isinstance(one, str)]
    why = "it needs bands that are blank; femstruct explain rating-beyond-modes"
    assert f"Not known in any of the samples: hall rating, hall rating before rounding ({why})" in told
    assert "Not known in any of the samples: hall.mic L_AFmax" in told
    assert "The same in all samples: total mass" in told


def test_a_limit_stands_in_the_legend() -> None:
    """In a map with its value, beside its line; in curves and points also where only a lower axis has one."""
    whole = rows()
    values = np.array([(a, b) for a in (0.1, 0.4, 0.7, 1.0) for b in (0.14, 0.18, 0.22, 0.26)])
    grid = replace(whole, values=values, paths=("a", "b"), units=("s", "m"), method="grid",
                   texts=tuple((f"{a}", f"{b} m") for a, b in values), severe=(((),) * N,),
                   limits={LEVELS[0]: 75.0}, numbers=np.nan_to_num(whole.numbers, nan=70.0))  # fmt: skip

    def legends(one: Swept) -> list[str]:
        drawn = [axes.get_legend() for axes in swept_figure(one, LEVELS[:2]).axes]
        return [text.get_text() for legend in drawn if legend is not None for text in legend.get_texts()]

    assert legends(grid) == ["limit 75 dB"]
    assert legends(replace(grid, limits={LEVELS[0]: 95.0})) == []  # no line: all hold it
    drawn = replace(grid, method="latin hypercube")
    assert [legends(replace(drawn, limits={name: 75.0})) for name in LEVELS[:2]] == [["limit"], ["limit"]]
    assert legends(replace(drawn, limits={})) == []
