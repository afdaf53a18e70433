"""Lets the trainers take turns and prints medians of the time of an update, and ratios taken within a round."""

import argparse
import statistics
import subprocess
import sys
from pathlib import Path

HERE = Path(__file__).parent


class Trainer:
    """A process that answers a number of updates with the seconds they took; `seeds` learn side by side in it."""

    def __init__(self, name, seeds, command):
        self.name, self.seeds = name, seeds
        self.process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)

    def turn(self, updates):
        """Milliseconds of one update of one seed."""
        print(updates, file=self.process.stdin, flush=True)
        answer = self.process.stdout.readline()
        if not answer:
            raise SystemExit(f"train peers: {self.name} ended with {self.process.wait()}: see above")
        return float(answer) / updates / self.seeds * 1e3


def main():
    arguments = argparse.ArgumentParser(description=__doc__)
    arguments.add_argument("turns", help="the program that serves turns of ted-train")
    arguments.add_argument("--rounds", type=int, default=9)
    arguments.add_argument("--updates", type=int, default=200, help="in a turn")
    arguments = arguments.parse_args()

    python = lambda script, *rest: [sys.executable, str(HERE / script), *rest]
    ours = lambda *rest: [arguments.turns, *rest]
    jax, torch = "JAX, jitted scan", "PyTorch, 2 threads"
    trainers = [
        Trainer("ted fused, one learner, 2 threads", 1, ours("fused", "1", "2")),
        Trainer(jax, 1, python("jax_iql.py", "1")),
        Trainer("ted fused, two learners, 2 threads", 2, ours("fused", "2", "1")),
        Trainer("JAX, jitted scan, two seeds by vmap", 2, python("jax_iql.py", "2")),
        Trainer("ted fused, one learner, 1 thread", 1, ours("fused", "1", "1")),
        Trainer(torch, 1, python("torch_iql.py", "2")),
        Trainer("ted flex, one learner, 2 threads", 1, ours("flex", "1", "2")),
    ]
    for trainer in trainers:
        trainer.turn(arguments.updates)
    rounds = [{t.name: t.turn(arguments.updates) for t in trainers} for _ in range(arguments.rounds)]
    median = lambda values: statistics.median(list(values))
    print("| trainer | median of an update | of JAX | of PyTorch |\n|---|---:|---:|---:|")
    for name in (t.name for t in trainers):
        of = lambda peer: median(r[name] / r[peer] for r in rounds)
        print(f"| {name} | {median(r[name] for r in rounds):.3f} ms | {of(jax):.2f} | {of(torch):.2f} |")
    for trainer in trainers:
        trainer.process.stdin.close()
        trainer.process.wait()


main()
