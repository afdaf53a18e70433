"""How a fleet scales: updates a second and peak memory of `ted train` over lanes and cores, as a Markdown table.

usage: scaling.py TED DATASET [--updates N] [--rounds N]

TED is the program, DATASET a dataset's folder. Each cell is two whole commands, one of a few updates and one of `--updates` more;
their difference is what the updates alone take. Cores are given by affinity, so the fleet shares them out as it does anywhere.
Cells take turns in every round, and medians of the rounds are printed. Unix only.
"""

import argparse
import os
import statistics
import subprocess
import sys
import tempfile
import time

LANES = [1, 2, 4, 8, 12]
FEW = 20


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("ted")
    parser.add_argument("dataset")
    parser.add_argument("--updates", type=int, default=1000)
    parser.add_argument("--rounds", type=int, default=3)
    options = parser.parse_args()
    cores = sorted(os.sched_getaffinity(0))
    crews = [count for count in (1, 2, 4, 8) if count <= len(cores)]
    cells = {(lanes, crew): ([], []) for lanes in LANES for crew in crews}
    for round_ in range(options.rounds):
        for (lanes, crew), (rates, peaks) in cells.items():
            print(f"round {round_ + 1}: {lanes} lanes on {crew} cores", file=sys.stderr)
            few, _ = train(options, lanes, cores[:crew], FEW)
            many, peak = train(options, lanes, cores[:crew], FEW + options.updates)
            rates.append(lanes * options.updates / (many - few))
            peaks.append(peak)
    print("| lanes | " + " | ".join(f"updates/s, {crew} cores | peak memory" for crew in crews) + " |")
    print("|---:|" + "---:|---:|" * len(crews))
    for lanes in LANES:
        row = []
        for crew in crews:
            rates, peaks = cells[lanes, crew]
            row += [f"{statistics.median(rates):.0f}", f"{max(peaks) / 2**20:.0f} MiB"]
        print(f"| {lanes} | " + " | ".join(row) + " |")


def train(options, lanes, cores, updates):
    """Seconds and peak memory in bytes of a fleet that makes so many updates in every lane."""
    with tempfile.TemporaryDirectory() as folder:
        command = [options.ted, "train", options.dataset, "--preset", "true", "--seeds", f"0..{lanes}", "--out", folder, "--json"]
        for field in [f"algorithm.steps={updates}", "schedule.evaluation_episodes=0"]:
            command += ["--set", field]
        begun = time.monotonic()
        child = subprocess.Popen(
            command,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.PIPE,
            preexec_fn=lambda: os.sched_setaffinity(0, cores),
        )
        said = child.stderr.read()
        _, status, usage = os.wait4(child.pid, 0)
        took = time.monotonic() - begun
        if status:
            sys.exit(f"{' '.join(command)} failed:\n{said.decode(errors='replace')}")
        return took, usage.ru_maxrss * (1 if sys.platform == "darwin" else 1024)


if __name__ == "__main__":
    main()
