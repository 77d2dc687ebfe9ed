#include "host/base/csv_table.h"

#include <impactdic/error.h>
#include <impactdic/units.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <memory>
#include <set>
#include <sstream>

#include "host/base/parse.h"

namespace impactdic {
namespace {

// The cells of a line. One in quotation marks, as spreadsheets write it, may hold commas, and a
// mark that is written twice. Throws FormatError where the marks are not closed: a cell is one
// line.
std::vector<std::string> cells_of(const std::string& line, const std::string& where) {
  if (line.find('"') == std::string::npos) {
    std::vector<std::string> plain = split(line, ',');
    for (std::string& cell : plain) cell = trim(cell);
    return plain;
  }
  std::vector<std::string> cells(1);
  bool quoted = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const bool mark = line[i] == '"';
    if (quoted && mark && i + 1 < line.size() && line[i + 1] == '"') {
      cells.back() += line[++i];
    } else if (mark && (quoted || trim(cells.back()).empty())) {
      quoted = !quoted;
    } else if (line[i] == ',' && !quoted) {
      cells.emplace_back();
    } else {
      cells.back() += line[i];
    }
  }
  if (quoted) {
    throw FormatError(where, -1, "a quotation mark is not closed", "a cell is one line");
  }
  for (std::string& cell : cells) cell = trim(cell);
  return cells;
}

constexpr const char* kCellsVariable = "IMPACTDIC_TABLE_CELLS";

[[noreturn]] void refuse_size(const std::string& file, const std::string& what) {
  throw FormatError(file, -1, "the table is too large: " + what,
                    std::string(kCellsVariable) + " raises the number of cells and bytes");
}

// The text of what has no size, a pipe, as far as it may go.
std::string text_within(std::istream& stream, const std::string& file, const TableLimits& limits) {
  std::string text;
  std::vector<char> part(1 << 16);
  while (stream.read(part.data(), static_cast<std::streamsize>(part.size())), stream.gcount() > 0) {
    text.append(part.data(), static_cast<std::size_t>(stream.gcount()));
    if (text.size() > limits.bytes()) {
      refuse_size(file, "more than " + std::to_string(limits.bytes()) + " bytes");
    }
  }
  return text;
}

std::unique_ptr<std::istream> open_table(const std::filesystem::path& file,
                                         const TableLimits& limits) {
  auto stream = std::make_unique<std::ifstream>(file);
  std::error_code unknown;
  if (!*stream || std::filesystem::is_directory(file, unknown)) {
    throw FileError("cannot read the table", file.string());
  }
  if (!std::filesystem::is_regular_file(file, unknown)) {
    return std::make_unique<std::istringstream>(text_within(*stream, file.string(), limits));
  }
  const std::uintmax_t size = std::filesystem::file_size(file, unknown);
  if (!unknown && size > limits.bytes())
    refuse_size(file.string(), std::to_string(size) + " bytes");
  return stream;
}

void refuse_repeated(const std::vector<std::string>& columns, const std::string& file) {
  std::set<std::string> seen;
  for (const std::string& column : columns) {
    if (!seen.insert(column).second) {
      throw FormatError(file, -1, "column '" + column + "' stands twice");
    }
  }
}

}  // namespace

TableLimits TableLimits::now() {
  TableLimits limits;
  if (const char* cells = std::getenv(kCellsVariable)) {
    const std::int64_t most = parse_int(cells, kCellsVariable);
    if (most < 1 || most > std::int64_t{1} << 50) {
      throw InvalidArgument("the number of cells is impossible", kCellsVariable, "1 to 2^50");
    }
    limits.cells = static_cast<std::size_t>(most);
  }
  return limits;
}

CsvTable CsvTable::read(const std::filesystem::path& file, const TableLimits& limits) {
  const std::unique_ptr<std::istream> stream = open_table(file, limits);
  CsvTable table;
  table.file_ = file.string();
  std::string line;
  std::size_t number = 0;
  while (std::getline(*stream, line)) {
    ++number;
    // A byte order mark, as spreadsheets write it.
    if (number == 1 && line.starts_with("\xEF\xBB\xBF")) line.erase(0, 3);
    if (trim(line).empty()) continue;
    const auto commas = std::count(line.begin(), line.end(), ',');
    if (static_cast<std::size_t>(commas) >= limits.columns) {
      throw FormatError(table.file_ + ", line " + std::to_string(number), -1,
                        "more than " + std::to_string(limits.columns) + " columns");
    }
    std::vector<std::string> fields =
        cells_of(line, table.file_ + ", line " + std::to_string(number));
    if (table.columns_.empty()) {
      refuse_repeated(fields, table.file_);
      table.columns_ = std::move(fields);
      continue;
    }
    if (fields.size() != table.columns_.size()) {
      throw FormatError(table.file_ + ", line " + std::to_string(number), -1,
                        "the row has " + std::to_string(fields.size()) + " fields, the header " +
                            std::to_string(table.columns_.size()));
    }
    if ((table.rows_.size() + 1) * fields.size() > limits.cells) {
      refuse_size(table.file_, "more than " + std::to_string(limits.cells) + " cells");
    }
    table.rows_.push_back(std::move(fields));
    table.lines_.push_back(number);
  }
  if (table.columns_.empty()) {
    throw FormatError(table.file_, -1, "the table is empty", "its first line names the columns");
  }
  return table;
}

