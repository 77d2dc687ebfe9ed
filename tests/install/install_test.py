#!/usr/bin/env python3
"""install_test.py Tree|Headers|Layout|Symbols|Package|Examples: the installed tree from outside.

Tree installs the build into an empty prefix and moves it; the others use what it left.
IMPACTDIC_BUILD names the build folder; the rest of the environment is in CMakeLists.txt.
"""

import os
import re
import shutil
import subprocess
import sys
import unittest
from concurrent.futures import ThreadPoolExecutor

sys.dont_write_bytecode = True

from example_runs import Examples  # noqa: E402, F401
from installed import (  # noqa: E402
    BUILD, CMAKE, OPTIONS, PREFIX, SCRATCH, SOURCE, compiled, compilers, empty, find, headers, run)

# Neither a folder nor a dot: a header of the standard library. Ours are the only folders.
ALLOWED_INCLUDE = re.compile(r'#include <(impactdic/(\w+/)?\w+\.h|[a-z_]+)>$')
STANDARDS = ("c++20", "c++23")  # the least that docs/api.md asks for, and the next one


class Tree(unittest.TestCase):
    """What `cmake --install` puts where."""

    @classmethod
    def setUpClass(cls):
        first = empty("first") / "prefix"
        run(CMAKE, "--install", BUILD, "--prefix", first)
        shutil.rmtree(SCRATCH / "moved", ignore_errors=True)
        PREFIX.parent.mkdir(parents=True)
        first.rename(PREFIX)  # nothing may point to where it was

    def test_everything_is_there(self):
        for path in ("bin/impactdic", "include/impactdic/impactdic.h",
                     "include/impactdic/version.h", "share/man/man1/impactdic.1",
                     "share/bash-completion/completions/impactdic",
                     "share/doc/impactdic/LICENSE",
                     "share/doc/impactdic/examples/CMakeLists.txt",
                     "share/impactdic/scripts/impactdic/report/__main__.py"):
            self.assertTrue((PREFIX / path).is_file(), path)
        for name in ("libimpactdic.so", "impactdicConfig.cmake", "impactdicConfigVersion.cmake",
                     "impactdicTargets.cmake", "impactdic.pc", "impactdic-compile"):
            find(name)

    def test_every_public_header_is_installed_and_in_the_one_that_has_all(self):
        source, installed = SOURCE / "host" / "api" / "impactdic", PREFIX / "include" / "impactdic"
        written = {path.relative_to(source).as_posix() for path in source.rglob("*.h")}
        self.assertEqual({path.relative_to(installed).as_posix() for path in headers()},
                         written | {"version.h"})
        text = (installed / "impactdic.h").read_text()
        self.assertEqual(set(re.findall(r"<impactdic/([\w/]+\.h)>", text)),
                         (written | {"version.h"}) - {"impactdic.h"})

    def test_no_path_of_the_build_is_left(self):
        for path in PREFIX.rglob("*"):
            if path.is_file() and not path.is_symlink():
                content = path.read_bytes()
                if b"\0" in content:
                    continue
                for folder in (SOURCE, BUILD, SCRATCH):
                    self.assertNotIn(str(folder).encode(), content, path)
        for binary in (PREFIX / "bin" / "impactdic", find("libimpactdic.so")):
            for path in re.findall(r"R(?:UN)?PATH.*\[(.*)\]", run("readelf", "-d", binary)):
                self.assertRegex(path, r"^\$ORIGIN/[^:]*impactdic$")  # where its modules lie

    def test_a_staged_install_has_the_same_files(self):
        stage = empty("stage")
        run(CMAKE, "--install", BUILD, "--prefix", "/opt/some/where",
            env={**os.environ, "DESTDIR": str(stage)})
        staged = stage / "opt" / "some" / "where"
        names = [sorted(str(p.relative_to(top)) for p in top.rglob("*")) for top in (PREFIX, staged)]
        self.assertEqual(names[0], names[1])
        self.assertEqual({path.name for path in stage.iterdir()}, {"opt"})
        shutil.rmtree(stage)

    def test_the_program_runs_and_finds_what_it_needs(self):
        program = PREFIX / "bin" / "impactdic"
        text = run(program, "--help")
        page = (PREFIX / "share/man/man1/impactdic.1").read_text()
        commands = re.findall(r"^  (\w+) {2,}", text.split("Subcommands:")[1], re.M)
        self.assertGreater(len(commands), 10)
        for command in commands:
            self.assertIn(f".SS impactdic {command} ", page)
            for option in re.findall(r"^  (?:-\w,)?(--[\w-]+)", run(program, command, "--help-all"), re.M):
                self.assertIn(option.replace("-", "\\-"), page, command)
        # Its Python part: the error is about the folder, not about scripts that are missing.
        nothing = empty("nothing")
        done = subprocess.run([program, "report", nothing], capture_output=True, text=True)
        self.assertNotEqual(done.returncode, 0)
        self.assertNotIn("scripts are missing", done.stderr)

    def test_the_man_page_is_well_formed(self):
        if shutil.which("man") is None:
            self.skipTest("man is not installed")
        done = subprocess.run(["man", "--warnings", "-l", PREFIX / "share/man/man1/impactdic.1"],
                              capture_output=True, text=True, env={**os.environ, "LC_ALL": "C.UTF-8"})
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assertIn("EXIT STATUS", done.stdout)

    def test_the_completion_completes(self):
        file = PREFIX / "share/bash-completion/completions/impactdic"

        def complete(*words):
            script = (f'source "{file}"; COMP_WORDS=({" ".join(words)} ""); '
                      f'COMP_WORDS[{len(words) - 1}]="{words[-1]}"; COMP_CWORD={len(words) - 1}; '
                      '_impactdic; printf "%s\\n" "${COMPREPLY[@]}"')
            return run("bash", "-c", script, cwd=SOURCE).split()

        self.assertEqual(complete("impactdic", "tra"), ["track"])
        self.assertEqual(complete("impactdic", "track", "--ball-diameter-m"), ["--ball-diameter-mm"])
        self.assertEqual(complete("impactdic", "track", "--overl"), ["--overlay"])
        self.assertEqual(complete("impactdic", "track", "READM"), ["README.md"])


