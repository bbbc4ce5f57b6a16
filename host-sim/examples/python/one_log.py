"""One log: its JSON and its samples in polars and DuckDB, and the phase plane.

    python one_log.py FLOE LOG DIRECTORY [--weight-n W]

FLOE is the program, LOG a log, DIRECTORY takes the samples and the picture.
"""

import json
import subprocess
import sys
from pathlib import Path

import duckdb
import matplotlib
import polars as pl

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402


def replay(floe, log, directory, options):
    """The result of a replay; every sample goes to samples.parquet."""
    samples = directory / "samples.parquet"
    command = [floe, "replay", log, "--json", "--samples", str(samples), *options]
    done = subprocess.run(command, check=True, capture_output=True, text=True)
    return json.loads(done.stdout), samples


def draw_phase_plane(samples, picture):
    """Rate of the force against the force, stick and slip apart."""
    figure, axes = plt.subplots(figsize=(6, 5))
    for phase, colour in [("stick", "#0067a3"), ("slip", "#b34a00")]:
        of_phase = samples.filter(pl.col("phase") == phase)
        axes.plot(of_phase["force_n"], of_phase["rate_n_per_s"], ".", ms=2, color=colour, label=phase)
    axes.set(xlabel="force (N)", ylabel="rate of the force (N/s)")
    axes.legend()
    figure.savefig(picture, dpi=120)
    plt.close(figure)


def main(floe, log, directory, *options):
    directory = Path(directory)
    directory.mkdir(parents=True, exist_ok=True)
    result, path = replay(floe, log, directory, options)

    events = pl.DataFrame(result["events"], infer_schema_length=None)
    print(events.select(pl.len().alias("events"), pl.col("mu_s").mean(), pl.col("mu").mean()))

    question = f"""
        SELECT phase, count(*) AS samples, round(max(force_n), 1) AS highest_n
        FROM '{path}' WHERE flag = 'good' GROUP BY phase ORDER BY phase"""
    print(duckdb.sql(question))

    samples = pl.read_parquet(path)
    assert samples.height >= result["log"]["samples"], "every sample is in the table"
    mean = events["mu"].mean()
    spread = abs(mean - result["estimate"]["mu"]["mean"])
    assert spread < 0.01, f"mean of the events {mean}, and floe's {result['estimate']['mu']}"
    draw_phase_plane(samples, directory / "phase-plane.png")
    print(f"written {directory / 'phase-plane.png'}")


if __name__ == "__main__":
    if len(sys.argv) < 4:
        sys.exit("usage: python one_log.py FLOE LOG DIRECTORY [--weight-n W]")
    main(*sys.argv[1:])
