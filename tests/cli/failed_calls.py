# SPDX-License-Identifier: Apache-2.0
"""Failed calls: one allocation or one call of the system fails (or all from one on), whichever it is, in every command.

    SUBVOL_COMMAND=build/release/bin/subvol SUBVOL_FAIL_CALLS=build/release/tests/cli/libfail_calls.so \\
      python3 tests/cli/failed_calls.py [--most 2000] [--only NAMES] [--kinds KINDS] [--table FILE]

runs each command of `small_commands` once for each call that fails, at most --most times for each command and kind, evenly
spread beyond that, and prints a table; exit code 1 if anything went wrong. ctest runs a sample: `--quick --most 2`.
Required after each run: exit code 2 or 3 with one sentence, or 0 with all files and all of what it prints; files under their
final names are whole or as they were before; nothing else is left; no signal ends the program, and it ends.
"""

import argparse
import collections
import concurrent.futures
import os
import re
import resource
import signal
import subprocess
import sys
import tempfile
from pathlib import Path

from command import COMMAND, SANITIZED
from fault_commands import prepare, small_commands
from faults import Ended, Problem, check_files, judge, put_old_files

LIBRARY = os.environ.get("SUBVOL_FAIL_CALLS", "")
KINDS = ("alloc", "write", "read", "open", "rename", "sync", "close", "map", "thread", "process")
SKIPPED = 77
QUIET_S = 20  # seconds without any work of the processor, after which a program hangs
MOST_CPU_S = 300
HANGS_IN_LIBRARY = "hangs when liblog4cplus is loaded"

# Libraries that crash, or print, when they are short of memory: nothing outside of them can prevent it.
OF_LIBRARIES = {
    "libblosc": "compresses for OpenVDB; prints that memory is short on standard output, or uses memory that it did not get",
    "libLLVM": "is loaded with Mesa; ends the program",
    "libEGL_mesa": "uses memory that it did not get",
    "swrast_dri": "uses memory that it did not get",
    "libhdf5": "begins its tables of errors and properties without looking whether there is memory, at its first call",
    "libgnutls": "is loaded with HDF5's library and prints that it could not begin",
    "liblog4cplus": "is loaded with OpenVDB, starts a pool of threads when it is loaded, and waits for one that did not start",
}


# Faults that were found so and mended: with --quick all calls of these fail in turn.
MENDED = {
    "model .vtu": ["alloc@libz.so"],  # compress2 could not allocate: blocks of zeros, exit code 0
    "model .vtkhdf": ["write"],  # HDF5's library writes when a dataset is closed, which was not asked for its success
}


def labels(text):
    """What a report consists of, without its numbers."""
    return [line.split(" ")[0] for line in text.splitlines()]


def ticks_of(pid):
    """The processor's time that a process and its children have used."""
    fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return sum(map(int, fields[11:15]))


def run(command, folder, call, report=None):
    environment = {**os.environ, **command.environment, "SUBVOL_FAIL": call, "LD_PRELOAD": LIBRARY}
    if report:
        environment["SUBVOL_FAIL_REPORT"] = str(report)
    process = subprocess.Popen([COMMAND, *command.words], cwd=folder, text=True, errors="replace", env=environment,
                               stdout=subprocess.PIPE, stderr=subprocess.PIPE, stdin=subprocess.DEVNULL,
                               start_new_session=True, preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_CPU, (MOST_CPU_S, MOST_CPU_S)))
    ticks = -1
    while True:
        try:
            return Ended(process, *process.communicate(timeout=QUIET_S))
        except subprocess.TimeoutExpired:
            before, ticks = ticks, ticks_of(process.pid)
            if ticks == before:
                waits_for_pool = call.startswith("thread") and "liblog4cplus" in Path(f"/proc/{process.pid}/maps").read_text()
                os.killpg(process.pid, signal.SIGKILL)  # with its children
                process.communicate()
                raise Problem(HANGS_IN_LIBRARY if waits_for_pool else "hangs") from None


def number_of_calls(command, kind):
    with tempfile.TemporaryDirectory() as name, tempfile.TemporaryDirectory() as other:
        report = Path(other) / "report"
        ended = run(command, name, f"{kind}:0", report)
        if ended.code == SKIPPED:
            print("skipped: the kernel does not ask about calls (seccomp)")
            raise SystemExit(SKIPPED)
        if ended.code != 0:
            raise SystemExit(f"{command.name}: {ended.err}")
        return int(report.read_text().split()[1]) if report.exists() else 0


