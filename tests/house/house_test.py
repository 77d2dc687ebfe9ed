"""The house rules of docs/architecture.md: which library may use which, how large things get, and
that every link within the documents leads to a file and a heading that are there.

Usage: house_test.py REPOSITORY
"""

import collections
import pathlib
import re
import subprocess
import sys

MOST_FILES = 25  # of sources in a folder
MOST_LINES = 400  # of a source
MOST_APP_LINES = 2500  # of host/app in all
MOST_BODY = 60  # lines of a function, from the line of its brace on; kernels hold their data in
                # registers from end to end and are exempt

# What sim/ may use of host/: it knows neither devices nor correlation, so that truth stays
# independent of the solver.
GROUND_FLOOR = {"host/api", "host/base", "host/clip", "host/impact", "host/sphere"}

# Loops and pipelines of oneTBB begin in one place, which also tells ThreadSanitizer their order.
PARALLEL = "host/base/parallel/"
# Who has threads of its own: work that waits (host/base/parallel/parallel_for.h).
THREADS = {
    "host/benchmark/method_rows.cpp": "devices",
    "host/cluster/heartbeat.h": "the clock",
    "host/opencl/ahead/compile_ahead.cpp": "child processes",
    "host/opencl/ahead/main.cpp": "its caller's end",
    "host/opencl/engine.cpp": "a device",
    "host/pipeline/correlate_clip.cpp": "a device",
    "host/pipeline/device_workers.cpp": "devices",
    "host/python/job.cpp": "a whole run",
    "host/report/fields_file.cpp": "the disk",
    "host/run/batch/batch.cpp": "whole runs",
    "host/run/batch/shared_batch.cpp": "whole runs",
    "host/run/folder.cpp": "the disk",
    "host/run/live/live_run.cpp": "the sender of frames",
    "host/run/results/folder_lock.cpp": "the clock",
    "host/run/results/folder_lock.h": "the clock",
    "host/run/session.cpp": "devices",
    "host/video/clip_digest.cpp": "the disk",
    "host/view/run_job.cpp": "a whole run",
    "host/view/run_job.h": "a whole run",
    "host/view/server.cpp": "a socket",
    "host/view/view.cpp": "a child process",
}


def sources(root):
    names = subprocess.check_output(["git", "ls-files"], cwd=root, text=True).splitlines()
    return [n for n in names if n.endswith((".cpp", ".h", ".cl", ".py")) and (root / n).exists()]


def library(path):
    """host/dic/frames/x.h -> host/dic; kernels/zncc/x.h -> kernels."""
    parts = path.split("/")
    return "/".join(parts[:2]) if parts[0] in ("host", "sim") else parts[0]


def order(root, folder):
    """The libraries of host/ or sim/ in the order of its CMakeLists.txt."""
    text = (root / folder / "CMakeLists.txt").read_text()
    return [f"{folder}/{name}" for name in re.search(r"foreach\(part ([^)]*)\)", text)[1].split()]


def arrows(root, names):
    """(library, library it uses) -> where, by every #include of our own."""
    found = collections.defaultdict(list)
    for name in names:
        if not name.endswith((".cpp", ".h")):
            continue
        for line in (root / name).read_text().splitlines():
            match = re.match(r'#include (?:"((?:host|sim|kernels|bench|tests)/[^"]+)"|<impactdic/)', line)
            if match:
                used = library(match[1]) if match[1] else "host/api"
                if used != library(name):
                    found[library(name), used].append(f"{name}: {line}")
    return found


def wrong_arrows(root, names):
    host, sim = order(root, "host"), order(root, "sim")
    wrong = []
    for (user, used), where in arrows(root, names).items():
        if used == "kernels" or user.split("/")[0] in ("tests", "bench"):
            continue  # the headers that kernels share lie below everything; nothing uses those
        if user == "docs":  # the examples know what is installed
            right = used == "host/api"
        elif user.startswith("host/") and used.startswith("host/"):
            right = host.index(used) < host.index(user)
        elif user.startswith("sim/"):
            right = used in GROUND_FLOOR or (used in sim and sim.index(used) < sim.index(user))
        else:
            right = used.startswith("sim/") and user in (
                "host/study", "host/benchmark", "host/run", "host/report", "host/app")
        if not right:
            wrong += where
    return wrong


