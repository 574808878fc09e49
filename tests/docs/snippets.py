#!/usr/bin/env python3
"""Runs what the documents show: commands, scripts, fragments. docs/testing.md tells how, and which comments change it.

    tests/docs/snippets.py --program build/laves [--compiler cc --include FOLDER...] [PAGE...]
"""
import argparse
import ast
import doctest
import concurrent.futures
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
SECONDS_AT_MOST = 60
COARSE = ["--rel-size", "0.07"]  # of commands that ask for no size

# ---- inputs that pages speak of ----

PART = "box(10, 8, 6) - box(3, 2.5, 7)"
BLOB = "smooth_union(sphere(1), sphere(0.5):move(0.9, 0, 0.6), 0.3)"
DRAWN = "4 3 3\n\n-4 3 3\n4 3 3\n"  # a point and a line on the upper side of the part
OPEN_BOX = """ply
format ascii 1.0
element vertex 8
property float x
property float y
property float z
element face 5
property list uchar int vertex_indices
end_header
0 0 0\n1 0 0\n1 1 0\n0 1 0\n0 0 1\n1 0 1\n1 1 1\n0 1 1
4 3 2 1 0\n4 0 1 5 4\n4 1 2 6 5\n4 2 3 7 6\n4 3 0 4 7
"""
SIZES = "View \"size\" {\nSS(-9,-9,-9, 99,-9,-9, -9,99,-9, -9,-9,99){1, 2, 2, 2};\n};\n"
TEXTS = {
    "part.lua": f"return {PART}\n",
    "part.toml": f'input = "{PART}"\nrel-size = 0.07\n[mesh]\noutput = ["part.vtu"]\n',
    "scan.ply": OPEN_BOX,
    "drawn.txt": DRAWN,
    "seams.txt": DRAWN,
    "weld.txt": "0.4 0 0.2\n1.8 0 0.2\n",
    "size.pos": SIZES,
}
# What the surfaces of some names are made from; others are the part.
SURFACES = {"bunny.obj": BLOB}


def make_input(program, folder, name):
    """Makes a file that a command reads, where it is known how."""
    path, extension = folder / name, pathlib.Path(name).suffix.lower()
    if name in TEXTS:
        path.write_text(TEXTS[name])
    elif name == "bracket.stl":
        shutil.copyfile(ROOT / "demo" / "bracket.obj", path)  # what a surface file is, its content tells
    elif name == "valve.obj":
        path.write_text((ROOT / "demo" / "bracket.obj").read_text().replace("step", "seat"))
    elif extension in (".stl", ".obj", ".ply", ".off"):
        run(program, ["laves", "mesh", SURFACES.get(name, PART), *COARSE, "-q", "--certificate", "none", "-o", ".made.vtu",
                      "--boundary", name], folder)
    elif extension in (".vtu", ".msh", ".mesh", ".ele", ".inp"):
        run(program, ["laves", "mesh", PART, *COARSE, "-q", "--certificate", "none", "--compress", "0", "-o", name], folder)


OUTPUTS = {"-o", "--output", "--boundary", "--json", "--defects", "--write-certificate", "--report"}
FILE = re.compile(r"(?<![\w/.'-])([\w-]+(?:\.\d)?\.(?:stl|obj|ply|off|vtu|msh|mesh|ele|inp|lua|txt|pos))(?![\w/])")


def inputs_of(command):
    """Names of files in the folder that a command reads, or may."""
    words, found = command.split("#")[0].split(), []
    for before, word in zip([""] + words, words):
        if before not in OUTPUTS:
            found += FILE.findall(word) + [word] * (word in TEXTS)
    return found


# ---- pages ----


class Block:
    """A piece of a page that is not prose: its language ('' for indented ones), lines, and the comments above it."""

    def __init__(self, line, language, notes):
        self.line, self.language, self.notes, self.lines = line, language, notes, []

    def note(self, word):
        return [rest for kind, rest in self.notes if kind == word]


