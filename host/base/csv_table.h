// Reading tables of numbers: comma-separated, one header line, one row a line. A cell in quotation
// marks may hold commas.
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace impactdic {

// What a table may hold: 10^6 frames of `track` with all their columns, which take 2 GB of memory.
// The environment variable IMPACTDIC_TABLE_CELLS raises the cells, and with them the bytes.
struct TableLimits {
  std::size_t cells = 50'000'000;
  std::size_t columns = 1000;
  std::size_t bytes() const { return 10 * cells; }

  // With what the environment says. Throws InvalidArgument where that is no number.
  static TableLimits now();
};

class CsvTable {
 public:
  // Throws FileError where the file cannot be read, FormatError (file, line) where it has no
  // header, repeats a column, a row has another number of fields than the header, or the table is
  // larger than `limits`.
  static CsvTable read(const std::filesystem::path& file,
                       const TableLimits& limits = TableLimits::now());

  std::size_t rows() const { return rows_.size(); }
  const std::vector<std::string>& columns() const { return columns_; }
  bool has(const std::string& column) const;
  // A column as numbers; an empty field, "not measured", is NaN. Throws FormatError naming file and
  // column where the column is missing, and line too where a field is no finite number.
  std::vector<double> numbers(const std::string& column) const;
  // As `numbers`, but an empty field is an error too.
  std::vector<double> filled_numbers(const std::string& column) const;
  std::vector<std::string> text(const std::string& column) const;
  const std::string& file() const { return file_; }
  // Where row `row` stands, for messages: "FILE, line N".
  std::string where(std::size_t row) const;

 private:
  std::size_t index(const std::string& column) const;

  std::string file_;
  std::vector<std::string> columns_;
  std::vector<std::vector<std::string>> rows_;
  std::vector<std::size_t> lines_;  // 1 is the header's
};

// Whether a table of header `found` is one of `wanted`, as this or an older version wrote it:
// columns were only ever added at the end.
bool is_header_of(const std::string& found, const std::string& wanted);

// Opens a table for writing. It keeps the first `rows` rows of an earlier run as they stand, which
// at no instant are absent from the disk, and what is written goes behind them; without rows to
// keep the table starts anew with its header. The rows of an older version get empty cells in the
// columns that they lack. Throws FileError; FormatError where the file has
// another header or fewer whole rows.
std::ofstream continue_table(const std::filesystem::path& file, const std::string& header,
                             std::int64_t rows);

}  // namespace impactdic
