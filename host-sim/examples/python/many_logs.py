"""Many logs on many machines: Dask maps logs to a partitioned Parquet data set of events.

    python many_logs.py FLOE LOGS DIRECTORY [--lose-a-worker]

One partition a log, `log=NAME/events.parquet`, the table of a campaign of this log alone.
It is there as a whole or not at all, so that a worker that is lost in the middle leaves
nothing to be read and its logs are done again elsewhere. Give `Client("HOST:PORT")` a
scheduler's address to use a cluster.
"""

import json
import subprocess
import sys
from pathlib import Path

import duckdb
from distributed import Client, LocalCluster, as_completed


def campaign(floe, logs, *options):
    """The JSON of a campaign."""
    command = [floe, "campaign", str(logs), "--json", *options]
    return json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)


def evaluate(floe, log, directory):
    """One log to one partition; the test that floe itself makes of it."""
    log = Path(log).resolve()
    partition = Path(directory) / f"log={log.stem}"
    partition.mkdir(parents=True, exist_ok=True)
    alone = partition / "list"
    alone.write_text(f"{log}\n")
    [test] = campaign(floe, alone, "--parquet", str(partition / "events.parquet"))["records"]
    return log.stem, test


def run(client, floe, logs, directory, lose_a_worker):
    futures = client.map(evaluate, [floe] * len(logs), logs, [directory] * len(logs), retries=2)
    tests = {}
    for _, (name, test) in as_completed(futures, with_results=True):
        tests[name] = test
        if lose_a_worker:
            lose_a_worker()
            lose_a_worker = None
    return tests


def main(floe, logs, directory, *options):
    logs = sorted(str(path) for path in Path(logs).glob("*.csv"))
    with LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster:
        with Client(cluster) as client:
            def lose():
                worker = next(iter(cluster.workers.values()))
                worker.process.process.kill()
            lose_a_worker = lose if "--lose-a-worker" in options else None
            tests = run(client, floe, logs, directory, lose_a_worker)

    table = f"read_parquet('{directory}/*/events.parquet', hive_partitioning = true)"
    question = f"""
        SELECT snow_mm, weight_n, count(DISTINCT log) AS tests, count(*) AS events,
               round(avg(mu_s), 4) AS mu_s, round(avg(mu), 4) AS mu
        FROM {table} WHERE mu IS NOT NULL GROUP BY ALL ORDER BY ALL"""
    print(duckdb.sql(question))

    one_process = campaign(floe, Path(logs[0]).parent)
    [(events,)] = duckdb.sql(f"SELECT count(*) FROM {table}").fetchall()
    assert events == one_process["events"], (events, one_process["events"])
    for log, test in zip(logs, one_process["records"], strict=True):
        for coefficient in ("mu_s", "mu"):
            there, here = tests[Path(log).stem][coefficient], test[coefficient]
            assert there == here, (log, coefficient, there, here)
    print(f"{len(logs)} logs, {events} events: the same as floe campaign in one process")


if __name__ == "__main__":
    if len(sys.argv) < 4:
        sys.exit("usage: python many_logs.py FLOE LOGS DIRECTORY [--lose-a-worker]")
    main(*sys.argv[1:])
