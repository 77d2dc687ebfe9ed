#include "sim/job/toml_text.h"

#include <impactdic/impact_model.h>

#include "host/base/parse.h"

namespace impactdic::sim::job {
namespace {

std::string toml_quoted(std::string_view text) {
  std::string out = "\"";
  for (char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    out += c;
  }
  return out + "\"";
}

std::string digits_of(double value) {
  const std::string digits = shortest(value);
  return digits.find_first_of(".e") == std::string::npos ? digits + ".0" : digits;
}

}  // namespace

void TomlText::table(std::string_view name) { text_ += "\n[" + std::string(name) + "]\n"; }

void TomlText::name(std::string_view key, std::string_view value) {
  text_ += std::string(key) + " = " + toml_quoted(value) + "\n";
}

void TomlText::number(std::string_view key, double value) {
  text_ += std::string(key) + " = " + digits_of(value) + "\n";
}

void TomlText::integer(std::string_view key, long value) {
  text_ += std::string(key) + " = " + std::to_string(value) + "\n";
}

void TomlText::boolean(std::string_view key, bool value) {
  text_ += std::string(key) + " = " + (value ? "true" : "false") + "\n";
}

void TomlText::names(std::string_view key, const std::vector<std::string>& values) {
  std::string list;
  for (const std::string& value : values) list += (list.empty() ? "" : ", ") + toml_quoted(value);
  text_ += std::string(key) + " = [" + list + "]\n";
}

void TomlText::numbers(std::string_view key, const std::vector<double>& values) {
  std::string list;
  for (const double value : values) list += (list.empty() ? "" : ", ") + digits_of(value);
  text_ += std::string(key) + " = [" + list + "]\n";
}

void TomlText::body(const ImpactBody& body, std::string_view table_name) {
  table(table_name);
  name("shape", name_of(body.shape));
  number("mass_kg", body.mass_kg);
  number("diameter_m", body.diameter_m);
  if (body.shape == BodyShape::kRod) number("length_m", body.length_m);
  if (body.inertia_kg_m2 != 0) number("inertia_kg_m2", body.inertia_kg_m2);
}

}  // namespace impactdic::sim::job
