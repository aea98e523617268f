"""prima study."""

from __future__ import annotations

import click
from click.exceptions import Exit

from prima.cli.options import PathName, formats_option, limit_option, policy_option
from prima.cli.printing import print_json, put, write_for_programs
from prima.cli.progress import show_count


@click.command()
@click.argument("scenarios", nargs=-1, type=PathName())
@policy_option("Only this policy; may be repeated: {}.", many=True)
@limit_option
@formats_option("text", "json", "csv")
def study(scenarios: tuple[str, ...], policies: tuple[str, ...], form: str) -> None:
    """Run situations under every policy and measure the effects on units, streams and channel.

    A folder stands for all scenarios in it. Without SCENARIOS the ten situations of the
    thesis are run. docs/measures.md
    defines the columns. A "!" marks a run in which an application failed; the exit
    code is then 3.

    \b
    prima study
    prima study my-scenario.xml --policy prima --policy fifo --format csv
    """
    from prima.experiments.study import POLICIES as ALL
    from prima.experiments.study import format_csv, format_table, result_data, situations
    from prima.experiments.study import study as run_study
    from prima.testing.finding import find

    chosen, results = find(scenarios) or [*map(str, situations())], []
    each = list(dict.fromkeys(policies or ALL))
    total = len(chosen) * len(each)
    for result in run_study(chosen, each):
        results.append(result)
        show_count(len(results), total, "runs")
    if form == "json":
        print_json([result_data(result) for result in results])
    elif form == "csv":
        write_for_programs()
        put(format_csv(results))
    else:
        put(format_table(results))
    if any(result.failures for result in results):
        raise Exit(3)
