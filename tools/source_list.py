#!/usr/bin/env python3
"""The list of source files in src/README.md, made from the first sentence of each file's comment.

    tools/source_list.py            exits with 1 and says what differs when the list is not up to date
    tools/source_list.py --write    brings it up to date
"""
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
README = ROOT / "src" / "README.md"
BEGIN, END = "<!-- list: tools/source_list.py --write -->\n", "<!-- end of list -->\n"

# A sentence that is longer, in characters, ends at its colon.
LONGEST = 120

# Folders in the order of the pipeline; what each promises to the next.
FOLDERS = {
    "": "The story: every stage is called here, in order",
    "base": "Memory, errors, threads, exact predicates; knows no other folder",
    "mesh": "Arrays of vertices and tets, their adjacency and their quality",
    "domain": "What is inside: triangle surfaces, implicit solids, functions of the caller's, behind `oracle.h`",
    "size": "How long edges shall be, from place to place",
    "background": "The tiling as a table and as sparse bricks",
    "graded": "The same of varying size: an octree, both lattices, and what joins them",
    "classify": "Which bricks and sites lie inside",
    "snap": "The cover of the crossing edges, moved on to the surface",
    "features": "Corners and creases of the solid become vertices and chains of edges",
    "stuff": "The same by warping and cutting, with a proved window",
    "assemble": "From labelled bricks to arrays",
    "improve": "Better angles in the boundary layer",
    "curve": "Nodes of second order, on the surface",
    "certify": "Checks by code that shares nothing with the stages before",
    "io": "Files",
}


def first_sentence(path):
    """The first sentence of the comment that a file starts with."""
    match = re.match(r"\s*/\*(.*?)\*/|\s*((?://.*\n)+)", path.read_text(), re.S)
    if not match:
        sys.exit(f"source_list: {path.relative_to(ROOT)} does not start with a comment that says what it is")
    text = re.sub(r"\n\s*(?:\*|//+) ?", "\n", match.group(1) or match.group(2)).strip().lstrip("/ ")
    paragraph = " ".join(text.split("\n\n")[0].split())
    sentence = re.match(r".*?(?:[.;](?=\s|$)|$)", paragraph).group(0)
    if len(sentence) > LONGEST:
        sentence = sentence.split(": ")[0]
    return sentence.rstrip(".:; ").replace("|", "\\|")


def source_list():
    """The Markdown list: a table for each folder, a row for each file name without its ending."""
    sources = sorted(p for p in (ROOT / "src").rglob("*") if p.suffix in (".c", ".h"))
    folders = {str(p.parent.relative_to(ROOT / "src")).replace(".", "", 1) for p in sources}
    unknown = folders - set(FOLDERS)
    if unknown:
        sys.exit(f"source_list: say in tools/source_list.py what the folder {unknown.pop()} is for")
    out = []
    for folder, purpose in FOLDERS.items():
        files = [p for p in sources if p.parent == ROOT / "src" / folder]
        if not files:
            continue
        out += [f"\n**{'src/' + folder if folder else 'src'}**: {purpose}.\n\n", "| file | what it is |\n|---|---|\n"]
        for stem in sorted({p.stem for p in files}):
            same = [p for p in files if p.stem == stem]  # .c comes before .h
            names = ", ".join([f"`{same[0].name}`"] + [f"`{p.suffix}`" for p in same[1:]])
            sentences = [first_sentence(path) for path in same]
            told = [sentence for sentence in sentences if not sentence.startswith("Generated")]
            out.append(f"| {names} | {(told or sentences)[0]} |\n")
    return "".join(out) + "\n"


def main():
    text = README.read_text()
    before, rest = text.split(BEGIN)
    wanted = before + BEGIN + source_list() + END + rest.split(END)[1]
    if sys.argv[1:] == ["--write"]:
        README.write_text(wanted)
    elif text != wanted:
        missing = sorted(set(wanted.splitlines()) ^ set(text.splitlines()))
        sys.exit("source_list: src/README.md is not up to date; run tools/source_list.py --write\n" + "\n".join(missing))


main()
