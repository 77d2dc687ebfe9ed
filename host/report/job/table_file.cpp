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

void TableFile::close() { close_file(out_, file_); }

void write_ordered_json(const std::filesystem::path& file, const nlohmann::ordered_json& json) {
  std::ofstream out(file);
  out << json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) << '\n';
  close_file(out, file);
}

void close_file(std::ofstream& stream, const std::filesystem::path& file) {
  stream.flush();
  if (!stream) throw FileError("cannot write the file", file.string(), "is the disk full?");
}

std::string number_cell(double value) { return std::isfinite(value) ? shortest(value) : ""; }

}  // namespace impactdic::report
