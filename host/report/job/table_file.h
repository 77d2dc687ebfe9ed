// A CSV file, and a JSON file, that report when they cannot be written.
#pragma once

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

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
// null where the value is not finite.
nlohmann::ordered_json json_number(double value);

}  // namespace impactdic::report
