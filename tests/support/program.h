// Runs the built program as a person would.
#pragma once

#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <sstream>
#include <string>
#include <vector>

namespace impactdic::testing {

struct Outcome {
  int status = -1;
  std::string out, err;
};

// A folder that is gone with the object.
class ScratchFolder {
 public:
  ScratchFolder() {
    static int count = 0;
    path_ = std::filesystem::temp_directory_path() /
            ("impactdic_test_" + std::to_string(getpid()) + "_" + std::to_string(count++));
    std::filesystem::create_directories(path_);
  }
  ~ScratchFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
  std::string string() const { return path_.string(); }

 private:
  std::filesystem::path path_;
};

inline std::string read_text(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

inline std::string quoted(const std::filesystem::path& path) { return "'" + path.string() + "'"; }

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