def attempt(command, call):
    """The outcome of one failed call as a word, the command's sentence, and what went wrong with the functions that made the
    call."""
    with tempfile.TemporaryDirectory() as name, tempfile.TemporaryDirectory() as other:
        folder, report = Path(name), Path(other) / "report"
        put_old_files(command, folder)
        ended, outcome, sentence, problem = None, "", "", ""
        try:
            ended = run(command, folder, call, report)
            outcome = judge(ended, {0: "done", 2: "refused", 3: "refused", **({1: "failed cases"} if command.name == "study" else {})})
            sentence = ended.sentence()
            if outcome == "done" and labels(ended.out) != command.labels:
                raise Problem(f"exit code 0, but it printed {ended.out[-300:]!r}")
        except Problem as wrong:
            problem = str(wrong)
        stack = report.read_text() if report.exists() else ""
        if problem == HANGS_IN_LIBRARY or (problem and any(f"/{library}" in stack for library in OF_LIBRARIES)):
            outcome, problem = "library failed", ""
        try:
            whole = check_files(command, folder, old=True)
            if ended and ended.code == 0 and not whole:
                raise Problem("exit code 0, but not all files are there")
        except Problem as wrong:
            problem = f"{problem} {wrong}"
        if problem:
            return "**failed**", "", f"{problem} [code {ended and ended.code}, {ended and ended.err[-200:]!r}]\n{stack}"
        return outcome, sentence, ""


def chosen(first, last, most):
    """At most so many numbers from first to last, evenly spread, with both ends."""
    count = last - first + 1
    if count <= most:
        return range(first, last + 1)
    return sorted({first + round(i * (count - 1) / max(1, most - 1)) for i in range(most)})


def calls_of(command, kind, most, parser_calls):
    """The calls that fail, as the library is told: each alone, and from some of them on."""
    last = number_of_calls(command, kind)
    most = max(1, most // 10) if command.slow else most
    if last == 0:
        return []
    first = min(parser_calls, last) if kind == "alloc" else 1  # what comes before is the same for all commands
    alone = [f"{kind}:{n}" for n in chosen(first, last, most)]
    onward = [f"{kind}:{n}+" for n in chosen(first, last, max(1, most // 5))]
    return alone + onward


class Parser:
    """What all commands do before their own work."""

    name, words, quick, slow, good, environment, labels = "parser", ["--version"], True, False, {}, {}, ["subvol"]


def main():
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    parser = argparse.ArgumentParser()
    parser.add_argument("--most", type=int, default=2000)
    parser.add_argument("--only", nargs="*")
    parser.add_argument("--kinds", nargs="*", default=KINDS)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--table")
    parser.add_argument("--problems", help="a file for all that went wrong, with stacks, and for the sentences")
    arguments = parser.parse_args()
    if SANITIZED or not LIBRARY:
        print("skipped: a sanitized program has its own allocator" if SANITIZED else "skipped: SUBVOL_FAIL_CALLS is not set")
        return SKIPPED

    rows = collections.defaultdict(collections.Counter)
    sentences = collections.Counter()
    problems = []
    with tempfile.TemporaryDirectory() as inputs, concurrent.futures.ThreadPoolExecutor(arguments.jobs) as pool:
        prepare(Path(inputs))
        done = subprocess.run([COMMAND, *Parser.words], capture_output=True, text=True, check=True)
        Parser.labels = labels(done.stdout)
        parser_calls = number_of_calls(Parser, "alloc")
        commands = [command for command in small_commands(Path(inputs))
                    if (command.quick or not arguments.quick or command.name in MENDED) and (not arguments.only or command.name in arguments.only)]
        for command in commands:
            command.run_undisturbed()
        for command in [Parser, *commands] if not arguments.only or "parser" in arguments.only else commands:
            mended = MENDED.get(command.name, []) if arguments.quick else []
            for kind in [*(arguments.kinds if command.quick or not arguments.quick else []), *mended]:
                most = 1000 if kind in mended else arguments.most
                calls = calls_of(command, kind, most, 1 if command is Parser else parser_calls)
                for call, (outcome, sentence, problem) in zip(calls, pool.map(lambda one: attempt(command, one), calls)):
                    rows[command.name, kind][outcome] += 1
                    sentences[kind, re.sub("[0-9]+", "0", sentence.replace(inputs + "/", ""))] += 1
                    if problem:
                        problems.append(f"{command.name}, {call}: {problem}")
                        print(problems[-1].split("\n")[0], file=sys.stderr, flush=True)
    lines = ["| command | kind | calls | outcome |", "|---|---|---:|---|"]
    for (command, kind), outcomes in rows.items():
        told = ", ".join(f"{word} {count}" for word, count in outcomes.most_common())
        lines.append(f"| {command} | {kind} | {sum(outcomes.values())} | {told} |")
    table = "\n".join(lines) + "\n"
    print(table, end="")
    if arguments.table:
        Path(arguments.table).write_text(table)
    if arguments.problems:
        told = [f"{times} {kind}: {sentence}" for (kind, sentence), times in sentences.most_common()]
        Path(arguments.problems).write_text("\n".join(problems + told) + "\n")
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
