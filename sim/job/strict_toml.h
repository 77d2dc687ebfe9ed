// TOML tables of which every key must be known. Include it in .cpp files only: toml++ is heavy.
#pragma once

#include <impactdic/error.h>
#include <toml++/toml.h>

#include <filesystem>
#include <memory>
#include <set>
#include <string>
#include <vector>

namespace impactdic::sim::job {

// Reads keys of one table and remembers which were asked for; finish() rejects all others. Errors
// are InvalidArgument with "FILE: table.key" as the place.
class StrictTable {
 public:
  // The whole file. Throws FileError if it cannot be read, FormatError if it is not TOML.
  explicit StrictTable(const std::filesystem::path& file);

  bool has(const std::string& key);
  // The number, finite. Without a fallback the key must be there.
  double number(const std::string& key);
  double number(const std::string& key, double fallback);
  int integer(const std::string& key, int fallback);
  bool boolean(const std::string& key, bool fallback);
  std::string text(const std::string& key);
  std::string text(const std::string& key, const std::string& fallback);
  std::vector<std::string> texts(const std::string& key);
  // A list of finite numbers, or {from, to, count}: so many of them evenly spaced, both ends
  // included.
  std::vector<double> numbers(const std::string& key);
  // The keys of this table as they stand in the file.
  std::vector<std::string> keys() const;
  // Fills in a number where the file leaves it out; before the table is first asked for.
  void fill(const std::string& table, const std::string& key, double value);
  // A table within; empty if it is not there. It is finished together with this one.
  StrictTable& table(const std::string& key);
  // A key that exists under another name elsewhere: named in the error if it is used here.
  void hint(const std::string& key, const std::string& text);

  // Throws InvalidArgument naming the first key that nobody asked for.
  void finish() const;

  // "FILE: table.key"
  std::string place(const std::string& key) const;
  const std::string& file() const { return file_; }

 private:
  StrictTable(toml::table table, std::string file, std::string prefix);
  const toml::node* find(const std::string& key);
  std::string suggestion(const std::string& key) const;

  toml::table table_;
  std::string file_, prefix_;
  std::set<std::string> known_;
  std::vector<std::pair<std::string, std::string>> hints_;
  std::vector<std::pair<std::string, std::unique_ptr<StrictTable>>> children_;
};

// One of our enumerations, its error placed in the file.
template <typename Parser>
auto choose(StrictTable& table, const std::string& key, const std::string& fallback,
            Parser parser) {
  const std::string text = table.text(key, fallback);
  try {
    return parser(text);
  } catch (const InvalidArgument& error) {
    throw InvalidArgument("'" + text + "' is not known", table.place(key), error.hint());
  }
}

// A number that a complete job must give.
inline double needed(StrictTable& table, const char* key, bool partial) {
  return partial ? table.number(key, 0) : table.number(key);
}

// Validates what a file says; its errors name the file beside the key. Throws InvalidArgument.
template <typename Request>
void validate_in_file(const Request& request, const StrictTable& root) {
  try {
    request.validate();
  } catch (const InvalidArgument& error) {
    throw InvalidArgument(error.what(), root.place(error.where()), error.hint());
  }
}

}  // namespace impactdic::sim::job
