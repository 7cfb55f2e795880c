#!/usr/bin/env python3
"""Renders a list of jobs on a Ray cluster: every shard of the list is a task that runs `anamorph batch`.

    ray_driver.py JOBS [--shards N] [--anamorph PATH] [--address HOST:PORT] [--cpus C] [--gpus G]
                  [--resources '{"name": 1}'] [--retries R] [--progress json] [--csv T.csv] [--report R.json]

Without --address it uses the cluster that runs here, or else this machine alone, as with `--address local`.

The list, its scenes and the folders of its outputs lie where all nodes see them, under one path. A task whose worker or node
is lost is submitted again, at most R times, and goes on where the manifest of its shard ends; frames that fail are told in
the end. Then the manifests of all shards are gathered into that of the list. Exit codes are those of `anamorph batch`: 0 all
is done, 1 some frames are not, 2 the list is wrong.

Written by `anamorph batch --write-driver`; needs `pip install ray`.
"""

import argparse
import ctypes
import json
import logging
import os
import signal
import subprocess
import sys
import tempfile
import time

try:
    import ray
except ImportError:
    sys.exit("error: Ray is not installed; pip install ray")

# Seconds between two looks at what the shards tell, and between two lines of progress.
LOOK_S = 0.5
LINE_S = 5


class Lost(Exception):
    """The program was ended from outside."""


class Board:
    """An actor that holds the events of all shards until the driver takes them."""

    def __init__(self):
        self.events = []

    def tell(self, index, events):
        self.events += [(index, event) for event in events]

    def take(self):
        events, self.events = self.events, []
        return events


def with_parent():
    """Lets the program end with the worker that runs it, so that it holds no manifest any more (Linux)."""
    if sys.platform == "linux":
        set_death_signal = 1
        ctypes.CDLL(None).prctl(set_death_signal, signal.SIGKILL)


def passed_on(lines, tell):
    """Passes events on, at most one message each LOOK_S; returns the last event."""
    waiting, told, last = [], 0.0, {}
    for line in lines:
        if not line.endswith("\n"):
            # the program was killed in the middle of a line
            break
        last = json.loads(line)
        waiting.append(last)
        if time.monotonic() - told >= LOOK_S:
            tell(waiting)
            waiting, told = [], time.monotonic()
    tell(waiting)
    return last


def shard(program, jobs, index, count, board):
    """Renders one shard: its exit code, its last event, and what it said on stderr."""
    command = [program, "batch", jobs, "--shard", f"{index}/{count}", "--resume", "--progress", "json"]
    gpus = ray.get_gpu_ids()
    if gpus:
        # Vulkan takes no notice of CUDA_VISIBLE_DEVICES; the numbers of a node's GPUs stand for its adapters'
        command += ["--adapters", ",".join(str(gpu) for gpu in gpus)]
    with tempfile.TemporaryFile("w+") as err:
        process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=err, text=True, preexec_fn=with_parent)

        def tell(events):
            # a board that is lost with its node costs events, not frames
            ray.wait([board.tell.remote(index, events)], timeout=LINE_S)

        last = passed_on(process.stdout, tell)
        code = process.wait()
        err.seek(0)
        said = err.read()
    if code not in (0, 1, 2):
        raise Lost(f"shard {index}/{count}: ended by {code}")
    return {"code": code, "counts": last if last.get("event") == "end" else {}, "err": said}


def parse():
    parser = argparse.ArgumentParser(description="Renders a list of jobs on a Ray cluster.")
    parser.add_argument("jobs", help="list of jobs, as `anamorph batch` takes it")
    parser.add_argument("--shards", type=int, help="parts of the list [default: two a node]")
    parser.add_argument("--anamorph", default="anamorph", help="the program, under this path on all nodes")
    parser.add_argument("--address", help="of the cluster; `local`: none [default: the one that runs here, else none]")
    parser.add_argument("--cpus", type=float, default=1, help="cores that a shard needs")
    parser.add_argument("--gpus", type=float, default=0, help="GPUs that a shard needs")
    parser.add_argument("--resources", type=json.loads, default={}, help="other resources that a shard needs, JSON")
    parser.add_argument("--retries", type=int, default=3, help="how often a lost shard is submitted again")
    parser.add_argument("--progress", choices=["auto", "json"], default="auto", help="`json`: a line an event on stdout")
    parser.add_argument("--csv", help="table of all frames")
    parser.add_argument("--report", help="report of all frames")
    return parser.parse_args()


def connect(address):
    """Joins the cluster of this address; without one that which runs here, or else one of this machine alone."""
    quiet = {"log_to_driver": False, "logging_level": logging.ERROR}
    try:
        ray.init(address=address or "auto", **quiet)
    except (ConnectionError, ValueError, RuntimeError) as error:
        if address:
            sys.stderr.write(f"error: --address {address}: {' '.join(str(error).split())}\n")
            sys.exit(2)
        print("note: no Ray cluster runs here; this machine renders alone", file=sys.stderr, flush=True)
        ray.init(address="local", **quiet)


class Progress:
    """What the shards have told so far."""

    def __init__(self, count, is_json):
        self.count, self.is_json = count, is_json
        self.began, self.line_at = time.monotonic(), LINE_S
        # of each shard that has begun: its frames, and how many are done, skipped or failed
        self.frames, self.tried = {}, {}

    def add(self, index, event):
        kind = event["event"]
        if kind == "start":
            # a shard that was lost begins again
            self.frames[index], self.tried[index] = event["frames"], 0
        elif kind in ("done", "skipped", "failed"):
            self.tried[index] = self.tried.get(index, 0) + 1
        if self.is_json:
            print(json.dumps({"shard": index, **event}), flush=True)
        elif kind == "note":
            print(f"shard {index}/{self.count}: {event['text']}", file=sys.stderr, flush=True)

    def line(self):
        """Prints a line if one is due."""
        elapsed = time.monotonic() - self.began
        if self.is_json or elapsed < self.line_at:
            return
        self.line_at = elapsed + LINE_S
        frames, tried, begun = sum(self.frames.values()), sum(self.tried.values()), len(self.frames)
        shards = "" if begun == self.count else f" of {begun} of {self.count} shards"
        print(f"progress: {tried} of {frames} frames{shards}, {elapsed:.0f} s", file=sys.stderr, flush=True)


def take(board, progress):
    """Shows the events that the shards have told since the last call."""
    try:
        for index, event in ray.get(board.take.remote()):
            progress.add(index, event)
    except ray.exceptions.RayError:
        # it was lost with its node, and starts again empty
        pass
    progress.line()


def main():
    args = parse()
    connect(args.address)
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
    board = ray.remote(Board).options(num_cpus=0, max_restarts=-1).remote()
    progress = Progress(count, args.progress == "json")
    shards = {task.remote(args.anamorph, jobs, index, count, board): index for index in range(1, count + 1)}
    waiting, worst = list(shards), 0
    while waiting:
        ready, waiting = ray.wait(waiting, num_returns=1, timeout=LOOK_S)
        take(board, progress)
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
            if args.progress != "json":
                print(f"{name}: {told} after {time.monotonic() - progress.began:.1f} s", flush=True)
    if worst == 2:
        return 2
    command = [args.anamorph, "batch", jobs, "--gather"]
    command += ["--csv", args.csv] if args.csv else []
    command += ["--report", args.report] if args.report else []
    # stdout is for events alone
    return subprocess.run(command, check=False, stdout=sys.stderr if args.progress == "json" else None).returncode


if __name__ == "__main__":
    sys.exit(main())