def blocks(text):
    found, block, notes, blank = [], None, [], True
    for number, line in enumerate(text.splitlines(), 1):
        fenced = block is not None and block.fenced
        note = re.match(r"<!-- test: (\w+)\s*(.*?) -->", line)
        if fenced and line.startswith("```"):
            block = None
        elif fenced:
            block.lines.append(line)
        elif line.startswith("```"):
            block = Block(number, line[3:].strip(), notes)
            block.fenced, notes = True, []
            found.append(block)
        elif line.startswith("    ") and (block is not None or blank):
            if block is None:
                block = Block(number, "", notes)
                block.fenced, notes = False, []
                found.append(block)
            block.lines.append(line[4:])
        else:
            block = None if line.strip() else block
            if note:
                notes = notes + [(note[1], note[2])]
        blank = not line.strip()
    return found


# ---- running ----


def environment(program, folder):
    tools = folder / ".bin"
    tools.mkdir(exist_ok=True)
    if not (tools / "laves").exists():
        (tools / "laves").symlink_to(program)
    return dict(os.environ, PATH=f"{tools}{os.pathsep}{os.environ['PATH']}", LC_ALL="C.UTF-8", TERM="dumb")


def run(program, words, folder):
    return subprocess.run(words, cwd=folder, env=environment(program, folder), capture_output=True, text=True,
                          timeout=SECONDS_AT_MOST, check=False)


SIZED = re.compile(r"--(size|rel-size|tets|vertices)\b")


# options.md is made by the program and has no comments.
REPLACED = {"options.md": [("500k", "5k"), ("--tets 1M", "--tets 5k"), ("0.05", "0.15"), ("1600x1200", "320x240")]}


def smaller(command, block, page):
    """The command as it is run: replaced where a comment says so, with few tetrahedra or pixels where it asks for no size."""
    for old, new in [rest.split() for rest in block.note("replace")] + REPLACED.get(page, []):
        command = command.replace(old, new)
    if command.startswith("laves mesh ") and "--job" not in command and not SIZED.search(command):
        command = command.replace("laves mesh ", f"laves mesh {' '.join(COARSE)} ", 1)
    if command.startswith("laves view ") and "--size" not in command:
        command = command.replace("laves view ", "laves view --size 320x240 ", 1)
    return command


VARYING = re.compile(r"\b[\d.]+ (?:ms|s|min|h|kB|MB|GB|bytes)\b")


def like(expected, line):
    return VARYING.sub("N", expected).split() == VARYING.sub("N", line).split()


def matches(expected, lines):
    if not expected:
        return not lines
    if expected[0].strip() == "...":
        return any(matches(expected[1:], lines[i:]) for i in range(len(lines) + 1))
    return bool(lines) and like(expected[0], lines[0]) and matches(expected[1:], lines[1:])


