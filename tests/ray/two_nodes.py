"""Renders a list on a Ray cluster of two nodes on this machine, one of which is killed meanwhile.

    two_nodes.py DRIVER ANAMORPH JOBS

Prints how many shards were at work when the node was killed. Exits with the driver's code.
"""

import subprocess
import sys
import time
from pathlib import Path

from ray.cluster_utils import Cluster

driver, anamorph, jobs = sys.argv[1:]
cluster = Cluster(initialize_head=True, head_node_args={"num_cpus": 0})
nodes = [cluster.add_node(num_cpus=1) for _ in range(2)]
cluster.wait_for_nodes()
command = [sys.executable, driver, jobs, "--shards", "2", "--anamorph", anamorph, "--address", cluster.address]
process = subprocess.Popen(command + ["--csv", str(Path(jobs).with_suffix(".csv"))])


def begun():
    """Manifests of shards that hold a frame."""
    return [path for path in Path(jobs).parent.glob("*-of-2.manifest.jsonl") if path.stat().st_size > 0]


# each node is in the middle of its shard
until = time.monotonic() + 120
while len(begun()) < 2 and process.poll() is None and time.monotonic() < until:
    time.sleep(0.02)
at_work = len(begun()) if process.poll() is None else 0
cluster.remove_node(nodes[1], allow_graceful=False)
print(f"killed a node with {at_work} shards begun", flush=True)
code = process.wait()
cluster.shutdown()
sys.exit(code)
