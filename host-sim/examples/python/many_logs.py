"""Many logs on many machines: Dask maps logs to a partitioned Parquet data set of events.

    python many_logs.py FLOE LOGS DIRECTORY [--lose-a-worker]

One partition a log, `test_id=NAME/events.parquet`, written under another name first, so
that a worker that is lost in the middle leaves nothing behind and its logs are done again
elsewhere. Give `Client("HOST:PORT")` a scheduler's address to use a cluster.
"""

import json
import os
import subprocess
import sys
from pathlib import Path

import duckdb
import polars as pl
from distributed import Client, LocalCluster, as_completed


def evaluate(floe, log, directory):
    """One log to one partition; the means that floe itself gives."""
    done = subprocess.run([floe, "replay", log, "--json"], check=True, capture_output=True, text=True)
    result = json.loads(done.stdout)
    partition = Path(directory) / f"test_id={Path(log).stem}"
    partition.mkdir(parents=True, exist_ok=True)
    events = pl.DataFrame(
        [
            {name: event[name] for name in ("index", "onset_s", "mu_s", "mu", "quality")}
            | {"weight_n": result["test"]["weight_n"]}
            for event in result["events"]
        ],
        schema={
            "index": pl.UInt32, "onset_s": pl.Float64, "mu_s": pl.Float64, "mu": pl.Float64,
            "quality": pl.String, "weight_n": pl.Float64,
        },
    )
    unfinished = partition / f".{os.getpid()}.part"
    events.write_parquet(unfinished)
    unfinished.replace(partition / "events.parquet")
    return Path(log).stem, result["estimate"]


def run(client, floe, logs, directory, lose_a_worker):
    futures = client.map(evaluate, [floe] * len(logs), logs, [directory] * len(logs), retries=2)
    estimates = {}
    for future, (name, estimate) in as_completed(futures, with_results=True):
        estimates[name] = estimate
        if lose_a_worker:
            lose_a_worker()
            lose_a_worker = None
    return estimates


def main(floe, logs, directory, *options):
    logs = sorted(str(path) for path in Path(logs).glob("*.csv"))
    with LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster:
        with Client(cluster) as client:
            def lose():
                worker = next(iter(cluster.workers.values()))
                worker.process.process.kill()
            lose_a_worker = lose if "--lose-a-worker" in options else None
            estimates = run(client, floe, logs, directory, lose_a_worker)

    table = f"read_parquet('{directory}/*/events.parquet', hive_partitioning = true)"
    question = f"""
        SELECT test_id, any_value(weight_n) AS weight_n, count(*) AS events,
               avg(mu_s) AS mu_s, avg(mu) AS mu
        FROM {table} GROUP BY test_id ORDER BY test_id"""
    print(duckdb.sql(question))

    campaign = json.loads(
        subprocess.run(
            [floe, "campaign", str(Path(logs[0]).parent), "--json"],
            check=True, capture_output=True, text=True,
        ).stdout
    )
    [(events,)] = duckdb.sql(f"SELECT count(*) FROM {table}").fetchall()
    assert events == campaign["events"], (events, campaign["events"])
    one_process = [record["mu"]["mean"] for record in campaign["records"]]
    many = [estimates[Path(log).stem]["mu"]["mean"] for log in logs]
    assert one_process == many, (one_process, many)
    print(f"{len(logs)} logs, {events} events: the same as floe campaign in one process")


if __name__ == "__main__":
    if len(sys.argv) < 4:
        sys.exit("usage: python many_logs.py FLOE LOGS DIRECTORY [--lose-a-worker]")
    main(*sys.argv[1:])