class Page:
    """Runs the blocks of one page in a folder of its own and collects what is wrong."""

    def __init__(self, path, options):
        self.path, self.options, self.faults, self.count = path, options, [], 0

    def fault(self, block, sentence):
        self.faults.append(f"{self.path.relative_to(ROOT)}:{block.line}: {sentence}")

    def command(self, block, command, exits, expected):
        self.count += 1
        for name in inputs_of(command):
            if not (self.folder / name).exists():
                make_input(self.options.program, self.folder, name)
        command = smaller(command, block, self.path.name)
        done = run(self.options.program, ["sh", "-c", command], self.folder)
        if str(done.returncode) not in exits:
            self.fault(block, f"{command}\nends with {done.returncode}, not {' or '.join(exits)}\n{done.stdout}{done.stderr}")
            return
        lines = [line for line in (done.stderr + done.stdout).splitlines() if line.strip()]
        wanted = [line for line in expected or [] if line.strip()]
        if expected is not None and not matches(wanted, lines):
            self.fault(block, f"{command}\nprints\n" + "\n".join(lines) + "\nnot\n" + "\n".join(wanted))

    def commands(self, block):
        """Lines 'laves ...' are run; what follows '$ laves ...' is its output."""
        steps = []
        for line in block.lines:
            if line.startswith("$ "):
                steps.append((line[2:], []))
            elif line.startswith("laves "):
                steps.append((line, None))
            elif steps and steps[-1][1] is not None:
                steps[-1][1].append(line)
        for i, (command, expected) in enumerate(steps):
            exits = (" ".join(block.note("exit")).split() if i == len(steps) - 1 else []) or ["0"]
            if command.startswith("laves "):
                self.command(block, command, exits, expected)

    def script(self, block):
        self.count += 1
        text = "\n".join(block.lines) + "\n"
        (self.folder / "snippet.lua").write_text(text)
        named = re.match(r"-- ([\w-]+\.lua)\n", text)
        if named:  # commands that follow take it by its name
            (self.folder / named.group(1)).write_text(text)
        words = ["laves", "mesh", "snippet.lua", *COARSE, "--features", "none"]
        if block.note("field"):
            words = ["laves", "mesh", "sphere(1)", "--size", "0.2", "--size-field", "snippet.lua"]
        done = run(self.options.program, [*words, "-q", "--certificate", "none", "-o", "snippet.vtu"], self.folder)
        if done.returncode not in (0, 3):
            self.fault(block, f"the script is no solid: {done.stderr}")

    def fragment(self, block):
        """C: a whole file, or statements that speak of the usual variables."""
        self.count += 1
        text = "\n".join(line for line in block.lines if line.strip() != "...") + "\n"
        if "int main(" not in text:
            usual = {"context": "laves_context *context", "domain": "laves_domain *domain", "options": "laves_options options",
                     "mesh": "laves_mesh *mesh", "report": "laves_report report", "error": "laves_error error", "count": "size_t count",
                     "tets": "int32_t tets[4 * ROOM]"}
            missing = [code for name, code in usual.items() if not re.search(rf"\b\w+ \*?{name}\s*[=;]", text)]
            text = ("#include <laves/laves.h>\n#include <stdio.h>\nenum { ROOM = 1000 };\nvoid fragment(void);\nvoid fragment(void) {\n" +
                    "".join(f"  static {code};\n" for code in missing) + text + "}\n")
        (self.folder / "fragment.c").write_text(text)
        includes = [word for folder in self.options.include for word in ("-I", folder)]
        done = run(self.options.program, [self.options.compiler, "-std=c11", "-Wall", "-Wno-unused", "-Werror", "-fsyntax-only", "-DLAVES_STATIC",
                                          *includes, "fragment.c"], self.folder)
        if done.returncode:
            self.fault(block, f"the fragment does not compile:\n{done.stderr}")

    def python(self, block):
        self.count += 1
        text = "\n".join(block.lines) + "\n"
        try:
            if text.startswith(">>> "):  # run by tests/python
                text = "".join(example.source for example in doctest.DocTestParser().get_examples(text))
            ast.parse(text)
        except SyntaxError as error:
            self.fault(block, f"the Python is wrong: {error}")

    def block(self, block):
        if block.note("skip"):
            return
        if block.note("file"):
            (self.folder / block.note("file")[0]).write_text("\n".join(block.lines) + "\n")
            return
        if block.language == "lua":
            self.script(block)
        elif block.language == "python":
            self.python(block)
        elif block.language == "c" or (block.language == "" and block.lines[0].startswith("laves_")):
            if self.options.compiler and self.path.name not in COMPILED_ELSEWHERE:
                self.fragment(block)
        elif block.language in ("", "sh"):
            self.commands(block)

    def read(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="laves-docs-"))
        try:
            for name in ("demo", "bench"):
                (self.folder / name).symlink_to(ROOT / name)
            for block in blocks(self.path.read_text()):
                self.block(block)
        except subprocess.TimeoutExpired as error:
            self.faults.append(f"{self.path}: {error}")
        finally:
            shutil.rmtree(self.folder)
        return self


# hello.md by tests/examples; api.md shows the header's own declarations.
COMPILED_ELSEWHERE = {"hello.md", "api.md"}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", required=True)
    parser.add_argument("--compiler", default="")
    parser.add_argument("--include", action="append", default=[])
    parser.add_argument("pages", nargs="*", type=pathlib.Path)
    options = parser.parse_args()
    options.program = os.path.abspath(options.program)
    options.include = [os.path.abspath(folder) for folder in options.include]
    pages = [p.resolve() for p in options.pages] or [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]
    with concurrent.futures.ThreadPoolExecutor(2) as pool:
        read = list(pool.map(lambda path: Page(path, options).read(), pages))
    faults = [fault for page in read for fault in page.faults]
    print("\n\n".join(faults) or f"{sum(page.count for page in read)} snippets on {len(pages)} pages")
    sys.exit(1 if faults else 0)


main()
