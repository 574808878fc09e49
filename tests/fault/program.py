#!/usr/bin/env python3
"""The program on failing machines.

    tests/fault/program.py --program build/laves --preload build/tests/libfault_preload.so [--every]

Each command runs with its n-th allocation failing, alone and with all that follow; then with files that may not grow beyond n
bytes; then on a full disk, where one can be mounted. Each time it must end with the exit code of docs/errors.md and a sentence, or
do the very same as ever, leave the older files as they were where it fails to write, and no others.

The quick run takes some n of each; --every, or LAVES_EVERY=1, takes all.
"""
import argparse
import os
import resource
import shutil
import subprocess
import sys
import tempfile

QUICK_RUNS = 14
SECONDS_AT_MOST = 60
MISSED, MEMORY, WRITE = 3, 4, 5

OFF = "OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n"

# What is run, and what it writes.
COMMANDS = [
    (["tiling", "--cells", "1", "-o", "out.vtu", "--json", "out.json"], ["out.vtu", "out.json"]),
    (["mesh", "in.off", "--size", "0.3", "-o", "out.msh", "--boundary", "skin.ply", "--json", "out.json", "--refine",
      "curve:curve.txt=0.2", "--features", "line.txt"], ["out.msh", "skin.ply", "out.json", "out.certificate.json"]),
    (["mesh", "sphere(1)", "--size", "0.6", "-o", "out.node", "--certificate", "none"], ["out.node", "out.ele", "out.face"]),
    (["mesh", "--job", "job.toml", "--threads", "1"], ["out.msh", "out.cert"]),
    (["mesh", "--job", "in.json", "-o", "out.msh", "--certificate", "out.cert"], ["out.msh", "out.cert"]),
    (["check", "in.vtu", "--surface", "in.off", "--features", "--json", "out.json", "--write-certificate", "out.cert"],
     ["out.json", "out.cert"]),
    (["view", "in.vtu", "-o", "out.png", "--size", "64x64", "--creases", "2", "--cut", "x"], ["out.png"]),
    (["info", "in.off", "--json", "out.json"], ["out.json"]),
    # Without --surface: that thin places, or samples of an implicit solid, are missing for want of memory, the library does not tell.
    (["report", "in.vtu", "-o", "out.html"], ["out.html"]),
    (["report", "in.vtu", "-o", "out.html", "--whole", "1", "--json", "out.json"], ["out.html", "out.json"]),
]


class Place:
    """A folder with the inputs, and older files at the places of all outputs."""

    def __init__(self, program):
        self.folder = tempfile.mkdtemp(prefix="laves-fault-")
        self.program = os.path.abspath(program)
        self.put("in.off", OFF)
        self.put("curve.txt", "0 0 0\n0.5 0.5 0\n")
        self.put("line.txt", "0.1 0.1 0\n0.3 0.2 0\n")
        self.put("job.toml", 'input = "in.off"\nsize = 0.3\n[mesh]\noutput = ["out.msh"]\ncertificate = "out.cert"\n')
        subprocess.run([self.program, "mesh", "in.off", "--size", "0.3", "-q", "-o", "in.vtu", "--certificate", "in.json"],
                       cwd=self.folder, check=True)
        self.inputs = sorted(os.listdir(self.folder))

    def put(self, name, text):
        with open(os.path.join(self.folder, name), "w", encoding="utf-8") as file:
            file.write(text)

    def content(self, name):
        with open(os.path.join(self.folder, name), "rb") as file:
            return file.read()

    def run(self, words, environment=None, prepare=None):
        process = subprocess.run([self.program] + words, cwd=self.folder,
                                 env=dict(os.environ, LC_ALL="C", **(environment or {})), preexec_fn=prepare,
                                 stdin=subprocess.DEVNULL, capture_output=True, timeout=SECONDS_AT_MOST, check=False)
        return process.returncode, process.stderr.decode(errors="replace")

    def renew(self, written):
        for name in written:
            self.put(name, "older\n")

    def strangers(self, written):
        return sorted(set(os.listdir(self.folder)) - set(self.inputs) - set(written))


def comparable(name, data):
    """JSON holds times."""
    return b"" if name == "out.json" else data


def judge(place, words, written, whole, run, wanted):
    """Returns what is wrong with a run, or None. `whole`: the contents after a run in which nothing fails."""
    code, err = run
    if place.strangers(written):
        return f"left behind: {' '.join(place.strangers(written))}"
    contents = {name: place.content(name) for name in written}
    old = [name for name in written if contents[name] == b"older\n"]
    half = [name for name in written if name not in old and comparable(name, contents[name]) != comparable(name, whole[name])]
    half += [name for name in written if name == "out.json" and name not in old and not contents[name].endswith(b"}\n")]
    if half:
        return f"half or wrong: {' '.join(half)}"
    if code in (0, MISSED):
        return f"success without {' '.join(old)}" if old else None
    if code not in wanted:
        return f"exit code {code}"
    if "laves: error: " not in err:
        return f"exit code {code} without a sentence"
    return None


