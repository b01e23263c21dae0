# SPDX-License-Identifier: Apache-2.0
"""Faults: disks that are full, folders that are read-only, signals at random moments, too little memory, no OpenGL.

    SUBVOL_COMMAND=build/release/bin/subvol python3 tests/cli/faults.py [--signals 200] [--only NAMES] [--table FILE]

runs every command that writes under each of them and prints a table; exit code 1 if anything went wrong. `--quick` is what ctest runs.
After every fault: a file under its final name is whole, or as it was before, or not there; nothing is left beside it, but after
SIGKILL; what failed has said so in one sentence, with the right exit code.
"""

import argparse
import collections
import functools
import os
import random
import resource
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from command import COMMAND, HANGS_AFTER, SANITIZED, children, wait_for_end
from fault_commands import commands, prepare

OLD = b"what was there before"
NO_EGL = {"__EGL_VENDOR_LIBRARY_FILENAMES": "/nonexistent", "LIBGL_DRIVERS_PATH": "/nonexistent", "EGL_PLATFORM": "surfaceless"}
PAGE = 4096
DISASTERS = ("terminate called", "core dumped", "Segmentation", "LLVM ERROR", "Assert", "what():", "Sanitizer")


class Problem(Exception):
    pass


class Ended:
    def __init__(self, process, out, err, killed=False):
        self.code, self.out, self.err, self.killed = process.returncode, out, err, killed

    def sentence(self):
        """The error messages: without warnings and notes, and without messages of libraries, which cannot be suppressed."""
        others = ("subvol: warning: ", "subvol: note: ", "libpng error: ", "Fatal glibc error: ", "Error in GnuTLS initialization: ")
        lines = [line for line in self.err.splitlines() if not line.startswith(others)]
        for word in DISASTERS:
            if word in self.err:
                raise Problem(f"said {word!r}: {self.err[-300:]!r}")
        if any(not line.startswith("subvol: ") for line in lines) or len(lines) > 1:
            raise Problem(f"said {self.err[-300:]!r}")
        return lines[0] if lines else ""


