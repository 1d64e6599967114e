#!/usr/bin/env python3
"""What Tab offers in a shell, asked of the shell itself: commands, options, words, shipped names and files.

Usage: completions_test.py JND bash|zsh|fish. Ends with 77, and says so, if the shell is not installed."""
import os
import re
import shlex
import shutil
import sys
import tempfile

sys.path.append(__file__.rpartition("/tests/")[0] + "/tests")
import program

SHELL = sys.argv[1]

# A line, what must be offered, and what must not.
CASES = [
    ("jnd pl", ["plan"], ["run"]),
    ("jnd device mo", ["model"], ["list"]),
    ("jnd device model m", ["mckibben"], ["rrs3"]),
    ("jnd help ver", ["verify"], ["plan"]),
    ("jnd plan --coh", ["--cohort"], ["--seed"]),
    ("jnd run --record e", ["events"], ["full"]),
    ("jnd new x --task same", ["same-different"], ["which"]),
    ("jnd check tuto", ["tutorial"], ["chinello2017"]),
    ("jnd simulate tutorial --profile chinello2017-v", ["chinello2017-varied"], ["chinello2017-b"]),
    ("jnd device test mck", ["mckibben"], ["rrs3"]),
    ("jnd status ", ["mine.sqlite"], ["other.txt"]),
    ("jnd calc sdt ot", ["other.txt"], ["mine.sqlite"]),
]


ODD = "odd $(touch ran) it's"  # a shipped protocol of that name


def bash(line, folder, script):
    """The function that completes, called as bash calls it."""
    words = line.split(" ")
    quoted = " ".join(f"'{word}'" for word in words)
    ask = (f"source '{script}'\nCOMP_WORDS=({quoted})\nCOMP_CWORD={len(words) - 1}\n_jnd\nprintf '%s\\n' \"${{COMPREPLY[@]}}\"\n"
           "complete -p jnd >/dev/null")
    done = program.run("--norc", "-c", ask, program="bash", folder=folder)
    assert done.stderr == "", done
    return done.stdout.splitlines()


def fish(line, folder, script):
    done = program.run("--no-config", "-c", f"source '{script}'; complete -C '{line}'", program="fish", folder=folder, env={"HOME": folder})
    assert done.stderr == "", done
    return [offered.split("\t")[0] for offered in done.stdout.splitlines()]


class Zsh:
    """A zsh on a terminal of its own: only there its completion works. What it inserts or lists is looked at."""

    def __init__(self, folder, script):
        self.terminal = program.Terminal("-f", "-i", program="zsh", folder=folder, columns=200,
                                         env={"TERM": "dumb", "COLUMNS": "200", "ZDOTDIR": folder, "HOME": folder})
        self.looked_at = 0
        self.tell = self.terminal.type
        self.tell("PS1='READY''> '; unsetopt zle_bracketed_paste beep prompt_sp; bindkey -e; zmodload zsh/complist\n")
        self.wait_for("READY> ")
        # As it is installed: in a folder that zsh loads functions from, where the file has the function's name.
        functions = os.path.join(folder, ".functions")
        os.mkdir(functions)
        shutil.copy(script, os.path.join(functions, "_jnd"))
        self.tell(f"fpath=('{functions}' $fpath); autoload -U compinit; compinit -D -u; zstyle ':completion:*' menu no; setopt auto_list "
                  "no_list_ambiguous list_rows_first; LISTMAX=0; print LOA''DED\n")
        self.wait_for("LOADED")
        self.wait_for("READY> ")

    def wait_for(self, text):
        """What came before that text, since the last one that was waited for."""
        found = self.terminal.until(re.compile(rf"(?s)^.{{{self.looked_at}}}.*?{re.escape(text)}"))
        before, _, _ = found[self.looked_at:].partition(text)
        self.looked_at += len(before) + len(text)
        return before

    def offered(self, line):
        # Ctrl-X ? runs after the completion and prints what the line has become: both lists and insertions are seen.
        self.tell(line + "\t\x15print DO''NE\n")
        before = self.wait_for("DONE")
        self.wait_for("READY> ")
        before = re.sub(r"\x1b\[[0-9;?]*[a-zA-Z]", " ", before)
        # What was typed is echoed: the first word of the answer is what became of it.
        return re.findall(r"[\w.+-]+", before.replace(line, " " + line.split(" ")[-1], 1).replace("\r", " "))


def main():
    if shutil.which(SHELL) is None:
        print(f"SKIPPED: {SHELL} is not installed: nobody looks at what Tab offers there")
        return 77
    with tempfile.TemporaryDirectory() as folder:
        script, shipped = (os.path.join(folder, name) for name in (".jnd-completions", ".shipped"))
        shutil.copytree(program.ROOT / "protocols", os.path.join(shipped, "protocols"))
        shutil.copy(program.ROOT / "protocols/tutorial.json", os.path.join(shipped, "protocols", f"{ODD}.json"))
        with open(script, "w", encoding="utf-8") as file:
            file.write(program.run("completions", SHELL, env={"JND_DATA_DIR": shipped}).stdout)
        for name in ("mine.sqlite", "other.txt"):
            open(os.path.join(folder, name), "w", encoding="utf-8").close()
        zsh = Zsh(folder, script) if SHELL == "zsh" else None
        wrong = 0
        for line, wanted, unwanted in CASES:
            offered = zsh.offered(line) if zsh else (bash if SHELL == "bash" else fish)(line, folder, script)
            missing = [word for word in wanted if word not in offered]
            # fish offers the other files too, after those that are meant.
            extra = [word for word in unwanted if word in (offered[:len(wanted)] if SHELL == "fish" else offered)]
            if missing or extra:
                wrong += 1
                print(f"{line!r}: missing {missing}, not wanted {extra}; offered {offered}")
        # Offered as one word, and never run. zsh inserts it, with a backslash before what it would obey.
        for line in ("jnd check odd", "jnd new my.json --from odd"):
            offered = zsh.offered(line) if zsh else (bash if SHELL == "bash" else fish)(line, folder, script)
            if not ({"touch", "ran"} <= set(offered) if zsh else ODD in offered or ODD in shlex.split(offered[0])) or os.path.exists(os.path.join(folder, "ran")):
                wrong += 1
                print(f"{line!r}: offered {offered}")
        print(f"{len(CASES) + 2 - wrong} of {len(CASES) + 2} lines complete as they should in {SHELL}")
        return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