class Headers(unittest.TestCase):
    """Each header alone, with nothing but the installed include folder."""

    def test_they_include_the_standard_library_and_each_other_alone(self):
        for header in headers():
            for line in header.read_text().splitlines():
                if line.lstrip().startswith("#include"):
                    self.assertRegex(line, ALLOWED_INCLUDE, header)

    def test_what_they_declare_is_shown(self):
        for header in headers():
            for line in header.read_text().splitlines():
                if line.startswith("namespace"):
                    self.assertEqual(line, "namespace IMPACTDIC_PUBLIC impactdic {", header)

    def test_each_compiles_alone_without_a_warning(self):
        found = list(compilers(self.id()))
        # The build compiles each alone with its own compiler (host/api); here another one does.
        jobs = [(*found[-1], header, STANDARDS[0]) for header in headers()]
        jobs += [(name, path, PREFIX / "include/impactdic/impactdic.h", standard)
                 for name, path in found for standard in STANDARDS]
        self.assertGreater(len(jobs), 10)

        folder = empty("headers")

        def build(number, job):
            _, compiler, header, standard = job
            newer = "c++2b" if standard == "c++23" else standard  # as Clang 14 calls it
            source = folder / f"{number}.cpp"
            source.write_text(f"#include <{header.relative_to(PREFIX / 'include')}>\n")
            compiled(compiler, f"-std={newer}", "-Wall", "-Wextra", "-Wpedantic", "-Werror", "-I",
                     PREFIX / "include", source, "-o", source.with_suffix(".o"))

        with ThreadPoolExecutor(os.cpu_count()) as pool:
            list(pool.map(build, range(len(jobs)), jobs))


def layouts(compiler, *options):
    """Name, size and alignment of each type that the headers lead to, and its members' offsets."""
    source = empty("layout") / "all.cpp"
    source.write_text("#include <impactdic/impactdic.h>\n")
    binary = source.with_suffix(".o")
    compiled(compiler, "-std=c++20", "-g", "-gdwarf-4", "-fno-eliminate-unused-debug-types", "-I",
             PREFIX / "include", *options, source, "-o", binary)
    found = []
    for line in run("readelf", "--debug-dump=info", binary).splitlines():
        tag = re.search(r"\((DW_TAG_(?:structure|class|union|enumeration)_type|DW_TAG_member)\)", line)
        fact = re.search(r"(DW_AT_(?:name|byte_size|alignment|data_member_location))\s*: (.*)", line)
        if tag:
            found.append([tag.group(1)])
        elif "Abbrev Number" in line:
            found.append(None)
        elif fact and found and found[-1]:
            found[-1].append((fact.group(1), fact.group(2).split("): ")[-1].strip()))
    return [entry for entry in found if entry]


