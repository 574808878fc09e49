#!/usr/bin/env python3
"""Runs the program by example.

    tests/cli/run.py --program build/laves [--renew] tests/cli/*.case

A case is a text file; its steps run in one empty folder, where `laves` is the program. Lines:

    # comment
    file NAME           makes a file of the lines that follow and begin with '| '
    env NAME=VALUE      for all steps that follow
    $ COMMAND           a step, run by sh
    exit N              its exit code (0 when not said); several: one of them; -N: ended by signal N
    signal INT 0.3      sent to it after so many seconds, if it still runs; a second line: so long after the first
    tty [COLUMNS]       its stderr is a terminal
    out GLOB, err GLOB  its stdout and stderr, line by line, blank lines apart; a line '...' stands
                        for any lines. None: not looked at. 'out' or 'err' alone says that it is empty
    json FILE NAME [OP VALUE]  a member such as seconds.total of its JSON ('-': stdout) is there, and compares:
                        == >= <= with JSON values, ~ with a GLOB
    files NAME...       all files in the folder afterwards, sorted
    same A B            two files have the same bytes
    narrow N GLOB       lines of stderr that match, and there are some, have N columns at most; their escape sequences have none

--renew rewrites the exit, out and err lines of steps that fail by what the program does now; read the difference.
"""
import argparse
import fcntl
import fnmatch
import json
import os
import pty
import re
import shutil
import signal
import struct
import subprocess
import sys
import tempfile
import termios
import threading
import time

SECONDS_AT_MOST = 120
SKIPPED = 77  # exit code that CTest knows


class Step:
    """A command and what is expected of it; `line` is where it stands in the case."""

    def __init__(self, command, line):
        self.command = command
        self.line = line
        self.exit = [0]
        self.out = None
        self.err = None
        self.signals = []
        self.tty = False
        self.columns = 0
        self.checks = []
        self.last_line = line


def parse(text):
    """Returns the list of what to do: ('file', name, lines), ('env', name, value) or ('step', Step)."""
    actions, step, body = [], None, None
    for number, line in enumerate(text.splitlines()):
        if line.startswith("| ") or line == "|":
            body.append(line[2:])
            continue
        word, _, rest = line.partition(" ")
        if not line.strip() or line.startswith("#"):
            continue
        if word == "file":
            body = []
            actions.append(("file", rest, body))
        elif word == "env":
            actions.append(("env", *rest.split("=", 1)))
        elif word == "$":
            step = Step(rest, number)
            actions.append(("step", step))
        elif word == "exit":
            step.exit = [int(code) for code in rest.split()]
        elif word == "signal":
            name, delay = rest.split()
            step.signals.append((getattr(signal, "SIG" + name), float(delay)))
        elif word == "tty":
            step.tty = True
            step.columns = int(rest or 0)
        elif word in ("out", "err"):
            lines = getattr(step, word) or []
            setattr(step, word, lines + [rest] if rest else lines)
        elif word in ("json", "files", "same", "narrow"):
            step.checks.append((word, rest))
        else:
            raise SystemExit(f"line {number + 1}: unknown word '{word}'")
        if step:
            step.last_line = number
    return actions


def matches(patterns, lines):
    """Whether globs match lines in order; '...' stands for any number of lines. Brackets are plain characters."""
    if not patterns:
        return not lines
    if patterns[0] == "...":
        return any(matches(patterns[1:], lines[i:]) for i in range(len(lines) + 1))
    glob = patterns[0].replace("[", "[[]")
    return bool(lines) and fnmatch.fnmatchcase(lines[0], glob) and matches(patterns[1:], lines[1:])


def written_lines(text):
    """The lines of a text without the blank ones."""
    return [line for line in text.splitlines() if line.strip()]


def terminals_exist():
    try:
        for end in pty.openpty():
            os.close(end)
        return True
    except OSError:
        return False


def read_terminal(master, chunks):
    while True:
        try:
            chunk = os.read(master, 65536)
        except OSError:
            return
        if not chunk:
            return
        chunks.append(chunk)


def run(step, folder, environment):
    """Returns exit code, stdout, stderr."""
    master, slave = pty.openpty() if step.tty else (None, subprocess.PIPE)
    if step.columns:
        fcntl.ioctl(slave, termios.TIOCSWINSZ, struct.pack("4H", 24, step.columns, 0, 0))
    process = subprocess.Popen(["sh", "-c", "exec " + step.command if step.signals else step.command], cwd=folder,
                               env=environment, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=slave)
    chunks = []
    if step.tty:
        os.close(slave)
        reader = threading.Thread(target=read_terminal, args=(master, chunks))
        reader.start()
    for number, delay in step.signals:
        time.sleep(delay)
        process.send_signal(number)
    try:
        out, err = process.communicate(timeout=SECONDS_AT_MOST)
    except subprocess.TimeoutExpired:
        process.kill()
        out, err = process.communicate()
        err = (err or b"") + b"\nstopped by the test: too slow\n"
    if step.tty:
        reader.join()
        os.close(master)
        err = b"".join(chunks)
    return process.returncode, out.decode(errors="replace"), err.decode(errors="replace")


