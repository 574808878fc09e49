"""Reads the counts of a coverage build: lines reached in each folder of the sources. Called by tools/coverage."""
import collections
import json
import pathlib
import subprocess
import sys

LOW = 90  # per cent; files below are listed one by one


def reached_lines(build, root):
    """For each source file the set of its lines with code, and of those that ran."""
    lines, reached = collections.defaultdict(set), collections.defaultdict(set)
    for counts in sorted(build.rglob("*.gcda")):
        run = subprocess.run(["gcov", "--json-format", "--stdout", str(counts)], capture_output=True, check=True, cwd=build)
        for text in run.stdout.splitlines():
            for file in json.loads(text)["files"]:
                path = pathlib.Path(root, build, file["file"]).resolve()
                if not path.is_relative_to(root) or path.relative_to(root).parts[0] not in ("src", "cli"):
                    continue
                name = path.relative_to(root)
                for line in file["lines"]:
                    lines[name].add(line["line_number"])
                    if line["count"] > 0:
                        reached[name].add(line["line_number"])
    return lines, reached


def row(name, total, run):
    print(f"{str(name):34} {total:7} {run:7} {100 * run / max(total, 1):6.1f} %")


def main():
    root = pathlib.Path(__file__).resolve().parent.parent
    lines, reached = reached_lines((root / sys.argv[1]).resolve(), root)
    folders = collections.defaultdict(lambda: [0, 0])
    for name, numbers in lines.items():
        for folder in {name.parent, pathlib.Path(name.parts[0])}:
            folders[folder][0] += len(numbers)
            folders[folder][1] += len(reached[name])
    readers = [n for n in lines if n.parent.name == "io" and n.name.startswith(("read_", "scan", "surface_build", "mesh_input"))]
    for name in sorted(n for n in lines if 100 * len(reached[n]) < LOW * len(lines[n])):
        row(name, len(lines[name]), len(reached[name]))
    print()
    for folder in sorted(folders):
        row(f"{folder}/" if folder != pathlib.Path("src") else "all of src/", *folders[folder])
    row("the readers of src/io", sum(len(lines[n]) for n in readers), sum(len(reached[n]) for n in readers))


if __name__ == "__main__":
    main()
