#!/usr/bin/env python3
"""Renders a list of jobs on a Ray cluster: every shard of the list is a task that runs `anamorph batch`.

    ray_driver.py JOBS [--shards N] [--anamorph PATH] [--address HOST:PORT] [--cpus C] [--gpus G]
                  [--resources '{"name": 1}'] [--retries R] [--csv T.csv] [--report R.json]

The list, its scenes and the folders of its outputs lie where all nodes see them, under one path. A task whose worker or node
is lost is submitted again, at most R times, and goes on where the manifest of its shard ends; frames that fail are told in
the end. Then the manifests of all shards are gathered into that of the list. Exit codes are those of `anamorph batch`: 0 all
is done, 1 some frames are not, 2 the list is wrong.

Written by `anamorph batch --write-driver`; needs `pip install ray`.
"""

import argparse
import ctypes
import json
import os
import signal
import subprocess
import sys
import time

import ray


class Lost(Exception):
    """The program was ended from outside."""


def with_parent():
    """Lets the program end with the worker that runs it, so that it holds no manifest any more (Linux)."""
    if sys.platform == "linux":
        set_death_signal = 1
        ctypes.CDLL(None).prctl(set_death_signal, signal.SIGKILL)


def shard(program, jobs, index, count):
    """Renders one shard: its exit code, the counts of its last line, and what it said on stderr."""
    command = [program, "batch", jobs, "--shard", f"{index}/{count}", "--resume", "--progress", "json"]
    gpus = ray.get_gpu_ids()
    if gpus:
        # Vulkan takes no notice of CUDA_VISIBLE_DEVICES; the numbers of a node's GPUs stand for its adapters'
        command += ["--adapters", ",".join(str(gpu) for gpu in gpus)]
    process = subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, preexec_fn=with_parent
    )
    out, err = process.communicate()
    if process.returncode not in (0, 1, 2):
        raise Lost(f"shard {index}/{count}: ended by {process.returncode}")
    events = [json.loads(line) for line in out.splitlines()]
    ends = [event for event in events if event["event"] == "end"]
    return {"code": process.returncode, "counts": ends[-1] if ends else {}, "err": err}


def parse():
    parser = argparse.ArgumentParser(description="Renders a list of jobs on a Ray cluster.")
    parser.add_argument("jobs", help="list of jobs, as `anamorph batch` takes it")
    parser.add_argument("--shards", type=int, help="parts of the list [default: two a node]")
    parser.add_argument("--anamorph", default="anamorph", help="the program, under this path on all nodes")
    parser.add_argument("--address", default="auto", help="of the cluster [default: the one that runs here]")
    parser.add_argument("--cpus", type=float, default=1, help="cores that a shard needs")
    parser.add_argument("--gpus", type=float, default=0, help="GPUs that a shard needs")
    parser.add_argument("--resources", type=json.loads, default={}, help="other resources that a shard needs, JSON")
    parser.add_argument("--retries", type=int, default=3, help="how often a lost shard is submitted again")
    parser.add_argument("--csv", help="table of all frames")
    parser.add_argument("--report", help="report of all frames")
    return parser.parse_args()


def main():
    args = parse()
    ray.init(address=args.address, log_to_driver=False)
    jobs = os.path.abspath(args.jobs)
    nodes = [node for node in ray.nodes() if node["Alive"]]
    count = args.shards or 2 * len(nodes)
    task = ray.remote(shard).options(
        num_cpus=args.cpus,
        num_gpus=args.gpus,
        resources=args.resources,
        max_retries=args.retries,
        retry_exceptions=[Lost],
        scheduling_strategy="SPREAD",
    )
    shards = {task.remote(args.anamorph, jobs, index, count): index for index in range(1, count + 1)}
    waiting, began, worst = list(shards), time.monotonic(), 0
    while waiting:
        ready, waiting = ray.wait(waiting, num_returns=1)
        for done in ready:
            name = f"shard {shards[done]}/{count}"
            try:
                result = ray.get(done)
            except ray.exceptions.RayError as error:
                print(f"error: {name}: {' '.join(str(error).split())}", file=sys.stderr)
                worst = max(worst, 1)
                continue
            worst = max(worst, result["code"])
            sys.stderr.write(result["err"])
            counts = result["counts"]
            told = ", ".join(f"{counts.get(key, 0)} {key}" for key in ("done", "skipped", "failed"))
            print(f"{name}: {told} after {time.monotonic() - began:.1f} s", flush=True)
    if worst == 2:
        return 2
    command = [args.anamorph, "batch", jobs, "--gather"]
    command += ["--csv", args.csv] if args.csv else []
    command += ["--report", args.report] if args.report else []
    return subprocess.run(command, check=False).returncode


if __name__ == "__main__":
    sys.exit(main())