def check_json(words, out, folder):
    name, path, *comparison = words.split(" ", 3)
    try:
        text = out if name == "-" else open(os.path.join(folder, name), encoding="utf-8").read()
        value = json.loads(text)
    except (OSError, ValueError) as error:
        return f"json {name}: {error}"
    for key in path.split("."):
        try:
            value = value[int(key) if isinstance(value, list) else key]
        except (KeyError, IndexError, TypeError, ValueError):
            return f"json {name}: there is no {path}"
    if not comparison:
        return None
    operator, wanted = comparison
    if operator == "~":
        right = fnmatch.fnmatchcase(str(value), wanted.replace("[", "[[]"))
    else:
        wanted = json.loads(wanted)
        right = {"==": lambda: value == wanted, ">=": lambda: value >= wanted, "<=": lambda: value <= wanted}[operator]()
    return None if right else f"json {name}: {path} is {value!r}, not {operator} {wanted!r}"


def check_narrow(words, err):
    columns, glob = words.split(" ", 1)
    lines = [re.sub(r"\x1b\[[0-9;]*[A-Za-z]", "", line) for line in err.splitlines()]
    lines = [line for line in lines if fnmatch.fnmatchcase(line, glob)]
    if not lines:
        return f"narrow: no line is like {glob}"
    widest = max(lines, key=len)
    return f"narrow: {len(widest)} columns: {widest}" if len(widest) > int(columns) else None


def check(kind, words, out, err, folder):
    """Returns what is wrong, or None."""
    if kind == "narrow":
        return check_narrow(words, err)
    if kind == "json":
        return check_json(words, out, folder)
    if kind == "files":
        there, wanted = sorted(os.listdir(folder)), sorted(words.split())
        return None if there == wanted else f"files: {' '.join(there)}"
    a, b = (open(os.path.join(folder, name), "rb").read() for name in words.split())
    return None if a == b else f"{words}: not the same bytes"


def judge(step, code, out, err, folder):
    """Returns the list of what is wrong."""
    wrong = []
    if code not in step.exit:
        wrong.append(f"exit code {code}, not {' or '.join(map(str, step.exit))}")
    for name, patterns, text in (("out", step.out, out), ("err", step.err, err)):
        if patterns is not None and not matches(patterns, written_lines(text)):
            wrong.append(f"std{name} differs from the lines wanted")
    wrong += [fault for fault in (check(kind, words, out, err, folder) for kind, words in step.checks) if fault]
    return wrong


def renewed(lines, step, code, out, err):
    """The lines of a step with what the program did now."""
    body = [line for line in lines[step.line + 1:step.last_line + 1] if not re.match(r"(exit|out|err)( |$)", line)]
    result = [lines[step.line]] + ([f"exit {code}"] if code else [])
    for name, patterns, text in (("out", step.out, out), ("err", step.err, err)):
        if patterns is not None:
            result += [f"{name} {line}" for line in written_lines(text)] or [name]
    return result + body


def run_case(path, program, renew):
    """Returns whether every step did what is wanted."""
    with open(path, encoding="utf-8") as file:
        text = file.read()
    if not terminals_exist() and any(kind == "step" and rest[0].tty for kind, *rest in parse(text)):
        print(f"{path}: skipped, for no terminal can be made here (/dev/pts is not mounted)")
        sys.exit(SKIPPED)
    lines, changes, right = text.splitlines(), [], True
    folder, tools = tempfile.mkdtemp(prefix="laves-cli-"), tempfile.mkdtemp(prefix="laves-bin-")
    os.symlink(os.path.abspath(program), os.path.join(tools, "laves"))
    environment = dict(os.environ, PATH=tools + os.pathsep + os.environ["PATH"], LC_ALL="C.UTF-8", TERM="dumb")
    environment["SOURCE"] = os.path.abspath(os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", ".."))
    environment.pop("NO_COLOR", None)
    try:
        for kind, *rest in parse(text):
            if kind == "file":
                with open(os.path.join(folder, rest[0]), "w", encoding="utf-8") as file:
                    file.write("".join(line + "\n" for line in rest[1]))
            elif kind == "env":
                environment[rest[0]] = rest[1]
            else:
                step = rest[0]
                code, out, err = run(step, folder, environment)
                wrong = judge(step, code, out, err, folder)
                if wrong and renew:
                    changes.append((step, renewed(lines, step, code, out, err)))
                elif wrong:
                    right = False
                    print(f"{path}:{step.line + 1}: {step.command}")
                    print("".join(f"  {fault}\n" for fault in wrong) + f"--- stdout\n{out}--- stderr\n{err}---")
    finally:
        shutil.rmtree(folder)
        shutil.rmtree(tools)
    for step, body in reversed(changes):
        lines[step.line:step.last_line + 1] = body
    if changes:
        with open(path, "w", encoding="utf-8") as file:
            file.write("\n".join(lines) + "\n")
    return right


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("--program", required=True)
    arguments.add_argument("--renew", action="store_true")
    arguments.add_argument("cases", nargs="+")
    given = arguments.parse_args()
    failed = [case for case in given.cases if not run_case(case, given.program, given.renew)]
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
