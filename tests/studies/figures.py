#!/usr/bin/env python3
"""figures.py [--quick] [--keep FOLDER] [PAGE...]: is a figure on a page what its command prints?

A page says above a table or a paragraph what printed it:

    <!-- printed by: COMMAND -->            several commands: several lines
    <!-- printed quickly by: COMMAND -->    takes some ten seconds at most; --quick runs these alone
    <!-- printed by: the last column -->    each row of a table by the `commands` in its last cell; rows without a command,
                                            or without a figure, are not looked at

Each command is run once, by bash, in an empty folder of its own. Every figure of the block that follows must be in what
the commands print on their standard output, as it is there or rounded to the page's digits. Figures are
  - in a table all numbers but those of the header and the first column (with "the last column": and of the last),
  - in a paragraph the numbers with a decimal point or a % sign,
and nowhere those within `code` or *italics* (figures of something else: a paper's, an earlier version's), nor seconds and
megabytes, which are the machine's.

A number is looked for anywhere in what is printed: of a command that prints much `COMMAND | tail -n 5` says which lines count.
Commands that need CAIRN_DATA are skipped, and named, where that data is missing. --keep: what commands printed is kept in that
folder, and a command of which it is there is not run again. Without pages: README.md, docs/ and pipelines/, those with a
marker. CAIRN_BIN: the folder of the programs, build/release/bin without it. Fails where a figure is not printed, a command
fails or prints nothing, or a block has no figure.
"""
import argparse
import hashlib
import os
import pathlib
import re
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
MARKER = re.compile(r"<!-- printed (quickly )?by: (.*) -->$")
NUMBER = re.compile(r"(?<![\w.])(?<!\w-)-?\d+(?:,\d{3})*(?:\.\d+)?(?:e[-+]?\d+)?")
OF_THE_MACHINE = re.compile(r"(?:(?:,| to| and) [\d.]+)*\s?(?:s|ms|MB|GB|minutes|hours)\b")
NOT_OURS = [re.compile(r"`[^`]*`"), re.compile(r"\]\([^)]*\)"), re.compile(r"(?<!\*)\*(?!\*)[^*]+\*(?!\*)")]


class Block:
    def __init__(self, page, line, commands, quick, text):
        self.page, self.line, self.commands, self.quick, self.text = page, line, commands, quick, text


def code(cell):
    return re.findall(r"`([^`]*)`", cell)


def cells(row):
    return [cell.strip().replace("\\|", "|") for cell in re.split(r"(?<!\\)\|", row.strip())[1:-1]]


def blocks(page):
    """The blocks of a page that have a marker, each a list of lines; of "the last column" a block a row."""
    lines = page.read_text().splitlines()
    at = 0
    while at < len(lines):
        markers = []
        while at < len(lines) and (marker := MARKER.match(lines[at])):
            markers.append(marker)
            at += 1
        if not markers:
            at += 1
            continue
        while at < len(lines) and not lines[at].strip():
            at += 1
        first = at
        while at < len(lines) and lines[at].strip():
            at += 1
        text, quick = lines[first:at], all(marker[1] for marker in markers)
        commands = [marker[2] for marker in markers]
        if commands != ["the last column"]:
            yield Block(page, first + 1, commands, quick, text)
        else:
            yield from rows(page, first, quick, text)


def rows(page, first, quick, text):
    """A block of each row of a table that has a command and a figure; the table itself where no row has both."""
    found = []
    for line, row in enumerate(text[2:], first + 3):
        *others, last = cells(row)
        without = "| " + " | ".join(cell.replace("|", "\\|") for cell in others) + " |"
        block = Block(page, line, code(last), quick, ["", "", without])
        if block.commands and list(figures(block)):
            found.append(block)
    return found or [Block(page, first + 1, [], quick, [])]


def figures(block):
    """(text, value, digits behind the point) of each figure in a block."""
    if not block.text:
        return
    table = not block.text[-1] or block.text[-1].lstrip().startswith("|")
    text = "\n".join(" | ".join(cells(row)[1:]) for row in block.text[2:]) if table else "\n".join(block.text)
    for pattern in NOT_OURS:
        text = pattern.sub(" ", text)
    for match in NUMBER.finditer(text):
        behind = text[match.end():]
        if OF_THE_MACHINE.match(behind) or not (table or "." in match[0] or behind.startswith("%")):
            continue
        digits = len(match[0].partition(".")[2])
        yield match[0], float(match[0].replace(",", "")), digits


