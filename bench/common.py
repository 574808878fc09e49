"""What the files of the benchmark share: running programs, figures with their targets, tables."""

import json
import os
import platform
import re
import resource
import subprocess
import tempfile
import time


# A lattice stuffer with optimisation, tets per CPU second: a figure from the literature, not measured here.
STUFFER_RATE = 1e4


def resident_peak(pid):
    """Most bytes that a running process had resident so far; 0 when the system does not say."""
    try:
        with open(f"/proc/{pid}/status") as file:
            found = re.search(r"^VmHWM:\s*(\d+) kB", file.read(), re.M)
    except OSError:
        return 0
    return 1024 * int(found[1]) if found else 0


class Run:
    """A child process: exit code (None: timed out), CPU and wall seconds, most bytes, output."""

    def __init__(self, command, folder=None, timeout=1200):
        with tempfile.TemporaryFile() as out, tempfile.TemporaryFile() as err:
            start = time.monotonic()
            child = subprocess.Popen(command, stdout=out, stderr=err, cwd=folder)
            expired, seen = False, 0
            while True:
                seen = resident_peak(child.pid) or seen
                pid, status, usage = os.wait4(child.pid, os.WNOHANG)
                if pid:
                    break
                if time.monotonic() - start > timeout and not expired:
                    expired = True
                    child.kill()
                time.sleep(0.002)
            child.returncode = os.waitstatus_to_exitcode(status)
            self.wall = time.monotonic() - start
            self.code = None if expired else child.returncode
            self.cpu = usage.ru_utime + usage.ru_stime
            # The system counts what this process held when it forked as the child's: then what was seen of the child is nearer.
            own = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
            self.peak = seen if seen and usage.ru_maxrss <= own else usage.ru_maxrss * 1024
            out.seek(0)
            err.seek(0)
            self.out = out.read().decode(errors="replace")
            self.err = err.read().decode(errors="replace")


def figure(name, value, target, met):
    """One promised figure. met None: told for information, no target."""
    return {"name": name, "value": value, "target": target, "met": met}


def last_sentence(text):
    lines = [line for line in text.strip().splitlines() if line.startswith("laves: ")]
    return lines[-1][len("laves: "):] if lines else ""


def mesh_facts(run, json_path):
    """What `laves mesh --json` told, or None when it made no mesh."""
    if run.code not in (0, 3):
        return None
    with open(json_path) as file:
        return json.load(file)


def table(header, rows):
    align = ["---" if i == 0 else "---:" for i in range(len(header))]
    lines = ["| " + " | ".join(cells) + " |" for cells in [header, *rows]]
    return "\n".join([lines[0], "|" + "|".join(align) + "|", *lines[1:]])


def machine():
    """Processor, cores, memory, system and compiler in one line each."""
    cpu, memory = platform.processor() or platform.machine(), ""
    try:
        with open("/proc/cpuinfo") as file:
            cpu = next((line.split(":", 1)[1].strip() for line in file if line.startswith("model name")), cpu)
        memory = f"{os.sysconf('SC_PAGE_SIZE') * os.sysconf('SC_PHYS_PAGES') / 2**30:.0f} GiB"
    except (OSError, ValueError):
        pass
    return f"{cpu}, {os.cpu_count()} cores, {memory}, {platform.system()}"