def functions(text):
    """(line, number of lines) of every function of C++ that scripts/format has laid out."""
    indents, opened = [""], None  # of the types that the line lies in, after namespaces
    for number, line in enumerate(text.splitlines(), 1):
        if opened is not None:
            if line.startswith(indents[-1] + "}"):
                yield opened, number - opened + 1
                opened = None
        elif len(indents) > 1 and line.startswith(indents[-2] + "}"):
            indents.pop()
        elif line.endswith("{") and not re.match(r" *//|#|(inline )?namespace|extern", line):
            if re.match(r" *(template .*)?(class|struct|union|enum)\b[^(]*$", line):
                indents.append(indents[-1] + "  ")
            elif not line.endswith("= {"):
                opened = number


def long_functions(root, names):
    for name in names:
        if not name.endswith((".cpp", ".h")) or name.startswith("kernels/"):
            continue
        for line, count in functions((root / name).read_text()):
            if count > MOST_BODY:
                yield f"{name}:{line}: a function of {count} lines"


def anchor(heading):
    """The address of a heading within its page, as GitHub makes it."""
    words = re.sub(r"\[([^]]*)\]\([^)]*\)", r"\1", heading).lower()
    return re.sub(r"[^\w\- ]", "", words).strip().replace(" ", "-")


def dead_links(root):
    names = subprocess.check_output(["git", "ls-files", "*.md"], cwd=root, text=True).splitlines()
    pages = {(root / n).resolve(): re.sub(r"```.*?```|`[^`\n]*`", "", (root / n).read_text(),
                                          flags=re.S) for n in names if (root / n).exists()}
    headings = {page: {anchor(h) for h in re.findall(r"^#+ (.*)", page.read_text(), flags=re.M)}
                for page in pages}
    for page, text in pages.items():
        for link in re.findall(r"\]\(([^)\s]+)\)", text):
            if link.startswith("http"):
                continue
            path, _, place = link.partition("#")
            target = (page.parent / path).resolve() if path else page
            if not target.exists() or (place and target in headings
                                       and place not in headings[target]):
                yield f"{page.relative_to(root)}: no {link}"


def stray_threads(root, names):
    for name in names:
        if not name.endswith((".cpp", ".h")) or name.split("/")[0] not in ("host", "sim"):
            continue
        if name.startswith(PARALLEL):
            continue
        text = (root / name).read_text()
        if re.search(r"#include <(oneapi/)?tbb/(parallel_|flow_graph|task_group)", text):
            yield f"{name}: work in parallel that does not go through {PARALLEL}"
        if name not in THREADS and re.search(r"std::(async\(|j?thread\b(?!::))", text):
            yield f"{name}: a thread of its own that {pathlib.Path(__file__).name} does not know"


def main(root):
    names = sources(root)
    faults = wrong_arrows(root, names)
    folders = collections.Counter(str(pathlib.PurePath(n).parent) for n in names)
    faults += [f"{folder}: {n} sources" for folder, n in folders.items() if n > MOST_FILES]
    lines = {n: len((root / n).read_text().splitlines()) for n in names}
    faults += [f"{name}: {n} lines" for name, n in lines.items() if n > MOST_LINES]
    app = sum(n for name, n in lines.items() if name.startswith("host/app/"))
    if app > MOST_APP_LINES:
        faults.append(f"host/app: {app} lines")
    faults += long_functions(root, names)
    faults += dead_links(root)
    faults += stray_threads(root, names)
    for fault in faults:
        print(fault)
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main(pathlib.Path(sys.argv[1]).resolve()))