def report(words, what, fault, run):
    print(f"laves {' '.join(words)}: {what}: {fault}\n  exit code {run[0]}: {run[1].strip()}")


def steps(count, every):
    stride = 1 if every else 1 + count // QUICK_RUNS
    return range(0, count, stride)


def fail_allocations(place, preload, words, written, whole, every):
    count_file = os.path.join(place.folder, "count")
    place.run(words, {"LD_PRELOAD": preload, "FAULT_COUNT": count_file})
    count = int(place.content("count"))
    os.remove(count_file)
    wrong = 0
    for mode in ({}, {"FAULT_FOR_GOOD": "1"}):
        for n in steps(count, every):
            place.renew(written)
            run = place.run(words, {"LD_PRELOAD": preload, "FAULT_AT": str(n + 1), **mode})
            fault = judge(place, words, written, whole, run, (MEMORY, WRITE) if mode else (MEMORY,))
            if fault:
                wrong += 1
                report(words, f"allocation {n + 1} of {count}{' and all that follow' if mode else ''} fails", fault, run)
    print(f"{words[0]}: {count} allocations, {wrong} wrong")
    return wrong


def fail_growth(place, words, written, whole, every):
    """RLIMIT_FSIZE: the system cuts a write short at n bytes, refuses the next and sends SIGXFSZ."""
    largest, wrong = max(len(data) for data in whole.values()), 0
    for n in steps(largest, every):
        place.renew(written)
        run = place.run(words, prepare=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (n, n)))
        fault = judge(place, words, written, whole, run, (WRITE,))
        if not fault and run[0] in (0, MISSED):
            fault = "success"
        if fault and not (fault == "success" and n >= largest - 64):
            wrong += 1
            report(words, f"files of {n} bytes at most", fault, run)
    print(f"{words[0]}: up to {largest} bytes, {wrong} wrong")
    return wrong


def fill_disk(program):
    """A file system of 64 KiB in memory, full but for some bytes. Returns how many runs went wrong, or None."""
    folder = tempfile.mkdtemp(prefix="laves-disk-")
    mount = subprocess.run(["mount", "-t", "tmpfs", "-o", "size=64k", "laves-test", folder], capture_output=True, check=False)
    if mount.returncode != 0:
        os.rmdir(folder)
        return None
    wrong = 0
    try:
        for words, names in ((["tiling", "--cells", "4", "-o", folder + "/a.vtu", "--compress", "0"], ["a.vtu"]),
                             (["tiling", "--cells", "4", "-o", folder + "/a.node"], ["a.node"]),
                             (["tiling", "--cells", "1", "--json", folder + "/a.json"], ["a.json"])):
            for name in names + ["filler"]:
                with open(os.path.join(folder, name), "wb") as file:
                    file.write(b"older\n")
            if words[-2] == "--json":
                with open(os.path.join(folder, "filler"), "wb") as file:
                    file.write(bytes(60 * 1024))
            process = subprocess.run([program] + words, capture_output=True, check=False)
            err = process.stderr.decode(errors="replace")
            left = sorted(os.listdir(folder))
            older = all(open(os.path.join(folder, name), "rb").read() == b"older\n" for name in names)
            if process.returncode != WRITE or "No space left" not in err or left != sorted(names + ["filler"]) or not older:
                wrong += 1
                report(words, "the disk is full", f"left: {' '.join(left)}", (process.returncode, err))
            for name in left:
                os.remove(os.path.join(folder, name))
    finally:
        subprocess.run(["umount", folder], check=False)
        os.rmdir(folder)
    return wrong


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("--program", required=True)
    arguments.add_argument("--preload", help="where it is missing, no allocation fails")
    arguments.add_argument("--every", action="store_true")
    given = arguments.parse_args()
    os.sched_setaffinity(0, list(os.sched_getaffinity(0))[:1])  # one thread, so that the calls come in the same order each time
    every = given.every or bool(os.environ.get("LAVES_EVERY"))
    place, wrong = Place(given.program), 0
    try:
        for words, written in COMMANDS:
            code, err = place.run(words)
            if code not in (0, MISSED):
                report(words, "nothing fails", "no success", (code, err))
                wrong += 1
                continue
            whole = {name: place.content(name) for name in written}
            if given.preload:
                wrong += fail_allocations(place, os.path.abspath(given.preload), words, written, whole, every)
            wrong += fail_growth(place, words, written, whole, every)
            for name in written:
                os.remove(os.path.join(place.folder, name))
    finally:
        shutil.rmtree(place.folder)
    full = fill_disk(os.path.abspath(given.program))
    print("no disk in memory can be mounted here, so a full disk was not tried" if full is None else f"full disk: {full} wrong")
    return 1 if wrong or full else 0


if __name__ == "__main__":
    sys.exit(main())