class Layout(unittest.TestCase):
    """A caller for an older or newer processor agrees with the library on every type."""

    def test_it_does_not_depend_on_march(self):
        gcc = dict(compilers(self.id()))["GCC"]
        plain = layouts(gcc)
        text = str(plain)
        for name in ("TrackRequest", "TrackResult", "MemoryClip", "Image<unsigned char>"):
            self.assertIn(f"'{name}'", text)
        self.assertGreater(text.count("data_member_location"), 300)
        for options in (["-march=x86-64-v3"], ["-march=x86-64-v4", "-O2"], OPTIONS):
            self.assertEqual(plain, layouts(gcc, *options), options)


class Symbols(unittest.TestCase):
    """The shared library shows the public functions, and nothing else."""

    def test_what_is_exported_stands_in_a_header(self):
        text = "".join(header.read_text() for header in headers())
        words = set(re.findall(r"\w+", text))
        classes = set(re.findall(r"(?:struct|class) (\w+)", text))
        listing = run("nm", "-D", "-C", "--defined-only", find("libimpactdic.so")).splitlines()
        names = [line.split(" ", 2)[2] for line in listing]
        self.assertGreater(len(names), 50)
        for name in names:
            ours = set(re.findall(r"impactdic::(\w+)", name))
            self.assertTrue(ours and ours <= words and "::Impl" not in name, name)
            self.assertLessEqual(set(re.findall(r"impactdic::(\w+)::", name)), classes, name)
        for function in ("track(", "correlate(", "open_clip(", "clip_from_memory(", "version("):
            self.assertTrue(any(name.startswith("impactdic::" + function) for name in names), function)

    def test_its_name_carries_the_version(self):
        major, minor, _ = version().split(".")
        entries = run("readelf", "-d", find("libimpactdic.so"))
        self.assertIn(f"[libimpactdic.so.{major}.{minor}]", entries)


def version():
    return run(PREFIX / "bin" / "impactdic", "--version").split()[-1]


class Package(unittest.TestCase):
    """What find_package and pkg-config say."""

    def configure(self, request, status):
        folder = empty("version")
        (folder / "CMakeLists.txt").write_text(
            f"cmake_minimum_required(VERSION 3.16)\nproject(version LANGUAGES NONE)\n"
            f"find_package(impactdic {request} REQUIRED)\n"
            "if(NOT TARGET impactdic::impactdic)\n  message(FATAL_ERROR \"no target\")\nendif()\n")
        run(CMAKE, "-S", folder, "-B", folder / "build", f"-DCMAKE_PREFIX_PATH={PREFIX}",
            status=status)

    def test_a_version_that_fits_is_found_and_another_is_not(self):
        major, minor, _ = map(int, version().split("."))
        self.configure("", 0)
        self.configure(f"{major}.{minor}", 0)
        self.configure(f"{major}.{minor + 1}", 1)
        self.configure(f"{major + 1}.0", 1)

    def test_pkg_config(self):
        if shutil.which("pkg-config") is None:
            self.skipTest("pkg-config is not installed")
        found = {**os.environ, "PKG_CONFIG_PATH": str(find("impactdic.pc").parent)}
        self.assertEqual(run("pkg-config", "--modversion", "impactdic", env=found).strip(), version())
        folder = empty("pkg-config")
        (folder / "main.cpp").write_text(
            "#include <impactdic/version.h>\n#include <cstdio>\n"
            "int main() { std::printf(\"%s %s\", IMPACTDIC_VERSION, impactdic::version()); }\n")
        flags = run("pkg-config", "--cflags", "--libs", "impactdic", env=found).split()
        compiler = next(iter(compilers(self.id())))[1]
        run(compiler, "-std=c++20", folder / "main.cpp", "-o", folder / "main", *flags)
        library = find("libimpactdic.so").parent
        self.assertEqual(run(folder / "main", env={**os.environ, "LD_LIBRARY_PATH": str(library)}),
                         f"{version()} {version()}")


if __name__ == "__main__":
    unittest.main(verbosity=2)
