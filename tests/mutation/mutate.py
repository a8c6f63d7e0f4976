#!/usr/bin/env python3
"""Changes one sign, bound or factor of a source at a time, and says which changes no test notices.

  tests/mutation/mutate.py landmark_map forward_map       the core of those pipelines, as cores.txt names it
  tests/mutation/mutate.py --program PROGRAM FILE.cc…     those files, by that test program (ninja's name of it)

  --count N    so many mutants of each core, drawn by the seed (15); 0: all of them
  --seed N     which (1)
  --kinds K…   of sign, bound, factor (all)
  --only ID…   these and no others
  --jobs N     at the same time (1)
  --build DIR  a build configured with -D CAIRN_UNITY=OFF (build/mutation, which is configured where it is not there); of it
               only the test program is built
  --list       says what would be changed, and changes nothing
  --equivalent also those that equivalent.txt names, which are left out else

The sources and the build are left as they are: a mutant is compiled beside them and linked before the library that
holds the original. It is killed when the test program fails, crashes, or takes ten times as long as undisturbed; an index
out of range crashes (_GLIBCXX_ASSERTIONS). First the files unchanged are tried in the same way, and must pass. The tests of
the file's own foo_test.cc run first. Exit code: 0 all were killed, 1 some survived, 2 it could not be done.
"""

import argparse
import concurrent.futures
import dataclasses
import hashlib
import json
import os
import re
import shlex
import subprocess
import sys
import tempfile
import time

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.dirname(os.path.dirname(HERE))
OWN_BUILD = os.path.join(ROOT, "build", "mutation")

# What is changed into what. The sources are formatted: an operator with a blank on either side has two operands.
SWAPS = {
    "sign": [(r"(?<=[\w)\]] )\+(?= )", "-"), (r"(?<=[\w)\]] )-(?= )", "+"),
             (r"(?<=[\w)\]] )\+=(?= )", "-="), (r"(?<=[\w)\]] )-=(?= )", "+="),
             (r"(?<=[(=,?:] )-(?=[\w(])", ""), (r"(?<=\()-(?=[A-Za-z_(])", ""), (r"(?<=return )-(?=[\w(])", "")],
    "bound": [(r"(?<=[\w)\]] )<(?= )", "<="), (r"(?<=[\w)\]] )<=(?= )", "<"),
              (r"(?<=[\w)\]] )>(?= )", ">="), (r"(?<=[\w)\]] )>=(?= )", ">"),
              (r"\bstd::min\b", "std::max"), (r"\bstd::max\b", "std::min")],
    "factor": [(r"(?<=[\w)\]] )\*(?= )", "/"), (r"(?<=[\w)\]] )/(?= )", "*"),
               (r"(?<=[\w)\]] )\*=(?= )", "/="), (r"(?<=[\w)\]] )/=(?= )", "*="),
               (r"(?<![\w.])(?!0?\.0*\b)\d+\.\d*(?:e-?\d+)?\b", "DOUBLE")],
}


@dataclasses.dataclass
class Mutant:
    file: str
    line: int
    column: int
    old: str
    new: str
    kind: str
    text: str  # the line as it stands
    id: str = ""


def blank(text):
    """The source with comments, literals and preprocessor lines blanked out, each character in its place."""
    pattern = r'//[^\n]*|/\*.*?\*/|R"\((?:.*?)\)"|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])+\'|^[ \t]*#[^\n]*'
    # A digit separator (100'000) is no literal.
    return re.sub(pattern, lambda m: re.sub(r"[^\n]", "\x01", m.group()), text, flags=re.S | re.M)


def mutants_of(path, kinds):
    """Every mutant of a file, in the order of the file."""
    text = open(os.path.join(ROOT, path)).read()
    lines = text.split("\n")
    found, seen = [], {}
    for number, (code, line) in enumerate(zip(blank(text).split("\n"), lines), 1):
        # Text is put together by +, and what is demanded or complained of is not computed.
        if "\x01" in code.split("\x01//")[0].rstrip("\x01") or re.search(r"InputError|CAIRN_DEMAND|static_assert|template", code):
            continue
        for kind in kinds:
            for pattern, new in SWAPS[kind]:
                for m in re.finditer(pattern, code):
                    old = m.group()
                    by = f"(2 * {old})" if new == "DOUBLE" else new
                    found.append(Mutant(path, number, m.start(), old, by, kind, line))
    found.sort(key=lambda m: (m.line, m.column))
    for m in found:
        # The line's text, not its number: a mutant keeps its name while other lines come and go.
        key = (m.file, m.text.strip(), m.column - (len(m.text) - len(m.text.lstrip())), m.old, m.new)
        seen[key] = seen.get(key, 0) + 1
        m.id = hashlib.sha256(repr((key, seen[key])).encode()).hexdigest()[:8]
    return found


