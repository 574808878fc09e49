#!/usr/bin/env python3
"""Man page and completion, tried by the programs that read them: groff, mandoc, bash, zsh, fish. Those that are absent are told.

    tests/tools/help_files.py build/laves
"""
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

PROGRAM = os.path.abspath(sys.argv[1])
FAULTS = []


def printed(*words):
    return subprocess.run([PROGRAM, "help", *words], check=True, capture_output=True, text=True).stdout


def run(folder, *words, **more):
    done = subprocess.run(words, cwd=folder, capture_output=True, text=True, timeout=60, **more)
    return done.stdout, done.stderr, done.returncode


def expect(right, sentence):
    if not right:
        FAULTS.append(sentence)


def there(program):
    found = shutil.which(program)
    if not found:
        print(f"{program} is not there: left out")
    return found


def check_manual(folder, table):
    (folder / "laves.1").write_text(printed("--man"))
    text = None
    if there("groff"):
        text, complaints, code = run(folder, "groff", "-man", "-ww", "-Tutf8", "-rLL=200n", "-P-cbou", "laves.1")
        expect(code == 0 and not complaints, f"groff: {complaints}")
    if there("mandoc"):
        complaints, _, _ = run(folder, "mandoc", "-T", "lint", "-W", "warning", "laves.1")
        complaints = [line for line in complaints.splitlines() if "missing date" not in line and "referenced manual" not in line]
        expect(not complaints, "mandoc: " + "\n".join(complaints))
        text = text or run(folder, "mandoc", "-T", "utf8", "-O", "width=200", "laves.1")[0]
    if text is None:
        return
    for name, about in table["commands"].items():
        expect(f"LAVES {name}".upper() in text.upper(), f"the man page lacks the command {name}")
        for option in about["options"]:
            spelling = f"--{option['name']}" + (f" {option['argument']}" if option["argument"] else "")
            expect(spelling in text, f"the man page lacks {spelling}")
    expect("130" in text and "NO_COLOR" in text, "the man page lacks exit codes or the environment")


# Words on the line and what must and must not be offered; the last word is the one in work. Files in the folder: shape.stl, a folder
# 'sub', and 'two words.obj'.
CASES = [
    (["laves", "me"], ["mesh"], ["check", "shape.stl"]),
    (["laves", ""], ["mesh", "check", "info", "tiling", "view", "help"], ["shape.stl"]),
    (["laves", "mesh", "--tet"], ["--tets"], ["--vertices", "shape.stl"]),
    (["laves", "mesh", "sh"], ["shape.stl"], ["--size"]),
    (["laves", "check", "shape.stl", "--surface", "sh"], ["shape.stl"], []),
    (["laves", "mesh", "shape.stl", "--method", ""], ["auto", "snap", "stuff"], ["shape.stl"]),
    (["laves", "mesh", "shape.stl", "--close-holes", "n"], ["no"], ["yes"]),
    (["laves", "mesh", "shape.stl", "--format", "vt"], ["vtu"], ["medit"]),
    (["laves", "mesh", "shape.stl", "--features", ""], ["auto", "none", "shape.stl"], []),
    (["laves", "mesh", "shape.stl", "--report", ""], ["auto", "shape.stl"], []),
    (["laves", "mesh", "shape.stl", "--size", ""], [], ["shape.stl", "--tets"]),
    (["laves", "view", "shape.stl", "--b"], ["--background"], ["--boundary"]),
    (["laves", "help", "--completion", ""], ["bash", "zsh", "fish"], ["mesh"]),
]


def judge(shell, words, offered, wanted, unwanted):
    missing, wrong = set(wanted) - set(offered), set(unwanted) & set(offered)
    expect(not missing and not wrong, f"{shell}: '{' '.join(words)}' offers {sorted(offered)}, lacks {sorted(missing)}, has {sorted(wrong)}")


