#include "sim/job/strict_toml.h"

#include <impactdic/error.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "host/base/toml_text.h"

namespace impactdic::sim::job {

namespace {

toml::table parse(const std::filesystem::path& file) {
  const std::string text = read_toml_text(file);
  try {
    return toml::parse(text);
  } catch (const toml::parse_error& error) {
    throw FormatError(file.string() + ", line " + std::to_string(error.source().begin.line), -1,
                      "not TOML: " + std::string(error.description()));
  }
}

}  // namespace

StrictTable::StrictTable(const std::filesystem::path& file)
    : StrictTable(parse(file), file.string(), "") {}

StrictTable::StrictTable(toml::table table, std::string file, std::string prefix)
    : table_(std::move(table)), file_(std::move(file)), prefix_(std::move(prefix)) {}

std::string StrictTable::place(const std::string& key) const {
  return file_ + ": " + prefix_ + key;
}

const toml::node* StrictTable::find(const std::string& key) {
  known_.insert(key);
  return table_.get(key);
}

bool StrictTable::has(const std::string& key) { return find(key) != nullptr; }

double StrictTable::number(const std::string& key) {
  const toml::node* node = find(key);
  if (node == nullptr) {
    const std::string used = suggestion(key);
    throw InvalidArgument("the key is missing", place(key), used.empty() ? "" : used);
  }
  if (!node->is_number()) throw InvalidArgument("must be a number", place(key));
  const double value = *node->value<double>();
  if (!std::isfinite(value)) throw InvalidArgument("must be a finite number", place(key));
  return value;
}

double StrictTable::number(const std::string& key, double fallback) {
  return has(key) ? number(key) : fallback;
}

int StrictTable::integer(const std::string& key, int fallback) {
  const toml::node* node = find(key);
  if (node == nullptr) return fallback;
  if (!node->is_integer()) throw InvalidArgument("must be a whole number", place(key));
  const auto value = *node->value<std::int64_t>();
  if (value < -1000000000 || value > 1000000000) {
    throw InvalidArgument("is out of range", place(key));
  }
  return static_cast<int>(value);
}

bool StrictTable::boolean(const std::string& key, bool fallback) {
  const toml::node* node = find(key);
  if (node == nullptr) return fallback;
  if (!node->is_boolean()) throw InvalidArgument("must be true or false", place(key));
  return *node->value<bool>();
}

std::string StrictTable::text(const std::string& key) {
  const toml::node* node = find(key);
  if (node == nullptr) throw InvalidArgument("the key is missing", place(key));
  if (!node->is_string()) throw InvalidArgument("must be a text in quotes", place(key));
  return *node->value<std::string>();
}

std::string StrictTable::text(const std::string& key, const std::string& fallback) {
  return has(key) ? text(key) : fallback;
}

std::vector<std::string> StrictTable::texts(const std::string& key) {
  const toml::node* node = find(key);
  if (node == nullptr) return {};
  const toml::array* array = node->as_array();
  if (array == nullptr) throw InvalidArgument("must be a list of texts", place(key));
  std::vector<std::string> values;
  for (const toml::node& element : *array) {
    if (!element.is_string()) throw InvalidArgument("must be a list of texts", place(key));
    values.push_back(*element.value<std::string>());
  }
  return values;
}

std::vector<double> StrictTable::numbers(const std::string& key) {
  constexpr int kMostNumbers = 100'000;
  const toml::node* node = find(key);
  if (node != nullptr && node->is_table()) {
    StrictTable& range = table(key);
    const double from = range.number("from"), to = range.number("to");
    const int count = range.integer("count", 0);
    if (count < 2 || count > kMostNumbers) {
      throw InvalidArgument("must be from 2 to 100000", range.place("count"));
    }
    std::vector<double> values;
    for (int i = 0; i < count; ++i) values.push_back(from + (to - from) * i / (count - 1));
    return values;
  }
  const toml::array* array = node == nullptr ? nullptr : node->as_array();
  if (array == nullptr) {
    throw InvalidArgument("must be a list of numbers", place(key),
                          "such as [1.0, 2.0] or {from = 1.0, to = 2.0, count = 11}");
  }
  std::vector<double> values;
  for (const toml::node& element : *array) {
    if (!element.is_number() || !std::isfinite(*element.value<double>())) {
      throw InvalidArgument("must be a list of finite numbers", place(key));
    }
    values.push_back(*element.value<double>());
  }
  return values;
}

std::vector<std::string> StrictTable::keys() const {
  std::vector<std::pair<toml::source_position, std::string>> found;
  for (const auto& [key, node] : table_) {
    found.emplace_back(key.source().begin, std::string(key.str()));
  }
  std::stable_sort(found.begin(), found.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<std::string> keys;
  for (auto& [place, key] : found) keys.push_back(std::move(key));
  return keys;
}

void StrictTable::fill(const std::string& table, const std::string& key, double value) {
  if (!table_.contains(table)) table_.insert(table, toml::table{});
  if (toml::table* within = table_.get_as<toml::table>(table)) within->insert(key, value);
}

StrictTable& StrictTable::table(const std::string& key) {
  for (auto& [name, child] : children_) {
    if (name == key) return *child;
  }
  const toml::node* node = find(key);
  toml::table content;
  if (node != nullptr) {
    if (!node->is_table()) throw InvalidArgument("must be a table", place(key));
    content = *node->as_table();
  }
  children_.emplace_back(key, std::unique_ptr<StrictTable>(
                                  new StrictTable(std::move(content), file_, prefix_ + key + ".")));
  return *children_.back().second;
}

void StrictTable::hint(const std::string& key, const std::string& text) {
  hints_.emplace_back(key, text);
}

void StrictTable::finish() const {
  for (const auto& [key, node] : table_) {
    const std::string name(key.str());
    if (known_.count(name) != 0) continue;
    for (const auto& [hinted, text] : hints_) {
      if (hinted == name) throw InvalidArgument("the key does not belong here", place(name), text);
    }
    std::string near;
    for (const std::string& known : known_) {
      // "mass" for "mass_kg": the unit is missing; "gap_mm" for "gap_m": another unit.
      const std::string stem = name.substr(0, name.find('_'));
      if (known.rfind(name, 0) == 0 || (near.empty() && known.rfind(stem, 0) == 0)) near = known;
    }
    throw InvalidArgument("unknown key", place(name),
                          near.empty() ? "see docs/models.md for the keys"
                                       : "did you mean " + near + "? A key carries its unit");
  }
  for (const auto& [name, child] : children_) child->finish();
}

// A key in the table that looks like the missing one without its unit, or with another.
std::string StrictTable::suggestion(const std::string& key) const {
  const std::string stem = key.substr(0, key.find('_'));
  for (const auto& [used, node] : table_) {
    const std::string name(used.str());
    if (known_.count(name) == 0 && name.rfind(stem, 0) == 0) {
      return "the file has " + name + "; a key carries its unit";
    }
  }
  return "";
}

}  // namespace impactdic::sim::job