def drawn(mutants, count, seed):
    """`count` of them: those whose names and seed hash lowest, so that a change elsewhere leaves the draw as it is."""
    if count == 0 or count >= len(mutants):
        return mutants
    chosen = sorted(mutants, key=lambda m: hashlib.sha256(f"{seed} {m.id}".encode()).hexdigest())[:count]
    return sorted(chosen, key=lambda m: (m.file, m.line, m.column))


def changed(mutant):
    lines = open(os.path.join(ROOT, mutant.file)).read().split("\n")
    line = lines[mutant.line - 1]
    lines[mutant.line - 1] = line[:mutant.column] + mutant.new + line[mutant.column + len(mutant.old):]
    return "\n".join(lines)


def fail(text):
    print(f"mutate.py: {text}", file=sys.stderr)
    sys.exit(2)


class Bench:
    """A test program: how it is linked, how each of its sources is compiled, how long it runs undisturbed."""

    def __init__(self, build, program):
        self.build, self.program = build, program
        if build == OWN_BUILD and not os.path.exists(os.path.join(build, "CMakeCache.txt")):
            command = ["cmake", "--preset", "release", "-B", build, "-D", "CAIRN_UNITY=OFF"]
            made = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
            if made.returncode != 0:
                fail(f"{build} cannot be configured:\n{made.stderr[-4000:]}")
        made = subprocess.run(["cmake", "--build", build, "--target", program], capture_output=True, text=True)
        if made.returncode != 0:
            fail(f"{program} does not build:\n{made.stdout[-4000:]}{made.stderr[-4000:]}")
        commands = subprocess.run(["ninja", "-C", build, "-t", "commands", program], capture_output=True, text=True)
        link = [part for part in commands.stdout.strip().split("\n")[-1].split(" && ") if " -o " in part]
        if len(link) != 1:
            fail(f"how {program} is linked is not to be seen from ninja")
        self.link = shlex.split(link[0])
        self.binary = os.path.join(build, self.link[self.link.index("-o") + 1])
        self.compile = {entry["file"]: entry for entry in json.load(open(os.path.join(build, "compile_commands.json")))}

    def compiles(self, file, text, folder, output):
        """That file with that text, into `output` in the folder."""
        entry = self.compile.get(os.path.join(ROOT, file))
        if entry is None:
            fail(f"{file} is not compiled by itself in {self.build}: configure it with -D CAIRN_UNITY=OFF")
        source = os.path.join(folder, os.path.basename(file))
        open(source, "w").write(text)
        command = shlex.split(entry["command"])
        command = [word for word in command if os.path.basename(word) != "ccache" and word != "-Werror"]
        command[command.index("-o") + 1] = os.path.join(folder, output)
        command[command.index(entry["file"])] = source
        command += ["-w", "-D_GLIBCXX_ASSERTIONS", "-iquote", os.path.dirname(entry["file"])]
        for flag, words in ("-MD", 1), ("-MT", 2), ("-MF", 2):
            if flag in command:
                del command[command.index(flag):command.index(flag) + words]
        return subprocess.run(command, cwd=entry["directory"], capture_output=True, text=True).returncode == 0

    def links(self, folder, objects):
        command = list(self.link)
        at = command.index("-o")
        command[at + 1] = os.path.join(folder, "tests")
        command[at:at] = [os.path.join(folder, name) for name in objects]
        made = subprocess.run(command, cwd=self.build, capture_output=True, text=True)
        if made.returncode != 0:
            fail(f"a mutant of {self.program} does not link:\n{made.stderr[-4000:]}")

    def own_tests(self, file):
        """gtest's filter for the tests in foo_test.cc beside foo.cc; empty where there is none."""
        path = os.path.join(ROOT, re.sub(r"\.cc$", "_test.cc", file))
        if not os.path.exists(path):
            return ""
        names = re.findall(r"^TEST(?:_F|_P)?\((\w+),\s*(\w+)\)", open(path).read(), re.M)
        return ":".join(f"*{suite}.{name}*" for suite, name in names)

    def undisturbed_s(self, files):
        """How long the tests take with those files compiled as mutants are, but unchanged."""
        with tempfile.TemporaryDirectory(prefix="mutant ") as folder:
            objects = [f"{i}.o" for i in range(len(files))]
            for file, name in zip(files, objects):
                if not self.compiles(file, open(os.path.join(ROOT, file)).read(), folder, name):
                    fail(f"{file} does not compile as it is")
            self.links(folder, objects)
            begin = time.monotonic()
            by = self.run(folder, "*", None)
            if by:
                fail(f"{self.program} fails without a mutant: {by}")
            return time.monotonic() - begin

    def run(self, folder, which, limit_s):
        """Who kills it; empty: nobody."""
        temporary = os.path.join(folder, "tmp")
        os.makedirs(temporary, exist_ok=True)
        command = [os.path.join(folder, "tests"), "--gtest_brief=1", "--gtest_fail_fast", f"--gtest_filter={which}"]
        try:
            # Files of its own: gtest's TempDir() is TEST_TMPDIR.
            ran = subprocess.run(command, cwd=folder, capture_output=True, timeout=limit_s,
                                 env={**os.environ, "TEST_TMPDIR": temporary, "TMPDIR": temporary})
        except subprocess.TimeoutExpired:
            return "takes too long"
        if ran.returncode == 0:
            return ""
        failed = re.findall(r"\[  FAILED  \] (\S+?)[,.]? ", ran.stdout.decode(errors="replace") + " ")
        if failed:
            return failed[0]
        return f"ends with signal {-ran.returncode}" if ran.returncode < 0 else f"ends with code {ran.returncode}"

    def verdict(self, mutant, limit_s):
        with tempfile.TemporaryDirectory(prefix="mutant ") as folder:
            if not self.compiles(mutant.file, changed(mutant), folder, "mutant.o"):
                return "stillborn", "does not compile"
            self.links(folder, ["mutant.o"])
            own = self.own_tests(mutant.file)
            by = (self.run(folder, own, limit_s) if own else "") or self.run(folder, "*", limit_s)
            return ("killed", by) if by else ("SURVIVED", "")


