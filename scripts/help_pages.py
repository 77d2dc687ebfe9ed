#!/usr/bin/env python3
"""help_pages.py man|bash PROGRAM OUT: the man page or bash's completion, from the program's --help-all.

The build writes both for `cmake --install`. scripts/command_reference writes docs/commands.md out of
the same.
"""
import re
import subprocess
import sys

TEXT_COLUMN = 30  # where the help begins the text of a term; a longer term has it on the next line


class Help:
    """One --help-all: description, usage, footer, and its lists: positionals, subcommands, and the
    options of all groups, each as [(term, text), ...]."""

    def __init__(self, program, *command):
        run = subprocess.run([program, *command, "--help-all"], capture_output=True, check=True,
                             text=True)
        head, *blocks = run.stdout.strip().split("\n\n")
        self.description, self.usage = head.split("\nUsage: ")
        self.lists, self.footer = {}, []
        for block in blocks:
            heading, *lines = block.split("\n")
            if heading in ("Positionals:", "Subcommands:"):
                self.lists[heading[:-1]] = entries(lines)
            elif heading.endswith(":") and lines and lines[0].startswith("  -"):
                self.lists.setdefault("Options", []).extend(entries(lines))
            else:
                self.footer += [heading, *lines]

    def rows(self, heading):
        return self.lists.get(heading, [])


def entries(lines):
    found = []
    for line in lines:
        if line.startswith(" " * TEXT_COLUMN):
            found[-1] = ("".join(found[-1]).strip(), line.strip())
        else:
            found.append((line[:TEXT_COLUMN], line[TEXT_COLUMN:]))
    return [(term.strip(), text.strip()) for term, text in found]


def names_of(term):
    return [name for name in term.split()[0].split(",") if name.startswith("-")]


def roff(text):
    text = text.replace("\\", "\\e").replace("-", "\\-")
    return "\\&" + text if text.startswith((".", "'")) else text


def roff_rows(rows):
    return [line for term, text in rows for line in (".TP", f"\\fB{roff(term)}\\fR", roff(text))]


def roff_footer(lines):
    """Sentences one below the other; examples as they are typed."""
    out = []
    for line in lines:
        if line.startswith("  "):
            out += [".PP", ".nf", roff(line.strip()), ".fi"]
        else:
            out += [".PP", roff(line)]
    return out


def man_page(version, main, commands):
    out = [f'.TH IMPACTDIC 1 "" "impactdic {version}" "User Commands"', ".SH NAME",
           "impactdic \\- " + roff("measure impacts filmed by high-speed cameras"),
           ".SH SYNOPSIS", "\\fBimpactdic\\fR \\fICOMMAND\\fR [\\fIOPTIONS\\fR]",
           ".SH DESCRIPTION", roff(main.description), ".SH OPTIONS",
           *roff_rows(main.rows("Options")), ".SH COMMANDS"]
    for name, page in commands.items():
        out += [f".SS {roff(page.usage)}", roff(page.description) + "."]
        out += roff_rows(page.rows("Positionals")) + roff_rows(page.rows("Options"))
        out += roff_footer(page.footer)
    out += [".SH EXIT STATUS", "0: done. 1: the work failed (a file, a device, the disk). "
            "2: the request was wrong. An error is one line on stderr.",
            ".SH ENVIRONMENT", ".TP", "\\fBIMPACTDIC_CACHE_DIR\\fR",
            roff("Folder of compiled kernels; without it a folder of the user's cache."),
            ".TP", "\\fBIMPACTDIC_COMPILERS\\fR",
            roff("How many processes compile kernels that are not in that folder; 0: none beside this "
                 "one. Without it as many as help."),
            ".TP", "\\fBIMPACTDIC_PYTHON\\fR", roff("The Python that draws reports.")]
    return "\n".join(out) + "\n"


def takes_value(term):
    return len(term.split()) > 1


def is_number(term):
    return re.search(r"\b(FLOAT|INT|UINT)\b", term) is not None


def values_of(term):
    """Of `--x TEXT:{a,b}` the words a and b."""
    words = re.search(r"\{([^}]*)\}", term)
    return words.group(1).split(",") if words else []


def bash_cases(rows):
    """What stands after an option: one of its words, a number (nothing to offer) or a file."""
    cases = []
    for term, _ in rows:
        pattern = "|".join(names_of(term))
        if values_of(term):
            words = " ".join(values_of(term))
            cases.append(f'        {pattern}) COMPREPLY=($(compgen -W "{words}" -- "$word")); return;;')
        elif takes_value(term) and is_number(term):
            cases.append(f"        {pattern}) return;;")
        elif takes_value(term):
            cases.append(f'        {pattern}) COMPREPLY=($(compgen -f -- "$word")); return;;')
    return cases


def bash_completion(_, main, commands):
    out = ["# Completion of impactdic for bash, out of the program's --help-all.", "_impactdic() {",
           '  local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD - 1]} options',
           "  compopt -o filenames 2> /dev/null", "  COMPREPLY=()", "  if [ $COMP_CWORD -eq 1 ]; then"]
    first = " ".join([*commands, *(n for t, _ in main.rows("Options") for n in names_of(t))])
    out += [f'    COMPREPLY=($(compgen -W "{first}" -- "$word"))', "    return", "  fi",
            '  case ${COMP_WORDS[1]} in']
    for name, page in commands.items():
        rows = page.rows("Options")
        cases = bash_cases(rows)
        out.append(f"    {name})")
        if cases:
            out += ["      case $before in", *cases, "      esac"]
        out += ['      options="' + " ".join(n for t, _ in rows for n in names_of(t)) + '"', "      ;;"]
    out += ["    *) return;;", "  esac", '  if [[ $word == -* ]]; then',
            '    COMPREPLY=($(compgen -W "$options" -- "$word"))', "  else",
            '    COMPREPLY=($(compgen -f -- "$word"))', "  fi", "}", "complete -F _impactdic impactdic"]
    return "\n".join(out) + "\n"


def main():
    writers = {"man": man_page, "bash": bash_completion}
    if len(sys.argv) != 4 or sys.argv[1] not in writers:
        sys.exit(__doc__.splitlines()[0])
    program = sys.argv[2]
    version = subprocess.run([program, "--version"], capture_output=True, check=True,
                             text=True).stdout.split()[-1]
    top = Help(program)
    commands = {name: Help(program, name) for name, _ in top.rows("Subcommands")}
    with open(sys.argv[3], "w", encoding="utf-8") as out:
        out.write(writers[sys.argv[1]](version, top, commands))


if __name__ == "__main__":
    main()
