// Runs the built program as a person would.
#pragma once

#include <sys/wait.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "tests/support/scratch.h"

namespace impactdic::testing {

struct Outcome {
  int status = -1;
  std::string out, err;
};

// `arguments` as a shell would take them.
inline Outcome run_program(const std::string& arguments) {
  const ScratchFolder scratch;
  const std::string command = std::string(IMPACTDIC_PROGRAM) + " " + arguments + " > " +
                              quoted(scratch / "out") + " 2> " + quoted(scratch / "err");
  const int raw = std::system(command.c_str());
  return {WIFEXITED(raw) ? WEXITSTATUS(raw) : -1, read_text(scratch / "out"),
          read_text(scratch / "err")};
}

// A table by column name; empty cells are NaN where read as numbers.
class CsvTable {
 public:
  explicit CsvTable(const std::filesystem::path& path) {
    std::istringstream lines(read_text(path));
    std::string line;
    std::getline(lines, line);
    header = line;
    const auto names = cells(line);
    while (std::getline(lines, line)) {
      const auto values = cells(line);
      for (std::size_t i = 0; i < names.size(); ++i) {
        columns_[names[i]].push_back(i < values.size() ? values[i] : "");
      }
      ++rows;
    }
  }
  const std::vector<std::string>& text(const std::string& name) const { return columns_.at(name); }
  std::vector<double> numbers(const std::string& name) const {
    std::vector<double> values;
    for (const std::string& cell : columns_.at(name)) {
      values.push_back(cell.empty() ? std::nan("") : std::stod(cell));
    }
    return values;
  }
  std::string header;
  std::size_t rows = 0;

 private:
  static std::vector<std::string> cells(const std::string& line) {
    std::vector<std::string> parts(1);
    for (char c : line) {
      if (c == ',') {
        parts.emplace_back();
      } else if (c != '\r') {
        parts.back() += c;
      }
    }
    return parts;
  }
  std::map<std::string, std::vector<std::string>> columns_;
};

}  // namespace impactdic::testing