def read_table(name):
    """The lines of a file beside this one, without comments, as words."""
    lines = (line.split("#")[0].split() for line in open(os.path.join(HERE, name)))
    return [words for words in lines if words]


def work_on(name, program, files, options):
    """Prints a line a mutant and a sum; the number that survived."""
    kinds = options.kinds or list(SWAPS)
    equivalent = {words[0] for words in read_table("equivalent.txt")}
    for file in files:
        if not os.path.exists(os.path.join(ROOT, file)):
            fail(f"there is no {file}")
    every = [m for file in files for m in mutants_of(file, kinds)]
    if options.only:
        mutants = [m for m in every if m.id in options.only]
    else:
        mutants = drawn([m for m in every if options.equivalent or m.id not in equivalent], options.count, options.seed)
    if not mutants:
        fail(f"{name}: nothing to change in {' '.join(files)}")
    if options.list:
        for m in mutants:
            print(f"{m.id} {m.kind:6} {m.file}:{m.line}: {m.old} -> {m.new}: {m.text.strip()}")
        return 0
    bench = Bench(os.path.abspath(options.build), program)
    undisturbed_s = bench.undisturbed_s(sorted({m.file for m in mutants}))
    limit_s = 10 * undisturbed_s + 30
    print(f"== {name}: {len(mutants)} of {len(every)} mutants (seed {options.seed}), {program} takes {undisturbed_s:.1f} s",
          flush=True)
    sums = {"killed": 0, "SURVIVED": 0, "stillborn": 0}
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        for m, (state, by) in zip(mutants, pool.map(lambda m: bench.verdict(m, limit_s), mutants)):
            sums[state] += 1
            print(f"{state:9} {m.id} {m.file}:{m.line}: {m.old} -> {m.new}: {m.text.strip()}{'  | ' + by if by else ''}",
                  flush=True)
    print(f"== {name}: {sums['killed']} killed, {sums['SURVIVED']} survived, {sums['stillborn']} do not compile", flush=True)
    return sums["SURVIVED"]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", nargs="+", help="cores, or with --program files")
    parser.add_argument("--program")
    parser.add_argument("--count", type=int, default=15)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--kinds", nargs="+", choices=list(SWAPS))
    parser.add_argument("--only", nargs="+")
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--build", default=OWN_BUILD)
    parser.add_argument("--list", action="store_true")
    parser.add_argument("--equivalent", action="store_true")
    options = parser.parse_args()
    if options.program:
        cores = [("these files", options.program, [os.path.relpath(os.path.abspath(f), ROOT) for f in options.what])]
    else:
        known = {words[0]: words for words in read_table("cores.txt")}
        for name in options.what:
            if name not in known:
                fail(f"there is no core '{name}' in cores.txt; there are {', '.join(known)}")
        cores = [(name, known[name][1], known[name][2:]) for name in options.what]
    sys.exit(1 if sum(work_on(*core, options) for core in cores) > 0 else 0)


main()
