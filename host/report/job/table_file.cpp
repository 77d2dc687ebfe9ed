#include "host/report/job/table_file.h"

#include <impactdic/error.h>

#include <cmath>

#include "host/base/parse.h"

namespace impactdic::report {

TableFile::TableFile(const std::filesystem::path& file, const std::string& header)
    : file_(file), out_(file) {
  out_ << header << '\n';
}

TableFile& TableFile::operator<<(double value) { return *this << shortest(value); }

TableFile& TableFile::operator<<(const std::string& text) {
  out_ << (first_ ? "" : ",") << text;
  first_ = false;
  return *this;
}

void TableFile::end_row() {
  out_ << '\n';
  first_ = true;
}

void TableFile::close() {
  out_.flush();
  if (!out_) throw FileError("cannot write the file", file_.string());
}

void write_ordered_json(const std::filesystem::path& file, const nlohmann::ordered_json& json) {
  std::ofstream out(file);
  out << json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) << '\n'
      << std::flush;
  if (!out) throw FileError("cannot write the file", file.string());
}

nlohmann::ordered_json json_number(double value) {
  return std::isfinite(value) ? nlohmann::ordered_json(value) : nlohmann::ordered_json(nullptr);
}

}  // namespace impactdic::report
