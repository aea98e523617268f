"""Factors: levels, ranges and distributions, as they are written."""

from __future__ import annotations

from pathlib import Path
from statistics import mean, median, stdev

import pytest

from prima.errors import UsageError
from prima.experiments.levels import Factor, cell, read_factor
from prima.language.distributions import Distributions, share
from prima.sim.paths import find
from prima.sim.scenario import look_at_scenario
from tests.helpers.sweeps import VISIT


def factor(path: str, levels: str, folder: str = "") -> Factor:
    root = look_at_scenario("visit.xml", VISIT.encode())[0].node
    return read_factor(find(root, path, lambda: root), levels, folder)


def drawn(path: str, levels: str, folder: str = "") -> list[float]:
    """A thousand values, evenly over the distribution."""
    one = factor(path, levels, folder)
    values = [cell(one.kind, one.drawn((index + 0.5) / 1000)) for index in range(1000)]
    return [value for value in values if isinstance(value, int | float)]


@pytest.mark.parametrize(
    ("path", "levels", "made"),
    [
        ("touch", "0s..1s/500ms", ("0ms", "500ms", "1000ms")),
        ("touch", "0s..1s/400ms", ("0ms", "400ms", "800ms")),
        ("touch", "2s|0s..1s/1s|5s", ("2s", "0ms", "1000ms", "5s")),
        ("touch", "3s..3s/1s", ("3000ms",)),
        ("person.x", "-1..1/0.5", ("-1", "-0.5", "0", "0.5", "1")),
        ("person.x", "0.1..0.3/0.1", ("0.1", "0.2", "0.3")),
        ("person.speed", "0.5..0.52/0.01", ("0.5", "0.51", "0.52")),
        ("reply", "Yes.|No.|", ("Yes.", "No.", "")),
        ("reply", r"Yes\|no|No.", ("Yes|no", "No.")),
        ("reply", "normal(1,2)", ("normal(1,2)",)),
        ("reply.after", "1s|", ("1s", "")),
    ],
)
def test_levels(path: str, levels: str, made: tuple[str, ...]) -> None:
    assert factor(path, levels).levels == made


@pytest.mark.parametrize(
    ("path", "levels", "why"),
    [
        ("touch", "soon", '"soon"'),
        ("reply", "Yes.|\udcff", "reply: Its levels are not UTF-8"),
        ("touch", "1s|1s", 'The level "1s" is there twice.'),
        ("touch", "1s|2s|1000ms", 'The level "1000ms" is there twice, as "1s".'),
        ("person.speed", "1|1.0", 'The level "1.0" is there twice, as "1".'),
        ("touch", "5s..1s/1s", "it ends before it begins"),
        ("touch", "0s..1s/0s", "its step is not above 0"),
        ("touch", "0s..86400s/1ms", "levels; at most 100,000"),
        ("person.speed", f"0.5..5/0.{'0' * 310}1", "levels; at most 100,000"),
        ("touch", "1s|0s..20s", r"The range \"0s..20s\" has no step: write 0s..20s/STEP"),
        ("touch", "normal(1s)", r"Write normal\(MEAN,DEVIATION\)"),
        ("touch", "normal(1s,0s)", "has to be above 0"),
        ("touch", "lognormal(1s,nan)", '"nan" is not the standard deviation of a logarithm'),
        ("touch", "lognormal(1s,inf)", '"inf" is not the standard deviation of a logarithm'),
        ("touch", "normal(1s,-1s)", "out of range|is not|has to"),
        ("touch", "nromal(1s,1s)", 'Did you mean "normal"'),
        ("touch", "lognormal(1s,x)", '"x" is not the standard deviation of a logarithm'),
        ("touch", "lognormal(1s,0.3s)", 'logarithm. Write a number above 0, as "0.4".'),
        ("touch", "lognormal(1s,-1)", "is not the standard deviation"),
        ("touch", "uniform(2s,1s)", "ends before it begins"),
        ("touch", "empirical(none.csv)", "none.csv cannot be read: No such file"),
        ("person.speed", "0|-3", "out of range"),
        ("person.x", "1e400", "is not|out of range"),
        ("entrances", "open|close", 'There is no "close" here. Did you mean "closed"?'),
        ("entrances", "open|both", 'There is no "both" here. Write open.closed.'),
    ],
)
def test_what_is_wrong_with_levels(path: str, levels: str, why: str) -> None:
    with pytest.raises(UsageError, match=why) as caught:
        factor(path, levels)
    assert str(caught.value).startswith(f"{path}: ")