def bash_offers(folder, words, script="laves.bash"):
    quoted = " ".join("'" + word + "'" for word in words)
    code = f"""source {script}; COMP_WORDS=({quoted}); COMP_CWORD={len(words) - 1}; _laves
               for word in "${{COMPREPLY[@]}}"; do printf '%s\\n' "$word"; done"""
    out, complaints, _ = run(folder, "bash", "--norc", "-u", "-c", code)
    expect(not complaints, f"bash: {' '.join(words)}: {complaints}")
    return out.splitlines()


def check_bash(folder):
    (folder / "laves.bash").write_text(printed("--completion", "bash"))
    for words, wanted, unwanted in CASES:
        judge("bash", words, bash_offers(folder, words), wanted, unwanted)
    judge("bash", ["view", "two"], bash_offers(folder, ["laves", "view", "two"]), ["two words.obj"], [])
    equals = ["laves", "mesh", "--method", "=", "sn"]
    judge("bash", equals, bash_offers(folder, equals), ["snap"], ["auto"])
    out, _, _ = run(folder, "bash", "--norc", "-c", "source laves.bash; complete -p laves")
    expect("_laves laves" in out, "bash: nothing is registered for laves")


def check_fish(folder):
    if not there("fish"):
        return
    (folder / "laves.fish").write_text(printed("--completion", "fish"))
    home = dict(os.environ, HOME=str(folder / "sub"), XDG_CONFIG_HOME=str(folder / "sub"), XDG_DATA_HOME=str(folder / "sub"))
    for words, wanted, unwanted in CASES:
        line = " ".join(words)
        out, complaints, _ = run(folder, "fish", "--no-config", "-c", f"source laves.fish; complete -C '{line}'", env=home)
        expect(not complaints, f"fish: {line}: {complaints}")
        judge("fish", words, [row.split("\t")[0] for row in out.splitlines()], wanted, unwanted)


def check_zsh(folder):
    if not there("zsh"):
        return
    (folder / "_laves").write_text(printed("--completion", "zsh"))
    _, complaints, code = run(folder, "zsh", "-f", "-n", "_laves")
    expect(code == 0 and not complaints, f"zsh: {complaints}")
    # A line editor in a terminal of its own: what it lists after a tab.
    script = r"""
zmodload zsh/zpty; zpty shell zsh -f -i
send() { zpty -w shell $1 }
send "PROMPT=; unsetopt zle_bracketed_paste 2>/dev/null; fpath=($PWD \$fpath); autoload -Uz compinit; compinit -u -d $PWD/sub/dump"
send "stty columns 200; LISTMAX=0; zstyle ':completion:*' list-prompt ''; setopt auto_list no_auto_menu; print READY; cd $PWD"
zpty -r shell text '*READY*READY*'
zpty -w -n shell "$1"$'\t\t'
local all= text=
repeat 300 { zpty -r -t shell text && all+=$text || sleep 0.05; [[ $all == *$2* ]] && break }
sleep 0.1; while { zpty -r -t shell text } { all+=$text }
print -r -- $all
zpty -d shell
"""
    (folder / "drive.zsh").write_text(script)
    for words, wanted, unwanted in CASES:
        if len(wanted) < 2:
            continue  # a single match is put into the line, not listed
        out, _, _ = run(folder, "zsh", "-f", "drive.zsh", " ".join(words), max(wanted))
        listed = re.sub(r"\x1b\[[0-9;?]*[A-Za-z]|\x07", " ", out)
        judge("zsh", words, listed.split(), wanted, [])


def main():
    table = json.loads(printed("--options"))
    refused = subprocess.run([PROGRAM, "help", "--completion", "tcsh"], capture_output=True, text=True)
    expect(refused.returncode == 1 and "bash, zsh and fish" in refused.stderr, "an unknown shell is not refused")
    folder = pathlib.Path(tempfile.mkdtemp(prefix="laves-help-"))
    try:
        (folder / "shape.stl").touch()
        (folder / "two words.obj").touch()
        (folder / "sub").mkdir()
        check_manual(folder, table)
        check_bash(folder)
        check_fish(folder)
        check_zsh(folder)
    finally:
        shutil.rmtree(folder)
    if FAULTS:
        sys.exit("\n".join(FAULTS))


main()