def start(command, folder, environment=None, limits=(), **streams):
    def limit():
        for what, most in limits:
            resource.setrlimit(what, (most, most))

    return subprocess.Popen([COMMAND, *command.words], cwd=folder, text=True, errors="replace", preexec_fn=limit,
                            env={**os.environ, **command.environment, **(environment or {})},
                            **{"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, **streams})


def run(command, folder, *arguments, **keywords):
    process = start(command, folder, *arguments, **keywords)
    return Ended(process, *process.communicate(timeout=HANGS_AFTER))


def put_old_files(command, folder):
    for name in command.good:
        if "/" not in name:
            # A list of grids is replaced by another one only.
            (folder / name).write_bytes(command.good[name] if name.endswith(".json") else OLD)


def check_files(command, folder, old=False, killed=False):
    """True if all of the output exists and is complete. old: there were files before"""
    lost = [name for name in command.good if old and "/" not in name and not (folder / name).exists()]
    if lost:
        raise Problem(f"lost {lost}")
    whole = 0
    for path in sorted(p for p in folder.rglob("*") if p.is_file()):
        name = str(path.relative_to(folder))
        if name not in command.good:
            if killed and path.name.startswith("."):
                continue
            if ".unfinished/" in name:  # `split` goes on from there
                continue
            raise Problem(f"left {name}")
        content = path.read_bytes()
        if content == OLD:
            continue
        if not command.is_whole(name, path, content):
            raise Problem(f"{name} is not whole ({len(content)} bytes)")
        whole += 1
    return whole == len(command.good)


def judge(ended, expected):
    """The outcome as a word. expected: exit code -> word"""
    if ended.code not in expected:
        raise Problem(f"exit code {ended.code}, said {ended.err[-300:]!r}")
    sentence = ended.sentence()
    if ended.code > 1 and not sentence.rstrip(": ").partition(": ")[2]:
        raise Problem(f"exit code {ended.code} without a sentence")
    return expected[ended.code]


class Table:
    def __init__(self):
        self.rows = collections.defaultdict(collections.Counter)
        self.problems = []

    def attempt(self, command, fault, work):
        try:
            outcome = work()
        except Problem as problem:
            outcome = "**failed**"
            self.problems.append(f"{command.name}, {fault}: {problem}")
            print(self.problems[-1], file=sys.stderr, flush=True)
        self.rows[command.name, fault][outcome] += 1

    def skip(self, command, fault, reason):
        self.rows[command.name, fault][f"skipped: {reason}"] += 0

    def markdown(self):
        lines = ["| command | fault | times | outcome |", "|---|---|---:|---|"]
        for (command, fault), outcomes in self.rows.items():
            told = [word if len(outcomes) == 1 else f"{word} {count}" for word, count in outcomes.most_common()]
            lines.append(f"| {command} | {fault} | {sum(outcomes.values())} | {', '.join(told)} |")
        return "\n".join(lines) + "\n"


class Mounted:
    """A small file system mounted at a folder."""

    def __init__(self, bytes_):
        self.bytes = bytes_

    def __enter__(self):
        self.holder = tempfile.TemporaryDirectory()
        self.folder = Path(self.holder.name) / "disk"
        self.folder.mkdir()
        done = subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={self.bytes}", "tmpfs", self.folder], capture_output=True)
        if done.returncode != 0:
            self.holder.cleanup()
            raise PermissionError
        return self

    def make_read_only(self):
        subprocess.run(["mount", "-o", "remount,ro", self.folder], check=True)

    def __exit__(self, *_):
        subprocess.run(["umount", "-l", self.folder], check=True)
        self.holder.cleanup()


class Faults:
    def __init__(self, table, quick):
        self.table, self.quick = table, quick

    def failed_or_done(self, command, folder, ended, codes):
        outcome = judge(ended, {0: "done", **codes, **({1: "told as cases that failed"} if command.name == "study" else {})})
        whole = check_files(command, folder, old=True)
        if outcome == "done" and not whole:
            raise Problem("exit code 0, but not all files are there")
        return outcome

    def full_disk(self, command):
        if not command.good:
            return
        pages = sum(-(-len(content) // PAGE) for content in command.good.values())
        more = {0, pages // 2} if self.quick else {0, 1, pages // 2, pages - 1}  # pages beyond those of the old files
        for size in sorted(PAGE * (len(command.good) + pages) for pages in more):
            def attempt():
                with Mounted(size) as disk:
                    put_old_files(command, disk.folder)
                    return self.failed_or_done(command, disk.folder, run(command, disk.folder), {2: "refused (2), old files kept"})
            try:
                self.table.attempt(command, "disk full", attempt)
            except PermissionError:
                return self.table.skip(command, "disk full", "mount is not allowed")

    def long_file(self, command):
        if not command.good:
            return
        longest = max(len(content) for content in command.good.values())
        for size in (longest // 2,) if self.quick else (0, longest // 2, longest - 1):
            def attempt():
                with tempfile.TemporaryDirectory() as name:
                    put_old_files(command, Path(name))
                    ended = run(command, name, limits=[(resource.RLIMIT_FSIZE, size)])
                    return self.failed_or_done(command, Path(name), ended, {2: "refused (2), old files kept"})
            self.table.attempt(command, "file size limit", attempt)

    def read_only_folder(self, command):
        if not command.good:
            return
        def attempt():
            with Mounted(1 << 20) as disk:
                put_old_files(command, disk.folder)
                disk.make_read_only()
                return self.failed_or_done(command, disk.folder, run(command, disk.folder), {2: "refused (2), old files kept"})
        try:
            self.table.attempt(command, "read-only folder", attempt)
        except PermissionError:
            self.table.skip(command, "read-only folder", "mount is not allowed")

    def full_output(self, command):
        def attempt():
            with tempfile.TemporaryDirectory() as name, open("/dev/full", "w") as full:
                ended = run(command, name, stdout=full)
                outcome = judge(ended, {2: "said so (2), files whole"})
                if not check_files(command, Path(name)) and command.name not in ("study", "demo"):
                    raise Problem("the files are not there")
                return outcome
        self.table.attempt(command, "standard output full", attempt)

    def closed_streams(self, command):
        def attempt():
            with tempfile.TemporaryDirectory() as name:
                process = subprocess.run(["sh", "-c", 'exec "$0" "$@" <&- >&- 2>&-', COMMAND, *command.words], cwd=name,
                                         env={**os.environ, **command.environment})
                if process.returncode != 2:
                    raise Problem(f"exit code {process.returncode}")
                check_files(command, Path(name))
                return "refused (2), files whole"
        self.table.attempt(command, "all streams closed", attempt)

    def signals(self, command, times, seed):
        luck = random.Random(f"{seed}{command.name}")
        codes = {signal.SIGINT: 130, signal.SIGTERM: 143, signal.SIGPIPE: 141, signal.SIGKILL: None}
        for turn in range(times):
            sent = list(codes)[turn % len(codes)]
            def attempt():
                with tempfile.TemporaryDirectory() as name:
                    old = luck.random() < 0.5
                    if old:
                        put_old_files(command, Path(name))
                    process = start(command, name)
                    time.sleep(luck.uniform(0, 1.05 * command.seconds))
                    running = children(process.pid)
                    process.send_signal(sent)
                    return self.after_signal(command, Path(name), process, running, sent, codes[sent], old)
            self.table.attempt(command, sent.name, attempt)

    def after_signal(self, command, folder, process, running, sent, code, old):
        try:
            ended = Ended(process, *process.communicate(timeout=HANGS_AFTER))
        except subprocess.TimeoutExpired:
            process.kill()
            process.communicate()
            raise Problem(f"did not stop within {HANGS_AFTER} s") from None
        wait_for_end(running)  # children end with their parent
        killed = sent == signal.SIGKILL
        whole = check_files(command, folder, old, killed)
        if ended.code == 0:
            if not whole:
                raise Problem("exit code 0, but not all files are there")
            return "done before"
        if ended.code == -sent:  # before it catches signals
            ended.sentence()
            return "ended (137)" if killed else f"ended ({128 + sent})"
        if sent == signal.SIGPIPE:  # nobody reads what it says, so it says nothing
            if ended.code != code or ended.sentence():
                raise Problem(f"exit code {ended.code}, said {ended.err[-300:]!r}")
            return f"ended ({code})"
        judge(ended, {code: ""})
        return f"ended ({code})"

    def memory(self, command):
        if SANITIZED:  # it needs all addresses
            return
        for mib in (0, 50) if self.quick else (0, 10, 20, 40, 60, 80, 120, 160, 240, 320, 480):
            def attempt():
                with tempfile.TemporaryDirectory() as name:
                    put_old_files(command, Path(name))
                    ended = run(command, name, limits=[(resource.RLIMIT_AS, least_addresses() + (mib << 20))])
                    return self.failed_or_done(command, Path(name), ended, {3: "refused (3), old files kept"})
            self.table.attempt(command, "memory limit", attempt)

    def no_opengl(self, command):
        if not command.name.startswith("render"):
            return
        def attempt():
            with tempfile.TemporaryDirectory() as name:
                put_old_files(command, Path(name))
                ended = run(command, name, NO_EGL)
                return self.failed_or_done(command, Path(name), ended, {3: "refused (3), old files kept"} if command.opengl else {})
        self.table.attempt(command, "no OpenGL", attempt)


@functools.cache
def least_addresses():
    """Bytes of addresses that the program needs to start: with less, its libraries end it before main()."""
    low, high = 1 << 20, 1 << 34
    while high - low > 1 << 20:
        middle = (low + high) // 2
        done = subprocess.run([COMMAND, "--version"], capture_output=True,
                              preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (middle, middle)))
        low, high = (low, middle) if done.returncode == 0 else (middle, high)
    return high + (4 << 20)  # addresses differ from run to run


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--signals", type=int, default=200)
    parser.add_argument("--only", nargs="*")
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--table")
    arguments = parser.parse_args()
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))

    table = Table()
    faults = Faults(table, arguments.quick)
    with tempfile.TemporaryDirectory() as inputs:
        chosen = [command for command in commands(Path(inputs))
                  if (command.quick or not arguments.quick) and (not arguments.only or command.name in arguments.only)]
        prepare(Path(inputs))
        for index, command in enumerate(chosen):
            command.run_undisturbed()
            for fault in (faults.full_disk, faults.long_file, faults.read_only_folder, faults.full_output, faults.closed_streams,
                          faults.memory, faults.no_opengl):
                fault(command)
            share = arguments.signals // len(chosen) + (index < arguments.signals % len(chosen))
            faults.signals(command, share, arguments.seed)
    print(table.markdown(), end="")
    if arguments.table:
        Path(arguments.table).write_text(table.markdown())
    return 1 if table.problems else 0


if __name__ == "__main__":
    sys.exit(main())