def test_distributions_have_their_parameters() -> None:
    assert mean(drawn("touch", "normal(10s,1s)")) == pytest.approx(10, abs=0.01)
    assert stdev(drawn("touch", "normal(10s,1s)")) == pytest.approx(1, abs=0.01)
    assert stdev(drawn("person.speed", "normal(1,0.01)")) == pytest.approx(0.01, abs=0.001)
    assert median(drawn("touch", "lognormal(5s,0.4)")) == pytest.approx(5, abs=0.01)
    assert mean(drawn("touch", "exponential(5s)")) == pytest.approx(5, abs=0.05)
    for text in ("uniform(1s,3s)", "1s..3s"):
        made = drawn("touch", text)
        assert min(made) == pytest.approx(1, abs=0.01)
        assert max(made) == pytest.approx(3, abs=0.01)
        assert mean(made) == pytest.approx(2, abs=0.01)


@pytest.mark.parametrize(
    ("limit", "why"),
    [
        ("MOST_BYTES", "many.csv cannot be read: it is larger than 4 bytes."),
        ("MOST_VALUES", "many.csv has more than 4 values."),
    ],
)
def test_files_with_too_many_values(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, limit: str, why: str
) -> None:
    monkeypatch.setattr(f"prima.language.distributions.{limit}", 4)
    (tmp_path / "many.csv").write_text("1\n2\n3\n4\n5\n", encoding="utf-8")
    with pytest.raises(UsageError, match=why):
        factor("touch", "empirical(many.csv)", str(tmp_path))


def test_what_is_drawn_stays_in_the_range_of_the_value() -> None:
    assert min(drawn("touch", "normal(0s,10s)")) == 0
    assert min(drawn("person.speed", "normal(1,5)")) == 0.05


def test_values_measured_by_somebody(tmp_path: Path) -> None:
    folder = str(tmp_path)
    (tmp_path / "plain.csv").write_text("1\n2.5\n\n4s\n", encoding="utf-8")
    assert set(drawn("touch", "empirical(plain.csv)", folder)) == {1, 2.5, 4}
    (tmp_path / "named.csv").write_text("\ufeffwho,delay\nann,1\nbob,300ms\n", encoding="utf-8")
    assert set(drawn("touch", "empirical(named.csv:delay)", folder)) == {1, 0.3}
    for text, why in {
        "empirical(named.csv:dely)": 'no column "dely". Did you mean "delay"',
        "empirical(named.csv)": 'named.csv:2: "ann"',
        "empirical(nan.csv:delay)": 'nan.csv:4: "nan"',
        "empirical(comma.csv)": "comma.csv:1: there are several cells; write 1.5 for 1,5",
        "empirical(excel.csv)": "excel.csv: its cells are separated by ';'",
        "empirical(excel.csv:delay)": "excel.csv: its cells are separated by ';'",
        "empirical(.)": "it is not a file",
        "empirical(/dev/zero)": "it is not a file",
        "empirical(empty.csv)": "has no values",
        "empirical(bytes.csv)": "cannot be read: it is not UTF-8",
    }.items():
        (tmp_path / "empty.csv").write_text("delay\n", encoding="utf-8")
        (tmp_path / "nan.csv").write_text("delay\n1\n\nnan\n", encoding="utf-8")
        (tmp_path / "comma.csv").write_text("1,5\n2,5\n", encoding="utf-8")
        (tmp_path / "excel.csv").write_text("delay;who\n1,5;ann\n", encoding="utf-8")
        (tmp_path / "bytes.csv").write_bytes(b"\xff\xfe\x00")
        with pytest.raises(UsageError, match=why):
            factor("touch", text, folder)


def test_what_a_table_shows_of_a_level() -> None:
    assert cell("duration", "1500ms") == 1.5
    assert cell("duration", "") is None
    assert cell("integer", "3") == 3
    assert cell("text", "") == ""


def test_shares_depend_on_seed_and_path_alone() -> None:
    assert share(1, "answer[1].after") == 0.952778272794054
    shares = [share(seed, "answer[1].after") for seed in range(1, 2001)]
    assert 0.45 < mean(shares) < 0.55
    assert 0.26 < stdev(shares) < 0.32
    assert share(7, "answer[1].after") != share(7, "answer[2].after")


def test_distributions_need_no_scenario() -> None:
    quantile = Distributions("duration", high=10_000).read("normal(2s,500ms)")
    assert quantile is not None
    assert quantile(0.5) == 2000.0
    with pytest.raises(ValueError, match='"11s" is out of range: from 0ms to 10000ms'):
        Distributions("duration", high=10_000).read("uniform(0s,11s)")
