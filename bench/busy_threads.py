#!/usr/bin/env python3
"""How many threads of a render are at work, told without having as many cores.

    bench/busy_threads.py --threads 1,2,4,8,16 -- build/release/abbe render scenes/prism/prism.scene --samples 64

Runs the command with each number of threads and looks every few milliseconds how many of them could run. While r of
them share c cores, each is as fast as min(1, c/r) of a core: a moment that took dt here takes min(1, c/r) dt where
there are cores for all. Printed are the seconds here, those predicted there, and the threads at work in the mean over
those, whose share of all threads is the efficiency. What the model leaves out are caches, memory and clock rates that
cores share, and pixels that many cores add to at once. Other work on the machine makes the predicted seconds longer,
not the threads at work.
"""
import argparse
import os
import subprocess
import sys
import time


def running(pid):
    """Threads of the process that run or wait for nothing but a core."""
    count = 0
    for thread in os.listdir(f"/proc/{pid}/task"):
        try:
            with open(f"/proc/{pid}/task/{thread}/stat") as file:
                count += file.read().rpartition(")")[2].split()[0] == "R"
        except OSError:  # it has ended
            pass
    return count


def watch(command, every):
    """Exit status, and pairs of seconds and of threads at work meanwhile."""
    looks = []
    with subprocess.Popen(command, stdout=subprocess.DEVNULL) as process:
        last = time.monotonic()
        while process.poll() is None:
            time.sleep(every)
            try:
                count = running(process.pid)
            except OSError:
                break
            now = time.monotonic()
            looks.append((now - last, max(1, count)))
            last = now
    return process.returncode, looks


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--threads", default="1,2,4,8,16", help="numbers of threads, with commas between")
    parser.add_argument("--every", type=float, default=0.005, help="seconds between looks")
    parser.add_argument("command", nargs="+", help="to which `--threads N` is added")
    options = parser.parse_args()
    cores = len(os.sched_getaffinity(0))
    print(f"{'threads':>7} {'seconds':>8} {'predicted':>9} {'at work':>8} {'share':>6}")
    for threads in map(int, options.threads.split(",")):
        status, looks = watch([*options.command, "--threads", str(threads)], options.every)
        if status != 0:
            sys.exit(f"busy_threads: the command ended with {status}")
        wall = sum(seconds for seconds, _ in looks)
        predicted = sum(seconds * min(1, cores / count) for seconds, count in looks)
        work = sum(seconds * min(1, cores / count) * min(count, threads) for seconds, count in looks)
        print(f"{threads:7} {wall:8.2f} {predicted:9.2f} {work / predicted:8.2f} {work / predicted / threads:6.0%}")


if __name__ == "__main__":
    main()