bool CsvTable::has(const std::string& column) const {
  return std::find(columns_.begin(), columns_.end(), column) != columns_.end();
}

std::size_t CsvTable::index(const std::string& column) const {
  const auto found = std::find(columns_.begin(), columns_.end(), column);
  if (found == columns_.end()) {
    throw FormatError(file_, -1, "column '" + column + "' is missing",
                      "names carry their unit; see docs/calibration.md");
  }
  return static_cast<std::size_t>(found - columns_.begin());
}

std::string CsvTable::where(std::size_t row) const {
  return file_ + ", line " + std::to_string(lines_[row]);
}

std::vector<double> CsvTable::numbers(const std::string& column) const {
  const std::size_t i = index(column);
  std::vector<double> values(rows_.size(), kNotMeasured);
  for (std::size_t row = 0; row < rows_.size(); ++row) {
    const std::string& field = rows_[row][i];
    if (field.empty()) continue;
    try {
      values[row] = parse_double(field, column);
    } catch (const InvalidArgument&) {
      throw FormatError(where(row) + ", column " + column, -1, "'" + field + "' is no number",
                        "leave a field empty where nothing was measured");
    }
  }
  return values;
}

std::vector<double> CsvTable::filled_numbers(const std::string& column) const {
  std::vector<double> values = numbers(column);
  for (std::size_t row = 0; row < values.size(); ++row) {
    if (std::isnan(values[row])) {
      throw FormatError(where(row) + ", column " + column, -1, "the field is empty");
    }
  }
  return values;
}

std::vector<std::string> CsvTable::text(const std::string& column) const {
  const std::size_t i = index(column);
  std::vector<std::string> values;
  values.reserve(rows_.size());
  for (const auto& row : rows_) values.push_back(row[i]);
  return values;
}

bool is_header_of(const std::string& found, const std::string& wanted) {
  return found == wanted || (!found.empty() && wanted.starts_with(found + ","));
}

namespace {

// Its whole rows with as many cells as `header` has, in one step.
void widen(const std::filesystem::path& file, const std::string& header) {
  const std::filesystem::path part = file.string() + ".part";
  {
    std::ifstream old(file, std::ios::binary);
    std::ofstream wide(part, std::ios::trunc);
    std::string line;
    std::getline(old, line);
    const auto commas = [](const std::string& text) {
      return std::count(text.begin(), text.end(), ',');
    };
    const std::string empty(static_cast<std::size_t>(commas(header) - commas(line)), ',');
    wide << header << '\n';
    while (std::getline(old, line) && !old.eof()) wide << trim(line) << empty << '\n';
    wide.flush();
    if (!wide) throw FileError("cannot write the file", part.string());
  }
  std::error_code error;
  std::filesystem::rename(part, file, error);
  if (error) throw FileError("cannot replace the file: " + error.message(), file.string());
}

}  // namespace

std::ofstream continue_table(const std::filesystem::path& file, const std::string& header,
                             std::int64_t rows) {
  if (rows == 0) {
    std::ofstream table(file, std::ios::trunc);
    table << header << '\n' << std::flush;
    if (!table) throw FileError("cannot write the file", file.string());
    return table;
  }
  std::uintmax_t kept = 0;
  std::string line;
  {
    std::ifstream table(file, std::ios::binary);
    if (!table) throw FileError("cannot read the file", file.string());
    if (!std::getline(table, line) || !is_header_of(trim(line), header)) {
      throw FormatError(file.string(), 0, "this is no such table: its header differs");
    }
  }
  if (trim(line) != header) widen(file, header);
  {
    std::ifstream table(file, std::ios::binary);
    std::getline(table, line);
    std::int64_t found = 0;
    while (found < rows && std::getline(table, line) && !table.eof()) ++found;
    if (found < rows) {
      throw FormatError(file.string(), -1,
                        "it holds " + std::to_string(found) + " of the " + std::to_string(rows) +
                            " frames that were measured",
                        "--force without --resume starts anew");
    }
    kept = static_cast<std::uintmax_t>(table.tellg());
  }
  std::error_code error;
  std::filesystem::resize_file(file, kept, error);
  std::ofstream table(file, std::ios::app);
  if (error || !table) throw FileError("cannot write the file", file.string());
  return table;
}

}  // namespace impactdic
