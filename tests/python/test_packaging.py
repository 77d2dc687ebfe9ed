"""What the packages for Debian and for Python say of the project is what the project says."""

import re

from conftest import SOURCE, program


def text(*path):
    return SOURCE.joinpath(*path).read_text(encoding="utf-8")


def field(name, control):
    """The words of a field of debian/control, without versions and alternatives."""
    found = re.search(rf"^{name}:((?:.*\n)(?: .*\n)*)", control, re.MULTILINE).group(1)
    return {part.split("|")[0].split("(")[0].strip() for part in found.split(",") if part.strip()}


def test_one_version():
    version = re.search(r"project\(impactdic VERSION ([0-9.]+)", text("CMakeLists.txt")).group(1)
    assert text("debian", "changelog").startswith(f"impactdic ({version})")
    assert version in program("--version").stdout
    library = "libimpactdic" + ".".join(version.split(".")[:2])  # its SOVERSION
    assert f"Package: {library}\n" in text("debian", "control")
    assert (SOURCE / "debian" / f"{library}.install").exists()


def test_the_build_needs_what_setup_installs():
    setup = text("scripts", "setup")
    wanted = set(re.search(r"^packages=\((.*?)^\)", setup, re.MULTILINE | re.DOTALL).group(1)
                 .replace("#", "\n#").split())
    listed = {word for word in wanted if word.startswith("lib") and word.endswith("-dev")}
    listed |= wanted & {"nlohmann-json3-dev", "ocl-icd-opencl-dev", "zlib1g-dev", "opencl-headers"}
    only_tests = {"libgtest-dev", "libbenchmark-dev"}
    assert len(listed) > 15
    assert listed - only_tests <= field("Build-Depends", text("debian", "control"))


def test_the_program_needs_what_its_page_needs():
    from impactdic.report.__main__ import NEEDED

    control = text("debian", "control")
    program_part = control[control.index("Package: impactdic\n"):]
    assert set(NEEDED.values()) <= field("Depends", program_part)