def numbers(text):
    """The numbers in what a command printed: with commas as thousands, and with commas between numbers."""
    found = [match.replace(",", "") for match in NUMBER.findall(text)] + NUMBER.findall(text.replace(",", " "))
    return {float(number) for number in found}


def data_missing(command):
    """What a command needs of CAIRN_DATA and is not there; None where nothing is missing."""
    if "CAIRN_DATA" not in command:
        return None
    data = os.environ.get("CAIRN_DATA")
    if not data:
        return "CAIRN_DATA"
    for name in re.findall(r"\$CAIRN_DATA/([\w.-]+)", command):
        if not (pathlib.Path(data) / name).exists():
            return f"$CAIRN_DATA/{name}"
    return None


class Runner:
    def __init__(self, keep):
        binaries = pathlib.Path(os.environ.get("CAIRN_BIN") or ROOT / "build/release/bin").resolve()
        studies = [binaries.parent / "tests/studies", ROOT / "tests/studies"]
        self.environment = dict(os.environ, CAIRN_BIN=str(binaries),
                                PATH=os.pathsep.join(map(str, [binaries, *studies])) + os.pathsep + os.environ["PATH"])
        self.keep, self.printed = keep, {}

    def output(self, command):
        """What the command printed on its standard output; None where it failed, which is said."""
        if command not in self.printed:
            self.printed[command] = self.kept(command) or self.run(command)
        return self.printed[command]

    def file(self, command):
        return self.keep / (hashlib.sha256(command.encode()).hexdigest()[:16] + ".txt")

    def kept(self, command):
        return self.file(command).read_text() if self.keep and self.file(command).exists() else None

    def run(self, command):
        print(f"  runs {command}", flush=True)
        with tempfile.TemporaryDirectory(prefix="cairn figures ") as folder:
            environment = dict(self.environment, HOME=folder, CAIRN_HOME=folder + "/home")
            work = pathlib.Path(folder) / "work"
            work.mkdir()
            done = subprocess.run(["bash", "-euo", "pipefail", "-c", command], cwd=work, env=environment,
                                  stdin=subprocess.DEVNULL, capture_output=True, text=True)
        if done.returncode != 0 or not done.stdout.strip():
            what = f"exit code {done.returncode}" if done.returncode else "prints nothing"
            print(f"FAILED: {command}: {what}\n{done.stderr[-2000:]}")
            return None
        if self.keep:
            self.keep.mkdir(parents=True, exist_ok=True)
            self.file(command).write_text(done.stdout)
        return done.stdout


def check(block, runner):
    """How many of its figures are printed; None where something is wrong, which is said."""
    where = f"{block.page.relative_to(ROOT) if block.page.is_relative_to(ROOT) else block.page.name}:{block.line}"
    wanted = list(figures(block))
    if not wanted:
        print(f"FAILED: {where}: no figure stands below the marker")
        return None
    printed = [runner.output(command) for command in block.commands]
    if None in printed:
        return None
    there = numbers("\n".join(printed))
    lost = [text for text, value, digits in wanted
            if not any(abs(value - number) <= 0.5 * 10**-digits + 1e-9 for number in there)]
    if lost:
        print(f"FAILED: {where}: {', '.join(lost)} not printed by {' and '.join(block.commands)}")
        return None
    print(f"{where}: {len(wanted)} figures")
    return len(wanted)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--keep", type=pathlib.Path)
    parser.add_argument("pages", nargs="*", type=pathlib.Path)
    arguments = parser.parse_args()
    pages = [page.resolve() for page in arguments.pages]
    pages = pages or [ROOT / "README.md", *sorted(ROOT.glob("docs/*.md")), *sorted(ROOT.glob("pipelines/*/*.md"))]
    runner, good, bad, skipped = Runner(arguments.keep and arguments.keep.resolve()), 0, 0, 0
    for block in [block for page in pages for block in blocks(page) if block.quick or not arguments.quick]:
        missing = next(filter(None, map(data_missing, block.commands)), None)
        if missing:
            print(f"skipped: {block.page.name}:{block.line}: {missing} is missing")
            skipped += 1
            continue
        count = check(block, runner)
        good, bad = (good, bad + 1) if count is None else (good + count, bad)
    print(f"{good} figures are what their commands print; {bad} blocks are not, {skipped} skipped")
    if bad:
        return 1
    if good + skipped == 0:
        print("FAILED: no block has a marker")
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
