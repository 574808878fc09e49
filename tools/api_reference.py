#!/usr/bin/env python3
"""The reference of the C interface, docs/api.md, from the declarations of include/laves/laves.h and the comments above them.

    tools/api_reference.py            exits with 1 when docs/api.md is not up to date, or something public has no comment
    tools/api_reference.py --write    brings it up to date

The header is read by its layout, which clang-format keeps: sections begin with `/* ---- name`, comments with `///`; what follows one
another without an empty line belongs together.
"""
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
HEADER = ROOT / "include" / "laves" / "laves.h"
PAGE = ROOT / "docs" / "api.md"


class Item:
    """A comment and the declarations that it speaks of."""

    def __init__(self):
        self.comment = []
        self.code = []

    def names(self):
        """What is declared: functions, types and lists of macros, in order."""
        text = "\n".join(line.split("//")[0] for line in self.code)
        found = re.findall(r"LAVES_API[^;]*?\b(laves_\w+)\(", text)
        found += re.findall(r"^} (laves_\w+);", text, re.M) + re.findall(r"^typedef (?:struct|enum) \w+ (?:\{.*\} )?(laves_\w+);", text, re.M)
        found += re.findall(r"^typedef [^;{]*?\*?\b(laves_\w+_fn)\(", text, re.M) + re.findall(r"^#define (LAVES_\w+_LIST)", text, re.M)
        return list(dict.fromkeys(found))


def sections():
    """The header as [(name, [groups of items])]."""
    body = HEADER.read_text().split('extern "C" {', 1)[1].split("#ifdef __cplusplus")[0]
    found, groups, item, depth, macro = [], None, None, 0, False
    for line in body.splitlines():
        start = re.match(r"/\* ---- (.+?) -+ \*/", line)
        if start:
            groups = []
            found.append((start[1], groups))
            item = None
        elif groups is None or line.startswith("#endif"):
            continue
        elif not line.strip() and depth == 0:
            item = None
        elif line.startswith("///") and depth == 0:
            if item is None or item.code:
                item = Item()
                groups.append(item)
            item.comment.append(line[3:].rstrip())
        else:
            if item is None:
                item = Item()
                groups.append(item)
            item.code.append(line)
            code = line.split("//")[0]
            depth += 0 if macro or line.startswith("#define") else code.count("{") - code.count("}")
            macro = line.endswith("\\")
    return found


# ---- comments as Markdown ----


def paragraphs(comment):
    """The comment as [(kind, text)]: kind is 'text', 'return', or the name of a parameter."""
    found = [["text", ""]]
    for line in comment:
        if line.strip().startswith("@"):
            for part in re.split(r"\s+(?=@)", line.strip()):
                word, _, rest = part.partition(" ")
                name = rest.strip().partition(" ")
                found.append([name[0], name[2].strip()] if word == "@param" else ["return", rest.strip()])
            continue
        starts_anew = re.match(r" (Cost|Thread safety|Where|Memory):? ", line) and found[-1][0] != "text"
        if starts_anew:
            found.append(["text", ""])
        found[-1][1] = (found[-1][1] + " " + line.strip()).strip()
    return [(kind, text) for kind, text in found if text]


def as_markdown(text, known):
    """Text with names as code and links, and nothing that Markdown would take for its own."""
    pieces = re.split(r"(\"[^\"]*\"|\b(?:laves_\w+|LAVES_\w+|NULL|NAN|INFINITY)\b(?:\(\)|\.\w+)?|`[^`]*`|\bdocs/[\w.-]+\.(?:md|json)|"
                      r"\b(?:double|float|u?int\d+_t|bool|laves_\w+)(?:\[[\w *]+\])+)", text)
    out = []
    for i, piece in enumerate(pieces):
        name = re.match(r"\w+", piece)
        if i % 2 == 0:
            out.append(re.sub(r"([*_<|])", r"\\\1", piece))
        elif piece.startswith('"'):
            out.append("`" + piece + "`")
        elif piece.startswith("`"):
            out.append(piece)
        elif piece.startswith("docs/"):
            out.append(f"[{piece[5:]}]({piece[5:]})")
        elif name and name[0] in known and "[" not in piece:
            out.append(f"[`{piece}`](#{name[0].lower()})")
        else:
            out.append(f"`{piece}`")
    return "".join(out)


def item_lines(item, known):
    names = item.names()
    lines = []
    if len(names) > 1:  # a heading of one name is found by it already
        lines = ["".join(f'<a id="{name.lower()}"></a>' for name in names), ""]
    if names:
        lines += ["### " + ", ".join(f"`{name}`" for name in names), ""]
    told = paragraphs(item.comment)
    for kind, text in told:
        if kind == "text":
            lines += [as_markdown(text, known), ""]
    code = "\n".join(re.sub(r"^LAVES_API ", "", line) for line in item.code)
    lines += ["```c", code, "```", ""]
    rows = [(kind, text) for kind, text in told if kind != "text"]
    if rows:
        lines += ["| | |", "|---|---|"]
        lines += [f"| {'returns' if kind == 'return' else f'`{kind}`'} | {as_markdown(text, known)} |" for kind, text in rows]
        lines.append("")
    return lines


def page():
    parts = sections()
    known = {name for _, items in parts for item in items for name in item.names()}
    lines = ["# The C interface", "",
             "Made from [laves.h](../include/laves/laves.h) by `tools/api_reference.py --write`; change the header, not this page. A first program, grown "
             "line by line: [hello.md](hello.md); more: [examples](../examples/README.md).", ""]
    opening = HEADER.read_text().split("*/", 1)[0].split("\n", 1)[1]
    for paragraph in re.split(r"\n \*\n", opening)[1:]:
        lines += [as_markdown(re.sub(r"\s*\n \* ?", " ", paragraph).strip(" *"), known), ""]
    lines += ["| part | what is in it |", "|---|---|"]
    for name, items in parts:
        inside = [n for item in items for n in item.names()]
        lines.append(f"| [{name}](#{anchor(name)}) | {', '.join(f'[`{n}`](#{n.lower()})' for n in inside)} |")
    for name, items in parts:
        lines += ["", f"## {name[0].upper() + name[1:]}", ""]
        for item in items:
            lines += item_lines(item, known)
    return re.sub(r"\n{3,}", "\n\n", "\n".join(lines)).rstrip() + "\n"


def anchor(heading):
    return re.sub(r"[^\w -]", "", heading.lower()).replace(" ", "-")


def without_comment():
    """Names of functions and types that stand alone without a comment; defaults, enumerations and what frees speak for themselves."""
    for _, items in sections():
        for item in items:
            for name in item.names():
                plain = re.search(r"_(default|free)$", name) or re.search(r"^typedef enum|^typedef struct laves_mesh laves_mesh", item.code[0])
                inside = any("///<" in line for line in item.code)
                if not item.comment and not plain and not inside:
                    yield name


def main():
    bare = list(without_comment())
    text = page()
    if sys.argv[1:] == ["--write"]:
        PAGE.write_text(text)
    elif not PAGE.exists() or PAGE.read_text() != text:
        sys.exit(f"{PAGE.relative_to(ROOT)} is not what include/laves/laves.h says: tools/api_reference.py --write")
    if bare:
        sys.exit("laves.h says nothing about " + ", ".join(bare))


main()
