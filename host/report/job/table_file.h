// A CSV file, and a JSON file, that report when they cannot be written.
#pragma once

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "host/base/json_number.h"

namespace impactdic::report {

class TableFile {
 public:
  TableFile(const std::filesystem::path& file, const std::string& header);
  // A number in its shortest exact form; one that is not finite leaves its field empty.
  TableFile& operator<<(double value);
  TableFile& operator<<(const std::string& text);
  void end_row();
  // Throws FileError.
  void close();

 private:
  std::filesystem::path file_;
  std::ofstream out_;
  bool first_ = true;
};

// Throws FileError.
void write_ordered_json(const std::filesystem::path& file, const nlohmann::ordered_json& json);
// Writes what is left. Throws FileError.
void close_file(std::ofstream& stream, const std::filesystem::path& file);
// A number in its shortest exact form; "" where it is not finite.
std::string number_cell(double value);

}  // namespace impactdic::report
